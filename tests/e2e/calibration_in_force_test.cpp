// Which calibration measures a scan: chosen, recorded with it, used again by replay, refused when it is another
// probe's.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/e2e/small_capture.hpp"
#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

using std::chrono::seconds;
using Json = nlohmann::json;

Json json_of(const std::string& path) { return Json::parse(read_file(path).value_or("{}"), nullptr, false); }

/// The rig of the small recording as a calibration set would leave it, with another serial and focal length.
std::string write_calibration(const TempFolder& tmp, const std::string& serial, double focal_scale) {
  Json rig = json_of(std::string(ENAMEL_SOURCE_DIR) + "/config/rigs/probe.json");
  rig["serial"] = serial;
  rig["patterns"] = {{"mode", "multi"}, {"steps", 4}, {"cycles", {1, 4, 16, 64}}, {"mean", 127}, {"amplitude", 120}};
  rig["calibrated_at"] = "2020-01-31T12:00:00Z";
  rig["temp_c"] = 20;  // the small recording's bursts are at 32
  rig["camera"]["fx"] = focal_scale * rig["camera"]["fx"].get<double>();
  const std::string path = tmp / ("rig-" + serial + ".json");
  EXPECT_TRUE(write_file(path, rig.dump(1)));
  const Json report{{"verdict", "accepted"}, {"expected", {{"p95_um", 0.25}, {"p95_bound_um", 0.5}}}};
  EXPECT_TRUE(write_file(tmp / ("rig-" + serial + ".report.json"), report.dump(1)));
  return path;
}

Ran scan(const TempFolder& tmp, const std::string& rig) {
  const std::string tag = unique_tag();
  const auto probe =
      app::ChildProcess::start({program("enamel-probe"), "--play", small_capture(), "--serial", "P", "--dds-tag", tag},
                               {tmp / "p.out", tmp / "p.log"});
  EXPECT_TRUE(probe);
  return run({program("enamel"), "scan", "--headless", "--session", tmp / "session", "--dds-tag", tag, "--rig", rig},
             seconds(180));
}

TEST(CalibrationInForce, scan_records_it_and_replay_measures_with_it) {
  const TempFolder tmp;
  const std::string rig = write_calibration(tmp, "SIM-0001", 1.001);
  const Ran scanned = scan(tmp, rig);
  ASSERT_EQ(scanned.code, 0) << scanned.err;
  const Json live = json_of(tmp / "session/report.json");
  EXPECT_EQ(live["calibration"]["source"], rig);
  EXPECT_EQ(live["calibration"]["sha256"].get<std::string>().size(), 64U);
  EXPECT_EQ(live["calibration"]["verdict"], "accepted");
  EXPECT_EQ(live["calibration"]["expected_p95_um"], 0.25);
  EXPECT_FALSE(live["calibration"]["foreign"].get<bool>());
  EXPECT_GT(live["calibration"]["age_days"], 1800);
  EXPECT_EQ(live["calibration"]["kelvins_beyond"], 12);
  EXPECT_EQ(live["calibration"]["marks"].size(), 2U) << live["calibration"];
  const auto replay = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> argv{program("enamel"), "replay", tmp / "session", "--out", tmp / name, "--headless"};
    argv.insert(argv.end(), more.begin(), more.end());
    const Ran ran = run(argv, seconds(180));
    EXPECT_EQ(ran.code, 0) << ran.err;
    return json_of(tmp / (name + "/report.json"));
  };
  const Json again = replay("again", {});
  EXPECT_EQ(again["calibration"]["source"], "recording");
  EXPECT_EQ(again["calibration"]["sha256"], live["calibration"]["sha256"]);
  EXPECT_EQ(again["calibration"]["expected_p95_um"], 0.25);
  EXPECT_EQ(again["hash"], live["hash"]) << "the recording carries what measured it";
  EXPECT_EQ(again["calibration"]["marks"].size(), 2U) << "the recording says when it was made";
  // Control: the probe's own calibration gives another result.
  const Json own = replay("own", {"--rig", std::string(ENAMEL_SOURCE_DIR) + "/config/rigs/probe.json"});
  EXPECT_NE(own["hash"], live["hash"]);
  EXPECT_NE(own["calibration"]["sha256"], live["calibration"]["sha256"]);
  EXPECT_FALSE(own["calibration"].contains("verdict"));
  EXPECT_EQ(own["calibration"]["marks"].size(), 0U);
}

TEST(CalibrationInForce, terms_take_the_optics_to_the_bursts_temperature) {
  const TempFolder tmp;
  const auto hash = [&](const char* name, const auto& change) {
    Json rig = json_of(std::string(ENAMEL_SOURCE_DIR) + "/config/rigs/probe.json");
    change(rig);
    const std::string path = tmp / (std::string(name) + ".json");
    EXPECT_TRUE(write_file(path, rig.dump(1)));
    const Ran ran = run(
        {program("enamel"), "replay", small_capture(), "--out", tmp / name, "--headless", "--rig", path}, seconds(180));
    EXPECT_EQ(ran.code, 0) << ran.err;
    const Json report = json_of(tmp / (std::string(name) + "/report.json"));
    EXPECT_EQ(report["calibration"]["temp_c"], Json({32, 32}));
    return report["hash"];
  };
  constexpr double kPerKelvin = 0.5, kKelvins = 2;  // from 30 to the 32 degrees of the recording
  const auto terms = [=](Json& rig) {
    rig["temperature"] = {
        {"reference_c", 30}, {"range_c", {20, 40}}, {"per_kelvin", {{"camera", {{"fx", kPerKelvin}}}}}};
  };
  const auto moved = [=](Json& rig) {
    rig["camera"]["fx"] = rig["camera"]["fx"].get<double>() + kPerKelvin * kKelvins;
  };
  EXPECT_EQ(hash("terms", terms), hash("moved", moved));
  EXPECT_NE(hash("terms", terms), hash("as-it-is", [](Json&) {})) << "control";
}

TEST(CalibrationInForce, another_probes_is_refused) {
  const TempFolder tmp;
  const std::string rig = write_calibration(tmp, "SIM-0002", 1);
  const Ran scanned = scan(tmp, rig);
  EXPECT_EQ(scanned.code, 2);
  EXPECT_NE(scanned.err.find("SIM-0002"), std::string::npos) << scanned.err;
  const Ran replayed =
      run({program("enamel"), "replay", small_capture(), "--out", tmp / "r", "--headless", "--rig", rig});
  EXPECT_EQ(replayed.code, 2);
  EXPECT_NE(replayed.err.find("SIM-0001"), std::string::npos) << replayed.err;
}

}  // namespace
}  // namespace enamel::test
