// Runs a program that uses libusb beside emulated probes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocol/base/file.hpp"
#include "protocol/image/status_block.hpp"
#include "tests/support/firmware_image.hpp"
#include "tests/support/run.hpp"

namespace enamel::test {

struct BenchResult {
  int exit_code = -1;
  std::string output;  ///< of the command, stdout then stderr
  nlohmann::json report;
  [[nodiscard]] const nlohmann::json& probe(std::size_t i) const { return report.at("probes").at(i); }
};

class UsbBench : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] static std::string read(const std::string& file) { return read_file(file).value_or(""); }

  /// An image that an emulated probe of hardware 2 trusts.
  [[nodiscard]] std::string make_image(const std::string& name, image::ImageVersion version, std::uint32_t counter,
                                       std::size_t payload) const {
    image::ImageDescription d = plain_description();
    d.version = version;
    d.security_counter = counter;
    return store(name, build(d, random_payload(payload, version.major), {&keys_.signer(0), 1}));
  }
  [[nodiscard]] std::string store(const std::string& name, const std::vector<std::byte>& bytes) const {
    EXPECT_TRUE(write_file(path(name), {reinterpret_cast<const char*>(bytes.data()), bytes.size()}).has_value());
    return path(name);
  }

  [[nodiscard]] BenchResult run(const std::vector<std::string>& probes, const std::vector<std::string>& command) const {
    std::vector<std::string> argv = {"/usr/bin/umockdev-wrapper", program("usb_bench"), "--report",
                                     path("report.json")};
    for (const std::string& probe : probes) argv.insert(argv.end(), {"--probe", probe});
    argv.emplace_back("--");
    argv.insert(argv.end(), command.begin(), command.end());
    BenchResult result = run_once(argv);
    for (int again = 2; again > 0 && emulation_broke(result); --again) result = run_once(argv);
    if (!result.report.is_object()) throw std::runtime_error("usb_bench left no report: " + result.output);
    return result;
  }

  /// Two races of the emulation's own end a process, where a kernel goes on: the preload library's when a device is
  /// unplugged in the moment in which it hands an ioctl over (ECONNRESET; a kernel answers ENODEV), and the testbed's
  /// when a program closes its hotplug monitor while an event is sent to it (ENOENT). Anything else is a failure.
  [[nodiscard]] static bool emulation_broke(const BenchResult& result) {
    constexpr std::array kLastWords = {
        "libumockdev-preload: Error communicating with ioctl socket",
        "sendmsg_one: cannot connect to client's event socket: No such file or directory",
    };
    return !result.report.is_object() && std::any_of(kLastWords.begin(), kLastWords.end(), [&](const char* words) {
      return result.output.find(words) != std::string::npos;
    });
  }

  [[nodiscard]] BenchResult run_once(const std::vector<std::string>& argv) const {
    std::filesystem::remove(path("report.json"));  // of an earlier run
    const Ran ran = test::run(argv, std::chrono::seconds(100));
    return {ran.code, ran.out + ran.err, nlohmann::json::parse(read(path("report.json")), nullptr, false)};
  }

  KeyRing keys_;
  TempFolder folder_;
};

}  // namespace enamel::test
