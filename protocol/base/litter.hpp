// Files that operating systems, file servers and editors leave in folders of their own accord. They are no data.
// Thread-safe: no state.
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <string>
#include <string_view>

namespace enamel {

/// One name of a file or folder.
[[nodiscard]] inline bool is_litter_name(std::string_view name) {
  constexpr std::array<std::string_view, 17> kNames{".ds_store",
                                                    "thumbs.db",
                                                    "ehthumbs.db",
                                                    "ehthumbs_vista.db",
                                                    "desktop.ini",
                                                    "__macosx",
                                                    "@eadir",
                                                    ".ipynb_checkpoints",
                                                    ".spotlight-v100",
                                                    ".trashes",
                                                    ".fseventsd",
                                                    ".directory",
                                                    "$recycle.bin",
                                                    ".temporaryitems",
                                                    ".appledouble",
                                                    "#recycle",
                                                    "system volume information"};
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::find(kNames.begin(), kNames.end(), lower) != kNames.end()) return true;
  const auto begins = [&](std::string_view with) { return lower.starts_with(with); };
  // "._x": a Mac's second half of x. "x~", ".x.swp", "#x#", ".~lock.x#": an editor's. ".nfs…": removed while open.
  return begins("._") || lower.ends_with('~') || begins(".nfs") || begins(".~lock.") || begins(".trash-") ||
         (begins("#") && lower.ends_with('#') && lower.size() > 1) ||
         (begins(".") && (lower.ends_with(".swp") || lower.ends_with(".swo") || lower.ends_with(".swx")));
}

/// Any part of a path relative to the folder that is looked through.
[[nodiscard]] inline bool is_litter(const std::filesystem::path& relative) {
  return std::any_of(relative.begin(), relative.end(),
                     [](const std::filesystem::path& part) { return is_litter_name(part.string()); });
}

}  // namespace enamel
