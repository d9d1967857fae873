// The probe's program by its exit codes.
#include "tests/unit/firmware/probe_process.hpp"

namespace enamel::fw::test {
namespace {

TEST(ProbeProgram, exit_codes_tell_usage_input_and_device_errors_apart) {
  EXPECT_EQ(run_to_end({"--help"}), 0);
  EXPECT_EQ(run_to_end({}), 1);
  EXPECT_EQ(run_to_end({"--play", "a", "--camera", "b"}), 1);
  EXPECT_EQ(run_to_end({"--play", "x", "--speed", "0"}), 1);
  EXPECT_EQ(run_to_end({"--play", "/nonexistent.mcap"}), 2);
  EXPECT_EQ(run_to_end({"--play", "/dev/null"}), 2);
  EXPECT_EQ(run_to_end({"--camera", "0"}), 3);
  EXPECT_EQ(run_to_end({"--check", "--camera", "0"}), 1);
  EXPECT_EQ(run_to_end({"--dark", "--play", "x"}), 1);
}

}  // namespace
}  // namespace enamel::fw::test
