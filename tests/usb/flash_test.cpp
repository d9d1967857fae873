// enamel-flash as a process, real libusb, emulated ports: success, every refusal, broken cables, several probes.
#include <gtest/gtest.h>

#include <filesystem>

#include "protocol/image/dfu_suffix.hpp"
#include "tests/usb/bench_run.hpp"

namespace enamel::test {
namespace {

class Flash : public UsbBench {
 protected:
  [[nodiscard]] BenchResult flash(const std::vector<std::string>& probes, std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), program("enamel-flash"));
    return run(probes, arguments);
  }
  [[nodiscard]] std::string good() const { return make_image("good.enfw", {2, 0, 0, 0}, 2, 1U << 20U); }
};

TEST_F(Flash, list_looks_and_changes_nothing) {
  const BenchResult before = run({"{}"}, {"true"});
  const BenchResult r = flash({"{}"}, {"list"});
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_NE(r.output.find("EN2-0001"), std::string::npos) << r.output;
  EXPECT_NE(r.output.find("1.0.0+0"), std::string::npos) << r.output;
  EXPECT_NE(r.output.find("enamel probe"), std::string::npos) << r.output;
  EXPECT_EQ(r.probe(0), before.probe(0));
}

TEST_F(Flash, says_success_only_after_the_new_firmware_confirmed_itself) {
  const BenchResult r = flash({"{}"}, {"flash", good()});
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_NE(r.output.find("1.0.0+0 -> 2.0.0+0, confirmed"), std::string::npos) << r.output;
  EXPECT_EQ(r.probe(0)["active"], 1);
  EXPECT_EQ(r.probe(0)["slot_state"], (nlohmann::json{5, 5}));
}

TEST_F(Flash, unhealthy_firmware_is_rolled_back_and_never_called_success) {
  const BenchResult r = flash({R"({"healthy": false})"}, {"flash", good()});
  EXPECT_EQ(r.exit_code, 10) << r.output;
  EXPECT_EQ(r.output.find("-> 2.0.0+0, confirmed"), std::string::npos) << r.output;
  EXPECT_EQ(r.probe(0)["running"], 0);
  EXPECT_EQ(r.probe(0)["slot_state"][1], 6);
}

TEST_F(Flash, calibration_is_the_same_afterwards) {
  const BenchResult before = run({"{}"}, {"true"});
  const BenchResult after = flash({"{}"}, {"flash", good()});
  EXPECT_EQ(after.probe(0)["calibration_sha256"], before.probe(0)["calibration_sha256"]);
}

