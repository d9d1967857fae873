// A desktop scanner as real processes and ports: enamel-probe renders a table that a simulated GRBL controller drives;
// this process moves it and takes stops. Truth comes from the probe.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "host/desktop/stop_taker.hpp"
#include "host/motion/grbl_axes.hpp"
#include "tests/support/run.hpp"

namespace enamel::test {

/// A row of --twin-truth.
struct TableRow {
  bool is_moving = false;
  double rot_motor_deg = 0, swing_motor_deg = 0, rot_deg = 0, swing_deg = 0;
};

/// By start of the first exposure, ns of the device clock.
inline std::map<std::uint64_t, TableRow> read_table_truth(const std::string& path) {
  std::map<std::uint64_t, TableRow> rows;
  std::istringstream text(read_file(path).value_or(""));
  std::string line;
  std::getline(text, line);
  while (std::getline(text, line)) {
    std::uint64_t first = 0, mid = 0;
    int moving = 0;
    TableRow r;
    if (std::sscanf(line.c_str(), "%lu,%lu,%d,%lf,%lf,%lf,%lf", &first, &mid, &moving, &r.rot_motor_deg,
                    &r.swing_motor_deg, &r.rot_deg, &r.swing_deg) == 7) {
      r.is_moving = moving != 0;
      rows[first] = r;
    }
  }
  return rows;
}

/// A process sees one tag; probes are told apart by their serial numbers.
inline const std::string& live_tag() {
  static const std::string tag = unique_tag();
  return tag;
}

/// Probe, axes and a taker, ready to take.
class LiveTable {
 public:
  static constexpr double kStopErrorDeg = 0.01;  // of the scene
  /// Harmonic of either axis twice its drawn amplitude, five sigmas of the stop error.
  static constexpr double kTableDeg = 2 * 0.02 + 5 * kStopErrorDeg;
  static constexpr double kMotorDeg = 0.002;  // half a step and a printed digit

  /// `timing`, `more`: lines of that table of the scene, and tables besides.
  explicit LiveTable(unsigned seed, const std::vector<std::string>& arguments = {}, const std::string& timing = {},
                     const std::string& more = {})
      : serial_(name(seed)) {
    EXPECT_TRUE(write_file(folder_ / "scene.toml", scene(timing) + more));
    argv_ = {program("enamel-probe"),
             "--twin",
             folder_ / "scene.toml",
             "--twin-axes",
             port(),
             "--twin-truth",
             folder_ / "truth.csv",
             "--seed",
             std::to_string(seed),
             "--serial",
             serial_,
             "--dds-tag",
             live_tag()};
    argv_.insert(argv_.end(), arguments.begin(), arguments.end());
    start_probe();
    profile.feed_deg_per_s = 30.0;
    profile.settle_ms = 100.0;
    config.link.serial = serial_;
    config.feed.find_timeout = std::chrono::seconds(60);
    config.bursts = 3;
  }
  void start_probe() {
    auto child = app::ChildProcess::start(argv_, {folder_ / "probe.out", folder_ / "probe.err"});
    EXPECT_TRUE(child);
    if (child) probe.emplace(std::move(*child));
  }
  static std::string name(unsigned seed) { return "TABLE-" + std::to_string(::getpid()) + "-" + std::to_string(seed); }

  [[nodiscard]] std::string port() const { return folder_ / "axes"; }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] auto truth() const { return read_table_truth(folder_ / "truth.csv"); }

  /// Axes homed, probe scanning, and a burst has come. `wrap` may put other axes in front.
  template <class Wrap>
  [[nodiscard]] Result<void> start(Wrap wrap) {
    for (int i = 0; i < 1200 && !std::filesystem::exists(port()); ++i) clock.sleep_for(std::chrono::milliseconds(50));
    ENAMEL_TRY_ASSIGN(axes, motion::GrblAxes::open(port(), profile, clock));
    ENAMEL_TRY(axes->home(std::chrono::seconds(20)));
    ENAMEL_TRY_ASSIGN(const auto participant, dds::Participant::create({.tag = live_tag()}));
    ENAMEL_TRY_ASSIGN(taker, host::StopTaker::create(participant, config, wrap(*axes), clock));
    ENAMEL_TRY_ASSIGN(const auto info, taker->start());
    EXPECT_EQ(info.serial, serial_);
    for (int i = 0; i < 6000 && taker->counts().moving == 0; ++i) clock.sleep_for(std::chrono::milliseconds(10));
    return {};
  }
  [[nodiscard]] Result<void> start() {
    return start([](motion::Axes& own) -> motion::Axes& { return own; });
  }

  /// Bursts of these stops that show a moving table, one elsewhere than told, or that the truth does not know.
  [[nodiscard]] int wrong_poses(const std::vector<host::TakenStop>& stops) const {
    const auto rows = truth();
    int wrong = 0;
    for (const auto& stop : stops) {
      for (const auto& burst : stop.bursts) {
        const auto row = rows.find(burst->meta[0].t_strobe_ns);
        wrong += row == rows.end() || !shows(row->second, stop.position.commanded) ? 1 : 0;
      }
    }
    return wrong;
  }

  std::optional<app::ChildProcess> probe;
  SteadyClock clock;
  motion::GrblProfile profile;
  host::StopTakerConfig config;
  std::unique_ptr<motion::GrblAxes> axes;
  std::unique_ptr<host::StopTaker> taker;

 private:
  static bool shows(const TableRow& row, const motion::AxesAngles& told) {
    return !row.is_moving && std::abs(row.rot_motor_deg - told.rot_deg) < kMotorDeg &&
           std::abs(row.swing_motor_deg - told.swing_deg) < kMotorDeg &&
           std::abs(row.rot_deg - told.rot_deg) < kTableDeg && std::abs(row.swing_deg - told.swing_deg) < kTableDeg;
  }
  static std::string scene(const std::string& timing) {
    return std::string("rig = \"") + ENAMEL_SOURCE_DIR +
           "/config/rigs/probe.json\"\n"
           "[object]\ntype = \"plate\"\n[timing]\nburst_rate_hz = 15.0\n" +
           timing +
           "[path]\ntype = \"mount\"\n"
           "[mount]\ndraw = true\nrot_deg = [0.0]\nplace_mm = [0.0, 0.0, -4.0]\n"
           "[mount.rotation]\npoint_mm = [27.0, 0.0, 48.0]\nstop_error_deg = 0.01\n"
           "[mount.swing]\nstop_error_deg = 0.01\n";
  }
  TempFolder folder_;
  std::string serial_;
  std::vector<std::string> argv_;
};

}  // namespace enamel::test
