#include "host/app/demo_calibration.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "host/app/child_process.hpp"
#include "host/app/run_options.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/sha256.hpp"

namespace enamel::app {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kKept = 3;  // calibrations of other seeds and builds: some twenty megabytes each

void prune(const std::string& cache, const fs::path& keep) {
  std::vector<std::pair<fs::file_time_type, fs::path>> folders;
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(cache, ec)) {
    const bool is_ours = entry.is_directory(ec) && entry.path().filename().string().starts_with("calib-");
    if (is_ours && entry.path() != keep) folders.emplace_back(entry.last_write_time(ec), entry.path());
  }
  std::sort(folders.begin(), folders.end());
  for (std::size_t i = 0; i + kKept - 1 < folders.size(); ++i) fs::remove_all(folders[i].second, ec);
}

Result<void> solve(const std::string& folder, Clock& clock) {
  ENAMEL_TRY_ASSIGN(const int code, run_child({sibling_program("enamel"), "calibrate", "solve", folder, "--out",
                                               folder + "/solved.json", "--json"},
                                              {.stdout_path = folder + "/verdict.json", .stderr_path = {}}, clock));
  if (code == 0) return {};
  if (code == exit_code(ErrorCode::kCalibrationRefused)) {
    const auto verdict = read_file(folder + "/verdict.json");
    return fail(ErrorCode::kCalibrationRefused, verdict ? *verdict : folder);
  }
  return fail(ErrorCode::kInternal, "enamel calibrate solve ended with code " + std::to_string(code));
}

Result<void> render_and_solve(const std::string& scene, std::uint64_t seed, const std::string& folder, Clock& clock) {
  ENAMEL_TRY(
      run_or_fail({sibling_program("enamel-twin"), "calibrate", scene, "--seed", std::to_string(seed), "--out", folder},
                  {}, clock));
  return solve(folder, clock);
}

}  // namespace

Result<int> run_child(const std::vector<std::string>& argv, const ChildOptions& options, Clock& clock) {
  ENAMEL_TRY_ASSIGN(auto child, ChildProcess::start(argv, options));
  while (!child.poll() && !stop_requested()) clock.sleep_for(std::chrono::milliseconds(50));
  if (stop_requested()) return fail(ErrorCode::kCancelled);
  return *child.poll();
}

Result<void> run_or_fail(const std::vector<std::string>& argv, const ChildOptions& options, Clock& clock) {
  ENAMEL_TRY_ASSIGN(const int code, run_child(argv, options, clock));
  if (code == 0) return {};
  const std::string program = fs::path(argv.at(0)).filename().string();
  return fail(ErrorCode::kInternal, program + " " + argv.at(1) + " ended with code " + std::to_string(code));
}

Result<DemoCalibration> demo_calibration(const std::string& scene, std::uint64_t seed, const std::string& cache,
                                         const std::string& scene_key, Clock& clock) {
  ENAMEL_TRY_ASSIGN(const std::string solver, read_file(sibling_program("enamel")));
  RollingHash hash;
  hash.update(scene_key).update(solver);
  const std::string folder = cache + "/calib-" + hash.hex().substr(0, 16);
  DemoCalibration calibration{folder + "/rig.json", folder + "/solved.json"};
  std::error_code ec;
  if (fs::exists(calibration.solved_rig, ec)) {
    log::info("demo", "calibration found in the cache: {}", folder);
    return calibration;
  }
  prune(cache, folder);
  log::info("demo", "calibrating the simulated probe: board rendered at a dozen stands, then solved");
  const std::string partial = folder + ".solving";
  fs::remove_all(partial, ec);
  const auto solved = render_and_solve(scene, seed, partial, clock);
  if (!solved) {
    fs::remove_all(partial, ec);
    return tl::unexpected<Error>(solved.error());
  }
  fs::rename(partial, folder, ec);
  if (ec) return fail(ErrorCode::kFileWrite, folder + ": " + ec.message());
  return calibration;
}

}  // namespace enamel::app
