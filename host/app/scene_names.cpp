#include "host/app/scene_names.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

namespace enamel::app {

namespace {

namespace fs = std::filesystem;

// Beside the sources of the build that this program lies in: build/<preset>/bin/enamel -> config/scenes.
fs::path scenes_folder() {
  std::error_code ec;
  fs::path folder = fs::read_symlink("/proc/self/exe", ec).parent_path();
  for (int up = 0; up < 5; ++up, folder = folder.parent_path()) {
    if (fs::is_directory(folder / "config/scenes", ec)) return folder / "config/scenes";
  }
  return "config/scenes";
}

std::string known_names(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(folder, ec)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

}  // namespace

Result<std::string> scene_file(const std::string& name_or_path) {
  const bool is_path = name_or_path.find('/') != std::string::npos || name_or_path.ends_with(".toml");
  if (is_path) return name_or_path;
  const fs::path folder = scenes_folder(), scene = folder / (name_or_path + ".toml");
  std::error_code ec;
  if (fs::exists(scene, ec)) return scene.string();
  return fail(ErrorCode::kFileNotFound,
              "no scene '" + name_or_path + "' in " + folder.string() + "; known: " + known_names(folder));
}

}  // namespace enamel::app
