// What a field engineer meets: no permission, probes that vanish, come back elsewhere or fall silent, Ctrl-C, logs.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <span>
#include <sstream>

#include "tests/usb/bench_run.hpp"

namespace enamel::test {
namespace {

constexpr std::uint32_t kBlocks = 259;  ///< of an image of 1 MiB: 3 of the manifest, 256 of the payload

class Field : public UsbBench {
 protected:
  [[nodiscard]] std::string good() const { return make_image("good.enfw", {2, 0, 0, 0}, 2, 1U << 20U); }
  [[nodiscard]] BenchResult flash(const std::vector<std::string>& probes, std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), program("enamel-flash"));
    return run(probes, arguments);
  }
  [[nodiscard]] std::vector<nlohmann::json> log_lines(const std::string& name) const {
    std::vector<nlohmann::json> lines;
    std::istringstream text(read(path(name)));
    for (std::string line; std::getline(text, line);) lines.push_back(nlohmann::json::parse(line));
    return lines;
  }
  [[nodiscard]] static bool has_event(const std::vector<nlohmann::json>& lines, const std::string& serial,
                                      const std::string& event) {
    return std::any_of(lines.begin(), lines.end(),
                       [&](const nlohmann::json& j) { return j["serial"] == serial && j["event"] == event; });
  }
};

TEST_F(Field, without_permission_the_rule_is_there_to_install) {
  std::vector<std::string> command;
  // Root may open everything whatever its mode: then the tool runs as somebody else.
  const bool root = ::geteuid() == 0;
  if (root) command = {"setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"};
  command.insert(command.end(), {program("enamel-flash"), "flash", good()});
  ASSERT_EQ(::chmod(folder_.path().c_str(), 0755), 0);
  const BenchResult r = run({root ? R"({"mode": "0600"})" : R"({"mode": "0000"})"}, command);
  EXPECT_EQ(r.exit_code, 4) << r.output;
  EXPECT_NE(r.output.find("\n  SUBSYSTEM==\"usb\", ATTR{idVendor}==\"1209\", ATTR{idProduct}==\"000[12]\", "
                          "TAG+=\"uaccess\", MODE=\"0660\"\n"),
            std::string::npos)
      << r.output;
  EXPECT_NE(r.output.find("/etc/udev/rules.d/70-enamel.rules"), std::string::npos) << r.output;
  EXPECT_EQ(r.probe(0)["slot_state"], (nlohmann::json{5, 0}));
  const BenchResult allowed = run({R"({"mode": "0666"})"}, command);
  EXPECT_EQ(allowed.exit_code, 0) << "control: what the rule gives is enough\n" << allowed.output;
}

TEST_F(Field, of_three_one_is_pulled_for_good_one_stalls_one_is_healthy) {
  const std::string pull = std::to_string(kBlocks * 3 / 10);
  const BenchResult r = flash(
      {"{}", R"({"power_lost": true, "pull_at_block": )" + pull + "}", R"({"stalls_at_block": 100, "stall_count": 3})"},
      {"flash", "--all", "--jobs", "3", "--wait", "2", "--json-log", path("log"), good()});
  EXPECT_EQ(r.exit_code, 8) << r.output;
  EXPECT_EQ(r.probe(0)["active"], 1) << "healthy";
  EXPECT_EQ(r.probe(1)["plugged"], false);
  EXPECT_EQ(r.probe(1)["running"], 0) << "the old firmware boots on the pulled one";
  EXPECT_EQ(r.probe(1)["major"][0], 1);
  EXPECT_EQ(r.probe(2)["active"], 1) << "stalling";
  EXPECT_NE(r.output.find("EN2-0002: not updated"), std::string::npos) << r.output;
  EXPECT_NE(r.output.find("plug it in and run the same command again"), std::string::npos) << r.output;
  const auto lines = log_lines("log");
  EXPECT_TRUE(has_event(lines, "EN2-0001", "confirmed"));
  EXPECT_TRUE(has_event(lines, "EN2-0002", "failed"));
  EXPECT_TRUE(has_event(lines, "EN2-0003", "broken"));
  EXPECT_TRUE(has_event(lines, "EN2-0003", "confirmed"));
}

TEST_F(Field, a_pulled_probe_is_resumed_by_the_same_command) {
  const std::string flash_it = program("enamel-flash") + " flash --wait 1 --resume " + good();
  const BenchResult r = run({R"({"power_lost": true, "pull_at_block": 200, "replug_ms": 1500})"},
                            {"sh", "-c", flash_it + "; first=$?; sleep 1; " + flash_it + " && exit $first"});
  EXPECT_EQ(r.exit_code, 8) << "the first run gave up, the second one succeeded\n" << r.output;
  EXPECT_NE(r.output.find("2.0.0+0, confirmed"), std::string::npos) << r.output;
  EXPECT_EQ(r.probe(0)["active"], 1);
}

TEST_F(Field, a_probe_that_comes_back_at_another_port_is_found_by_its_serial) {
  const BenchResult r = flash({R"({"pull_at_block": 80, "replug_ms": 300, "replug_port": 7})", "{}"},
                              {"flash", "--serial", "EN2-0001", "--wait", "6", "--json-log", path("log"), good()});
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_EQ(r.probe(0)["active"], 1);
  EXPECT_EQ(r.probe(1)["active"], 0) << "the other probe is left alone";
  EXPECT_TRUE(has_event(log_lines("log"), "EN2-0001", "back"));
  EXPECT_NE(read(path("log")).find("port 1-7"), std::string::npos);
}