TEST_F(Flash, each_refusal_has_its_exit_code_and_the_old_firmware_stays) {
  image::ImageDescription d = plain_description();
  d.version = {2, 0, 0, 0};
  const auto payload = random_payload(100'000, 3);
  const image::Signer stranger = make_signer(77);
  const image::Signer& release = keys_.signer(0);
  image::ImageDescription foreign = d, wrong_hardware = d, older = d, development = d;
  foreign.product_id = 1;
  wrong_hardware.hw_rev_min = wrong_hardware.hw_rev_max = 9;
  older.version = {0, 9, 0, 0};
  development.flags |= image::image_flags::kDevelopment;
  std::vector<std::byte> truncated = build(d, payload, {&release, 1});
  truncated.resize(60'000);
  struct Case {
    const char* name;
    std::vector<std::byte> file;
    int exit_code;
    const char* number;
  };
  const Case cases[] = {
      {"unsigned", build(d, payload, {}), 6, "718"},
      {"unknown key", build(d, payload, {&stranger, 1}), 6, "714"},
      {"development", build(development, payload, {&keys_.signer(2), 1}), 6, "715"},
      {"product", build(foreign, payload, {&release, 1}), 5, "702"},
      {"hardware", build(wrong_hardware, payload, {&release, 1}), 5, "703"},
      {"older", build(older, payload, {&release, 1}), 7, "706"},
      {"truncated", truncated, 5, "716"},
      {"no image", payload, 5, "701"},
  };
  for (const Case& c : cases) {
    const BenchResult r = flash({"{}"}, {"flash", store("bad.enfw", c.file)});
    EXPECT_EQ(r.exit_code, c.exit_code) << c.name << '\n' << r.output;
    EXPECT_NE(r.output.find(c.number), std::string::npos) << c.name << '\n' << r.output;
    EXPECT_NE(r.output.find("what to do"), std::string::npos) << c.name;
    EXPECT_EQ(r.probe(0)["slot_state"], (nlohmann::json{5, 0})) << c.name << ": something was written";
  }
}

TEST_F(Flash, a_busy_or_weak_probe_says_so) {
  EXPECT_NE(flash({R"({"scanning": true})"}, {"flash", good()}).output.find("711"), std::string::npos);
  EXPECT_NE(flash({R"({"powered": false})"}, {"flash", good()}).output.find("710"), std::string::npos);
}

TEST_F(Flash, stalls_are_retried) {
  const BenchResult r = flash({R"({"stalls_at_block": 100, "stall_count": 3})"}, {"flash", good()});
  EXPECT_EQ(r.exit_code, 0) << r.output;
  const BenchResult never = flash({R"({"stalls_at_block": 100, "stall_count": 100000})"}, {"flash", good()});
  EXPECT_EQ(never.exit_code, 8) << never.output;
  EXPECT_EQ(never.probe(0)["slot_state"][0], 5);
}

TEST_F(Flash, a_pulled_cable_that_comes_back_is_resumed) {
  const BenchResult r = flash({R"({"pull_at_block": 80, "replug_ms": 700})"}, {"flash", good()});
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_EQ(r.probe(0)["active"], 1);
}

TEST_F(Flash, an_unknown_serial_is_no_probe) {
  const BenchResult r = flash({"{}"}, {"flash", "--serial", "EN2-9999", good()});
  EXPECT_EQ(r.exit_code, 3) << r.output;
}

TEST_F(Flash, several_probes_are_never_guessed_among) {
  const std::vector<std::string> three = {"{}", "{}", "{}"};
  const BenchResult guess = flash(three, {"flash", good()});
  EXPECT_EQ(guess.exit_code, 2) << guess.output;
  const BenchResult all = flash(three, {"flash", "--all", "--jobs", "3", "--json", good()});
  EXPECT_EQ(all.exit_code, 0) << all.output;
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(all.probe(i)["active"], 1);
}

TEST_F(Flash, one_probes_trouble_is_no_others) {
  const BenchResult r = flash({"{}", R"({"stalls_at_block": 50, "stall_count": 2})", R"({"healthy": false})"},
                              {"flash", "--all", good()});
  EXPECT_EQ(r.exit_code, 10) << r.output;
  EXPECT_EQ(r.probe(0)["active"], 1);
  EXPECT_EQ(r.probe(1)["active"], 1);
  EXPECT_EQ(r.probe(2)["running"], 0);
}

TEST_F(Flash, dry_run_and_same_version_write_nothing) {
  EXPECT_EQ(flash({"{}"}, {"flash", "--dry-run", good()}).probe(0)["slot_state"], (nlohmann::json{5, 0}));
  const std::string same = make_image("same.enfw", {1, 0, 0, 0}, 1, 100'000);
  const BenchResult r = flash({"{}"}, {"flash", same});
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_EQ(r.probe(0)["slot_state"], (nlohmann::json{5, 0}));
  EXPECT_EQ(flash({"{}"}, {"flash", "--allow-same", same}).probe(0)["active"], 1);
}

TEST_F(Flash, the_calibration_is_copied_byte_for_byte) {
  const std::string copy = path("rig.json");
  EXPECT_EQ(flash({"{}"}, {"info", "--save-calib", copy}).exit_code, 0);
  const std::vector<std::byte> wanted = random_payload(9000, 31);
  EXPECT_EQ(read(copy), std::string(reinterpret_cast<const char*>(wanted.data()), wanted.size()));
  EXPECT_EQ(flash({R"({"rig_bytes": 8192})"}, {"info", "--save-calib", copy}).exit_code, 0);
  EXPECT_EQ(read(copy).size(), 8192U) << "an empty block ends it";
  const BenchResult none = flash({R"({"rig_bytes": 0})"}, {"info", "--save-calib", path("none.json")});
  EXPECT_EQ(none.exit_code, 8);
  EXPECT_NE(none.output.find("721"), std::string::npos) << none.output;
  EXPECT_FALSE(std::filesystem::exists(path("none.json")));
  EXPECT_EQ(flash({R"({"rig_bytes": 70000})"}, {"info", "--save-calib", path("none.json")}).exit_code, 8);
  EXPECT_EQ(flash({"{}", "{}"}, {"info", "--all", "--save-calib", copy}).exit_code, 2);
  EXPECT_EQ(flash({"{}"}, {"info", "--save-calib", path("absent/rig.json")}).exit_code, 2);
  EXPECT_EQ(flash({"{}"}, {"info"}).exit_code, 2);
}

TEST_F(Flash, other_commands) {
  EXPECT_EQ(flash({"{}"}, {"selftest"}).exit_code, 0);
  EXPECT_EQ(flash({"{}"}, {"confirm", "--commit"}).probe(0)["min_security_counter"], 1);
  EXPECT_EQ(flash({"{}"}, {"rollback"}).exit_code, 10) << "the other slot is empty";
  EXPECT_EQ(flash({"{}"}, {"verify", good()}).exit_code, 9);
  EXPECT_EQ(flash({"{}"}, {"factory-reset", "--yes-really", "EN2-0001"}).exit_code, 0);
  EXPECT_EQ(flash({"{}"}, {"factory-reset", "--yes-really", "EN2-0002"}).exit_code, 3);
  EXPECT_EQ(flash({"{}"}, {"info", good()}).exit_code, 0);
  EXPECT_EQ(flash({"{}"}, {"frobnicate"}).exit_code, 2);
}

}  // namespace
}  // namespace enamel::test
