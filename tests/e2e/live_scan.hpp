// A probe that plays the small recording (40 bursts a round) and a host that scans it, as real processes.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/e2e/small_capture.hpp"
#include "tests/support/run.hpp"

namespace enamel::test {

inline app::ChildProcess start_probe(const TempFolder& tmp, const std::string& tag, const std::string& serial,
                                     const std::string& loops = "1") {
  auto child = app::ChildProcess::start(
      {program("enamel-probe"), "--play", small_capture(), "--serial", serial, "--dds-tag", tag, "--loops", loops},
      {tmp / (serial + ".out"), tmp / (serial + ".log")});
  EXPECT_TRUE(child);
  return std::move(*child);
}

inline nlohmann::json report_of(const std::string& folder) {
  return nlohmann::json::parse(read_file(folder + "/report.json").value_or("{}"), nullptr, false);
}

inline std::vector<std::string> scan_command(const TempFolder& tmp, const std::string& tag) {
  return {program("enamel"), "scan", "--headless", "--session", tmp / "session", "--dds-tag", tag};
}

inline void expect_balanced(const nlohmann::json& bursts) {
  std::uint64_t rejected = 0;
  for (const auto& [reason, count] : bursts["rejected"].items()) rejected += count.get<std::uint64_t>();
  EXPECT_EQ(bursts["captured"].get<std::uint64_t>(),
            bursts["lost_on_wire"].get<std::uint64_t>() + bursts["incomplete"].get<std::uint64_t>() +
                bursts["shed"].get<std::uint64_t>() + bursts["accepted"].get<std::uint64_t>())
      << bursts;
  EXPECT_EQ(bursts["accepted"].get<std::uint64_t>(), bursts["fused"].get<std::uint64_t>() + rejected) << bursts;
}

}  // namespace enamel::test
