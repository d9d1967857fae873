// A SIMULATED board in the guest: one clock makes the camera's frames, the edges on its lines and the projector's
// patterns. What the sensor sees are the bursts of a recording, pattern by pattern as the projector is triggered.
// Behind the last burst the first comes again. usage: board_sim RECORDING FRAMES_PER_SECOND [BURSTS]; with BURSTS, only
// so many of the recording's. SIGUSR1: gate and light high, as who holds them in a scan has them. Ends when the kernel
// closes the camera's connection.
#include <linux/gpio.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <random>
#include <thread>

#include "firmware/device/sim/capture_source.hpp"
#include "tests/guest/camera/usbip_link.hpp"
#include "tests/guest/probe/board_protocol.hpp"
#include "tests/unit/firmware/dlpc347x_model.hpp"

namespace {

using namespace enamel;
using namespace enamel::guest;

constexpr std::uint32_t kStrobe = 17, kT1 = 27, kT2 = 22, kGate = 23, kLight = 24;  // as tests/guest/probe/profile.toml
constexpr std::int64_t kMs = 1'000'000;

std::int64_t now_ns() {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

class Board {
 public:
  Board(std::vector<fw::SimBurst> bursts, std::int64_t exposure_ns)
      : bursts_(std::move(bursts)), exposure_ns_(exposure_ns) {
    projector_.on_start = [this] { pattern_ = 0; };
    set_current(false);
  }

  /// The sensor has just exposed this frame.
  void expose(std::span<std::uint8_t> pixels) {
    const std::lock_guard lock(mutex_);
    const std::int64_t begin = now_ns() - exposure_ns_;
    for (auto& p : pixels) p = static_cast<std::uint8_t>(1 + noise_() % 3);
    event(begin, kStrobe, true);
    if (!gate_ || !projector_.triggered) return;
    if (pattern_ == 0) {
      event(begin + exposure_ns_ / 100, kT1, true);
      ++burst_;
    }
    event(begin + exposure_ns_ / 20, kT2, true);
    event(begin + exposure_ns_ * 95 / 100, kT2, false);
    if (light_) {
      const auto& lit = bursts_[burst_ % bursts_.size()].frames[static_cast<std::size_t>(pattern_)];
      std::copy_n(lit.begin(), std::min(lit.size(), pixels.size()), pixels.begin());
    }
    pattern_ = (pattern_ + 1) % 4;
  }

  void serve(int fd) {
    Hello hello;
    if (::recv(fd, &hello, sizeof hello, 0) != static_cast<ssize_t>(sizeof hello)) return;
    if (hello.channel == Channel::kEvents) {
      const std::lock_guard lock(mutex_);
      events_ = fd;
      return;
    }
    if (hello.channel == Channel::kOutput) {
      // Requested without a value, an output is driven low.
      const std::lock_guard lock(mutex_);
      set(hello.line, false);
    }
    Packet packet;
    while (::recv(fd, &packet, sizeof packet, 0) == static_cast<ssize_t>(sizeof packet)) {
      {
        const std::lock_guard lock(mutex_);
        hello.channel == Channel::kBus ? transfer(packet) : set(hello.line, packet.data[0] != 0);
      }
      if (::send(fd, &packet, sizeof packet, MSG_NOSIGNAL) < 0) break;
    }
    // Whoever held a line is gone: it keeps its level, as most chips leave it.
    ::close(fd);
  }

  void light_up() {
    const std::lock_guard lock(mutex_);
    set(kGate, true);
    set(kLight, true);
  }

 private:
  void transfer(Packet& packet) {
    const std::span<std::uint8_t> bytes(packet.data.data(), packet.length);
    const auto done = packet.is_read != 0 ? projector_.write_read(asked_, bytes) : note(bytes);
    packet.refused = done ? 0 : 1;
  }
  /// A message without an answer is a write; one whose answer is fetched next was a question.
  Result<void> note(std::span<const std::uint8_t> bytes) {
    asked_.assign(bytes.begin(), bytes.end());
    return projector_.write(bytes);
  }
  void set(std::uint32_t line, bool high) {
    if (line == kGate) gate_ = high;
    if (line != kLight) return;
    light_ = high;
    set_current(high);
  }
  static void set_current(bool on) { std::ofstream("/run/led_ma") << (on ? 400 : 0) << std::flush; }
  void event(std::int64_t t, std::uint32_t line, bool rising) {
    if (events_ < 0) return;
    gpio_v2_line_event e{};
    e.timestamp_ns = static_cast<std::uint64_t>(t);
    e.id = rising ? GPIO_V2_LINE_EVENT_RISING_EDGE : GPIO_V2_LINE_EVENT_FALLING_EDGE;
    e.offset = line;
    e.seqno = ++seqno_;
    static_cast<void>(::send(events_, &e, sizeof e, MSG_NOSIGNAL | MSG_DONTWAIT));
  }

  const std::vector<fw::SimBurst> bursts_;  ///< all of them: unpacking one would hold up the frame it is for
  const std::int64_t exposure_ns_;
  std::mutex mutex_;
  fw::test::Dlpc347xModel projector_;
  std::vector<std::uint8_t> asked_;
  std::size_t burst_ = static_cast<std::size_t>(-1);
  bool gate_ = false, light_ = false;
  int pattern_ = 0;
  int events_ = -1;
  std::uint32_t seqno_ = 0;
  std::mt19937 noise_{1};
};

Result<std::vector<fw::SimBurst>> first_bursts(const std::string& recording, std::size_t most) {
  ENAMEL_TRY_ASSIGN(auto source, fw::CaptureSource::open(recording));
  std::vector<fw::SimBurst> all;
  while (all.size() < most) {
    ENAMEL_TRY_ASSIGN(auto next, source->next());
    if (!next) break;
    all.push_back(std::move(*next));
  }
  if (all.empty()) return fail(ErrorCode::kEmptyInput, recording);
  return all;
}

int listen_for_the_shim() {
  const int fd = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, kBoardSocket, sizeof address.sun_path - 1);
  ::unlink(kBoardSocket);
  const bool up = ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 && ::listen(fd, 8) == 0;
  return up ? fd : -1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) return std::fprintf(stderr, "usage: board_sim RECORDING FRAMES_PER_SECOND [BURSTS]\n"), 2;
  const std::size_t most = argc > 3 ? static_cast<std::size_t>(std::max(1, std::atoi(argv[3]))) : SIZE_MAX;
  auto bursts = first_bursts(argv[1], most);
  if (!bursts) return std::fprintf(stderr, "%s\n", bursts.error().message().c_str()), 1;
  UvcMode mode;
  mode.frames_per_second = static_cast<std::uint32_t>(std::max(1, std::atoi(argv[2])));
  // A quarter of the frame: the gate follows a strobe that is told when the exposure is over, and needs the rest.
  Board board(std::move(*bursts), 1000 * kMs / mode.frames_per_second / 4);
  sigset_t asked;
  ::sigemptyset(&asked);
  ::sigaddset(&asked, SIGUSR1);
  ::pthread_sigmask(SIG_BLOCK, &asked, nullptr);  // of the threads to come, too
  std::thread([&board, asked] {
    for (int signal = 0; ::sigwait(&asked, &signal) == 0;) board.light_up();
  }).detach();
  const int listener = listen_for_the_shim();
  if (listener < 0) return std::perror(kBoardSocket), 1;
  std::thread([&] {
    for (;;) {
      const int fd = ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
      if (fd < 0) return;
      std::thread([&board, fd] { board.serve(fd); }).detach();
    }
  }).detach();
  UsbipCamera camera(mode, [&](std::uint32_t, std::span<std::uint8_t> pixels) { board.expose(pixels); });
  if (!camera.attach()) return 1;
  std::_Exit(camera.run());  // its threads wait for good
}
