#include <fcntl.h>
#include <unistd.h>

#include "tests/unit/motion/grbl_fixture.hpp"

namespace enamel::motion {
namespace {

std::string open_error(test::GrblModelSetup setup) {
  SteadyClock clock;
  const test::GrblModel model(std::move(setup));
  const auto axes = GrblAxes::open(model.port(), quick_profile(), clock);
  if (axes) return {};
  EXPECT_TRUE(axes.error().code == ErrorCode::kAxes || axes.error().code == ErrorCode::kConfigValue);
  EXPECT_FALSE(model.was_told_to_move_before_home());
  return axes.error().detail;
}

::testing::AssertionResult tells(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "'" << text << "' lacks '" << part << "'";
}

TEST(GrblGreeting, a_controller_that_boots_or_runs_already_is_greeted) {
  EXPECT_EQ(open_error({}), "");
  EXPECT_EQ(open_error({.boots_on_open = false}), "") << "asked by a soft reset";
}

TEST(GrblGreeting, whoever_is_no_grbl_1_1_is_refused_by_name) {
  EXPECT_TRUE(tells(open_error({.banner = ""}), "does not answer"));
  EXPECT_TRUE(tells(open_error({.banner = "start Marlin 2.1.2"}), "Marlin 2.1.2"));
  EXPECT_TRUE(tells(open_error({.banner = "Grbl 0.9j ['$' for help]"}), "runs Grbl 0.9j"));
  EXPECT_TRUE(tells(open_error({.banner = "Grbl 3.7 [FluidNC v3.7]"}), "runs Grbl 3.7"));
}

TEST(GrblGreeting, a_table_set_up_for_other_microsteps_is_refused_with_both_numbers) {
  EXPECT_TRUE(tells(open_error({.settings = {{100, 1600}}}), "$100 is 1600, expected 800"));
  EXPECT_TRUE(tells(open_error({.settings = {{13, 1}}}), "$13"));
  EXPECT_TRUE(tells(open_error({.settings = {{10, 0}}}), "$10"));
}

TEST(GrblGreeting, a_port_that_is_none_is_told_with_a_remedy) {
  SteadyClock clock;
  EXPECT_TRUE(tells(SerialPort::open("/dev/ttyNONE9", clock).error().detail, "no such port"));
  EXPECT_TRUE(tells(SerialPort::open("/dev/null", clock).error().detail, "no serial port"));
  const test::GrblModel model;
  const auto first = SerialPort::open(model.port(), clock);
  ASSERT_TRUE(first) << first.error().detail;
  EXPECT_TRUE(tells(SerialPort::open(model.port(), clock).error().detail, "another program"));
}

TEST(GrblGreeting, a_write_that_blocks_ends_at_its_deadline) {
  SteadyClock clock;
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(master, 0);
  ASSERT_EQ(::grantpt(master), 0);
  ASSERT_EQ(::unlockpt(master), 0);
  auto port = SerialPort::open(::ptsname(master), clock);
  ASSERT_TRUE(port) << port.error().detail;
  const HostTime begin = clock.now();
  const auto written = port->write(std::string(1 << 20, 'x'), begin + std::chrono::milliseconds(200));
  ASSERT_FALSE(written) << "nobody reads the other end";
  EXPECT_TRUE(tells(written.error().detail, "takes no more bytes"));
  EXPECT_LT(clock.now() - begin, std::chrono::seconds(1));
  EXPECT_GE(clock.now() - begin, std::chrono::milliseconds(200));
  ::close(master);
  EXPECT_FALSE(port->read_line(clock.now() + std::chrono::seconds(5))) << "unplugged";
  EXPECT_TRUE(port->is_lost());
}

}  // namespace
}  // namespace enamel::motion