TEST_F(Field, nobody_is_flashed_in_place_of_one_that_went_away) {
  const BenchResult r = flash({R"({"pull_at_block": 80})", "{}"}, {"flash", "--port", "1-1", "--wait", "2", good()});
  EXPECT_EQ(r.exit_code, 8) << r.output;
  EXPECT_EQ(r.probe(1)["slot_state"], (nlohmann::json{5, 0}));
}

TEST_F(Field, a_silence_ends_and_is_retried) {
  const BenchResult r =
      flash({R"({"silent_at_block": 50, "silent_count": 1})"}, {"flash", "--json-log", path("log"), good()});
  EXPECT_EQ(r.exit_code, 0) << r.output;
  bool told = false;
  for (const nlohmann::json& j : log_lines("log"))
    told = told || (j["event"] == "broken" && j["status"] == "no answer in time");
  EXPECT_TRUE(told) << read(path("log"));
}

TEST_F(Field, ctrl_c_leaves_the_old_firmware_and_a_probe_at_rest) {
  const BenchResult r = flash({R"({"interrupt_at_block": 60})"}, {"flash", good()});
  EXPECT_EQ(r.exit_code, 11) << r.output;
  EXPECT_EQ(r.probe(0)["dfu_state"], 2) << "dfuIDLE";
  EXPECT_EQ(r.probe(0)["running"], 0);
  EXPECT_EQ(r.probe(0)["active"], 0);
}

TEST_F(Field, the_log_has_its_fields_and_keeps_thirty_days) {
  ASSERT_TRUE(write_file(path("log"), R"({"ts": "2000-01-01T00:00:00.000Z", "serial": "OLD"})"
                                      "\n"
                                      R"({"ts": "2999-01-01T00:00:00.000Z", "serial": "YOUNG"})"
                                      "\n")
                  .has_value());
  const BenchResult r =
      flash({R"({"stalls_at_block": 100, "stall_count": 1})"}, {"flash", "--json-log", path("log"), good()});
  EXPECT_EQ(r.exit_code, 0) << r.output;
  const auto lines = log_lines("log");
  ASSERT_GE(lines.size(), 7U);
  EXPECT_EQ(lines[0]["serial"], "YOUNG") << "older than 30 days goes, the rest stays";
  std::vector<std::string> events;
  for (const nlohmann::json& j : std::span(lines).subspan(1)) {
    for (const char* key : {"ts", "serial", "event", "block", "status"}) EXPECT_TRUE(j.contains(key)) << j;
    EXPECT_EQ(j["serial"], "EN2-0001");
    events.push_back(j["event"]);
    if (j["event"] == "broken") {
      EXPECT_EQ(j["block"], 98) << "the hundredth that the port saw, after the one that asks, counted from 0";
    }
  }
  EXPECT_EQ(events, (std::vector<std::string>{"begin", "sending", "broken", "sending", "verifying", "restarting",
                                              "back", "confirmed"}));
  const BenchResult nowhere = flash({"{}"}, {"flash", "--json-log", path("no/such/folder/log"), good()});
  EXPECT_EQ(nowhere.exit_code, 2) << nowhere.output;
  EXPECT_EQ(nowhere.probe(0)["slot_state"], (nlohmann::json{5, 0}));
}

TEST_F(Field, list_tells_battery_and_port_speed) {
  const BenchResult r = flash({"{}", R"({"speed_mbit": 12})"}, {"list"});
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_NE(r.output.find("battery 3.90 V, port 480 Mbit/s"), std::string::npos) << r.output;
  EXPECT_NE(r.output.find("battery 3.90 V, port 12 Mbit/s"), std::string::npos) << r.output;
}

TEST_F(Field, a_slow_port_is_told_and_is_no_failure) {
  const BenchResult slow = flash({R"({"speed_mbit": 12})"}, {"flash", good()});
  EXPECT_EQ(slow.exit_code, 0) << slow.output;
  EXPECT_NE(slow.output.find("the port is slow: EN2-0001, 12 Mbit/s"), std::string::npos) << slow.output;
  EXPECT_EQ(flash({"{}"}, {"flash", good()}).output.find("slow"), std::string::npos);
}

TEST_F(Field, preflight_asks_the_probe_itself_and_writes_nothing) {
  const BenchResult scanning = flash({R"({"scanning": true})"}, {"flash", "--dry-run", good()});
  EXPECT_EQ(scanning.exit_code, 8) << scanning.output;
  EXPECT_NE(scanning.output.find("711"), std::string::npos) << scanning.output;
  const BenchResult weak = flash({R"({"powered": false})"}, {"flash", "--dry-run", good()});
  EXPECT_EQ(weak.exit_code, 8) << weak.output;
  EXPECT_NE(weak.output.find("710"), std::string::npos) << weak.output;
  const BenchResult ready = flash({"{}"}, {"flash", "--dry-run", good()});
  EXPECT_EQ(ready.exit_code, 0) << ready.output;
  for (const BenchResult* r : {&scanning, &weak, &ready}) {
    EXPECT_EQ(r->probe(0)["slot_state"], (nlohmann::json{5, 0}));
    EXPECT_EQ(r->probe(0)["dfu_state"], 2) << "dfuIDLE";
  }
}

TEST_F(Field, a_port_chooses_among_several) {
  const BenchResult r = flash({"{}", "{}"}, {"flash", "--port", "1-2", good()});
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_EQ(r.probe(0)["active"], 0);
  EXPECT_EQ(r.probe(1)["active"], 1);
}

}  // namespace
}  // namespace enamel::test
