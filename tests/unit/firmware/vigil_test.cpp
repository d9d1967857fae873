// The board's small outputs: heater by PWM files, watchdog, what a service manager hears. Files and sockets stand in
// for the kernel's.
#include "firmware/control/vigil.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "firmware/device/linux/lines/kernel_watchdog.hpp"
#include "firmware/device/linux/lines/pwm_heater.hpp"

namespace enamel::fw::test {
namespace {

using testing::HasSubstr;

std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The bytes that are in a non-blocking descriptor.
std::string drained(int fd) {
  std::array<char, 256> buffer{};
  const ssize_t n = ::read(fd, buffer.data(), buffer.size());
  return n > 0 ? std::string(buffer.data(), static_cast<std::size_t>(n)) : "";
}

class PwmFiles : public testing::Test {
 protected:
  PwmFiles() {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder / "pwm0");
    for (const char* name : {"period", "duty_cycle", "enable"}) std::ofstream(folder / "pwm0" / name) << "7777777";
  }
  std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "pwmchip0";
};

TEST_F(PwmFiles, heater_opens_at_zero_drives_and_ends_off) {
  {
    const auto heater = PwmHeater::open(folder / "pwm0", 1000);
    ASSERT_TRUE(heater.has_value()) << heater.error().message();
    EXPECT_THAT(text_of(folder / "pwm0/duty_cycle"), testing::StartsWith("0"));
    EXPECT_THAT(text_of(folder / "pwm0/period"), testing::StartsWith("1000000"));
    (*heater)->set_power(250);
    EXPECT_THAT(text_of(folder / "pwm0/duty_cycle"), testing::StartsWith("250000"));
    (*heater)->set_power(5000);
    EXPECT_THAT(text_of(folder / "pwm0/duty_cycle"), testing::StartsWith("1000000")) << "at most full power";
  }
  EXPECT_THAT(text_of(folder / "pwm0/duty_cycle"), testing::StartsWith("0"));
  EXPECT_THAT(text_of(folder / "pwm0/enable"), testing::StartsWith("0"));
}

TEST_F(PwmFiles, heater_that_is_not_there_is_told_with_the_remedy) {
  std::ofstream(folder / "export").put('\n');
  const auto not_exported = PwmHeater::open(folder / "pwm3", 1000);
  ASSERT_FALSE(not_exported.has_value());
  EXPECT_EQ(not_exported.error().code, ErrorCode::kBoardThermal);
  EXPECT_THAT(text_of(folder / "export"), testing::StartsWith("3")) << "it was asked for";
  const auto nowhere = PwmHeater::open("/nowhere/pwmchip0/pwm0", 1000);
  ASSERT_FALSE(nowhere.has_value());
  EXPECT_THAT(nowhere.error().detail, HasSubstr("overlay"));
  EXPECT_FALSE(PwmHeater::open((folder / "duty").string(), 1000).has_value());
}

TEST(KernelWatchdogs, are_fed_and_disarmed_at_the_end) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe2(pipe.data(), O_NONBLOCK | O_CLOEXEC), 0);
  const LineHandle reader(pipe[0]);
  {
    KernelWatchdog dog{LineHandle(pipe[1])};
    dog.feed();
    dog.feed();
    EXPECT_EQ(drained(reader.fd()), "\x01\x01");
  }
  EXPECT_EQ(drained(reader.fd()), "V");
}

TEST(KernelWatchdogs, that_are_none_are_told_with_the_remedy) {
  const auto none = KernelWatchdog::open("/dev/nosuchdog", 10);
  ASSERT_FALSE(none.has_value());
  EXPECT_EQ(none.error().code, ErrorCode::kBoardLine);
  EXPECT_THAT(none.error().detail, HasSubstr("driver"));
  EXPECT_FALSE(KernelWatchdog::open("/dev/null", 10).has_value());
}

class CountingDog final : public Watchdog {
 public:
  void feed() noexcept override { ++fed; }
  int fed = 0;
};

TEST(Vigils, feed_once_a_second_while_the_acquisition_lives) {
  ::unsetenv("NOTIFY_SOCKET");
  CountingDog dog;
  Vigil vigil(&dog, Nanoseconds{2'000'000'000});
  for (int ms = 0; ms < 10'000; ms += 10) vigil.step(Nanoseconds{5'000'000}, host_time(std::int64_t{ms} * 1'000'000));
  EXPECT_EQ(dog.fed, 10);
  for (int ms = 10'000; ms < 20'000; ms += 10) {
    vigil.step(Nanoseconds{2'100'000'000}, host_time(std::int64_t{ms} * 1'000'000));
  }
  EXPECT_EQ(dog.fed, 10) << "it hangs: the board is reset";
}

TEST(Vigils, tell_the_service_manager) {
  const std::string path = testing::TempDir() + "/notify.socket";
  std::filesystem::remove(path);
  const LineHandle manager(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  ASSERT_LT(path.size(), sizeof at.sun_path);
  path.copy(at.sun_path, path.size());
  ASSERT_EQ(::bind(manager.fd(), reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
  ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
  {
    Vigil vigil(nullptr, Nanoseconds{2'000'000'000});
    EXPECT_EQ(drained(manager.fd()), "READY=1");
    vigil.step(Nanoseconds{}, host_time(1));
    EXPECT_EQ(drained(manager.fd()), "WATCHDOG=1");
  }
  EXPECT_EQ(drained(manager.fd()), "STOPPING=1");
  ::unsetenv("NOTIFY_SOCKET");
}

}  // namespace
}  // namespace enamel::fw::test
