// The unmodified dfu-util against our device half: real libusb, emulated port.
#include <gtest/gtest.h>

#include "tests/usb/bench_run.hpp"

namespace enamel::test {
namespace {

class DfuUtil : public UsbBench {};

TEST_F(DfuUtil, lists_the_probe) {
  const BenchResult r = run({"{}"}, {"dfu-util", "-l"});
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_NE(r.output.find("serial=\"EN2-0001\""), std::string::npos) << r.output;
  EXPECT_NE(r.output.find("ver=0100"), std::string::npos) << r.output;
}

TEST_F(DfuUtil, downloads_our_image_and_reads_the_status_back) {
  const std::string image = make_image("good.enfw", {2, 0, 0, 0}, 2, 2U << 20U);
  const BenchResult down = run({"{}"}, {"dfu-util", "-d", "1209:0001", "-D", image});
  EXPECT_EQ(down.exit_code, 0) << down.output;
  EXPECT_EQ(down.probe(0)["slot_state"][1], 3) << "PENDING\n" << down.output;
  EXPECT_EQ(down.probe(0)["slot_state"][0], 5);
  const BenchResult up = run({"{}"}, {"dfu-util", "-d", "1209:0001", "-U", path("status.bin")});
  EXPECT_EQ(up.exit_code, 0) << up.output;
  const std::string block = read(path("status.bin"));
  const auto status = image::decode_status(std::as_bytes(std::span(block)));
  ASSERT_TRUE(status.has_value()) << up.output;
  EXPECT_EQ(status->version[0].major, 1);
}

TEST_F(DfuUtil, is_told_of_a_refusal) {
  const std::string image = make_image("old.enfw", {0, 1, 0, 0}, 1, 100'000);
  const BenchResult r = run({"{}"}, {"dfu-util", "-d", "1209:0001", "-D", image});
  EXPECT_NE(r.exit_code, 0) << r.output;
  EXPECT_EQ(r.probe(0)["last_error"], 706);
  EXPECT_EQ(r.probe(0)["slot_state"][1], 0) << "nothing was written";
}

}  // namespace
}  // namespace enamel::test
