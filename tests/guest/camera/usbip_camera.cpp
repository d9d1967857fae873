// Puts a SIMULATED USB camera on the guest's bus: speaks USB/IP with the kernel's vhci_hcd over a socket pair, so that
// uvcvideo and libcamera drive it as they drive any other.
// usage: usbip_camera [FRAMES_PER_SECOND [N]]; ends when the kernel closes the connection. N: of every N-th frame one
// bit is turned.
#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <string>
#include <thread>

#include "tests/guest/camera/frame_content.hpp"
#include "tests/guest/camera/uvc_device.hpp"

namespace {

using namespace enamel::guest;
using std::chrono::steady_clock;

constexpr const char* kBus = "/sys/devices/platform/vhci_hcd.0";
constexpr std::uint32_t kSubmit = 1, kUnlink = 2, kSubmitted = 3, kUnlinked = 4;
constexpr std::uint32_t kIn = 1;
constexpr int kStall = -32, kConnectionReset = -104;

/// drivers/usb/usbip/usbip_common.h: 48 bytes, big endian.
struct Header {
  std::array<std::uint32_t, 12> word{};
  [[nodiscard]] std::uint32_t command() const { return ntohl(word[0]); }
  [[nodiscard]] std::uint32_t sequence() const { return ntohl(word[1]); }
  [[nodiscard]] std::uint32_t direction() const { return ntohl(word[3]); }
  [[nodiscard]] std::uint32_t endpoint() const { return ntohl(word[4]); }
  [[nodiscard]] std::uint32_t length() const { return ntohl(word[6]); }
  [[nodiscard]] std::uint32_t unlinked() const { return ntohl(word[5]); }
  [[nodiscard]] Setup setup() const {
    std::array<std::uint8_t, 8> b{};
    std::memcpy(b.data(), &word[10], b.size());
    const auto u16 = [&](std::size_t i) { return static_cast<std::uint16_t>(b[i] | (b[i + 1] << 8)); };
    return {b[0], b[1], u16(2), u16(4), u16(6)};
  }
};
static_assert(sizeof(Header) == 48);

class Camera {
 public:
  Camera(int socket, UvcMode mode, std::uint32_t spoil_every)
      : socket_(socket), device_(mode), spoil_every_(spoil_every), payload_(device_.payload_bytes()) {}

  int run() {
    for (;;) {
      pollfd wait{socket_, POLLIN, 0};
      if (::poll(&wait, 1, waiting_.empty() ? -1 : ms_to_next()) < 0) return 1;
      if ((wait.revents & (POLLIN | POLLHUP)) != 0 && !take()) return 0;
      while (!waiting_.empty() && ms_to_next() == 0) send_part();
    }
  }

 private:
  bool take() {
    Header h;
    if (!read_all(&h, sizeof h)) return false;
    if (h.command() == kUnlink) return unlink(h);
    if (h.command() != kSubmit) return false;
    Bytes sent(h.direction() == kIn ? 0 : h.length());
    if (!sent.empty() && !read_all(sent.data(), sent.size())) return false;
    if (h.endpoint() != 0) {
      if (waiting_.empty() && at_ == 0) next_ = std::max(next_, steady_clock::now());
      waiting_.push_back(h);
      return true;
    }
    const auto answer = device_.control(h.setup(), sent);
    return reply(h, answer ? 0 : kStall, answer.value_or(Bytes{}), answer && h.direction() != kIn ? h.length() : 0);
  }
  bool unlink(const Header& h) {
    const auto it =
        std::find_if(waiting_.begin(), waiting_.end(), [&](const Header& w) { return w.sequence() == h.unlinked(); });
    const bool was_waiting = it != waiting_.end();
    if (was_waiting) waiting_.erase(it);
    at_ = 0;  // the stream was stopped: the next one begins with a whole frame
    Header r;
    r.word[0] = htonl(kUnlinked);
    r.word[1] = h.word[1];
    r.word[5] = htonl(static_cast<std::uint32_t>(was_waiting ? kConnectionReset : 0));
    return write_all(&r, sizeof r);
  }
  /// The next piece of the current payload into the oldest transfer that waits.
  void send_part() {
    if (at_ == 0) {
      payload_[0] = UvcDevice::kPayloadHeader;
      payload_[1] = static_cast<std::uint8_t>(0x80U | 0x02U | (counter_ & 1U));  // end of header, of frame; frame id
      fill_frame(counter_, std::span(payload_).subspan(UvcDevice::kPayloadHeader));
      if (spoil_every_ > 0 && counter_ % spoil_every_ == 0) payload_.back() ^= 1U;
    }
    const Header h = waiting_.front();
    waiting_.pop_front();
    const std::size_t size = std::min<std::size_t>(h.length(), payload_.size() - at_);
    reply(h, 0,
          Bytes(payload_.begin() + static_cast<std::ptrdiff_t>(at_),
                payload_.begin() + static_cast<std::ptrdiff_t>(at_ + size)),
          0);
    at_ += size;
    if (at_ < payload_.size()) return;
    at_ = 0;
    ++counter_;
    next_ = std::max(next_ + period(), steady_clock::now() - period());
  }
  bool reply(const Header& to, int status, const Bytes& data, std::uint32_t taken) {
    Header r;
    r.word[0] = htonl(kSubmitted);
    r.word[1] = to.word[1];
    r.word[5] = htonl(static_cast<std::uint32_t>(status));
    r.word[6] = htonl(data.empty() ? taken : static_cast<std::uint32_t>(data.size()));
    return write_all(&r, sizeof r) && (data.empty() || write_all(data.data(), data.size()));
  }
  [[nodiscard]] std::chrono::nanoseconds period() const {
    return std::chrono::nanoseconds{1'000'000'000 / device_.mode().frames_per_second};
  }
  /// Inside a frame at once.
  [[nodiscard]] int ms_to_next() const {
    const auto left = next_ - steady_clock::now();
    if (at_ > 0 || left.count() <= 0) return 0;
    return static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(left).count()) + 1;
  }
  bool read_all(void* to, std::size_t size) {
    auto* p = static_cast<std::uint8_t*>(to);
    for (std::size_t done = 0; done < size;) {
      const ssize_t n = ::read(socket_, p + done, size - done);
      if (n <= 0) return false;
      done += static_cast<std::size_t>(n);
    }
    return true;
  }
  bool write_all(const void* from, std::size_t size) {
    const auto* p = static_cast<const std::uint8_t*>(from);
    for (std::size_t done = 0; done < size;) {
      const ssize_t n = ::write(socket_, p + done, size - done);
      if (n <= 0) return false;
      done += static_cast<std::size_t>(n);
    }
    return true;
  }

  int socket_;
  UvcDevice device_;
  std::uint32_t spoil_every_;  ///< 0: none
  Bytes payload_;
  std::size_t at_ = 0;  ///< bytes of the payload already sent
  std::uint32_t counter_ = 0;
  steady_clock::time_point next_ = steady_clock::now();
  std::deque<Header> waiting_;
};

}  // namespace

int main(int argc, char** argv) {
  UvcMode mode;
  if (argc > 1) mode.frames_per_second = static_cast<std::uint32_t>(std::max(1, std::atoi(argv[1])));
  std::array<int, 2> sockets{};
  if (::socketpair(AF_UNIX, SOCK_STREAM, 0, sockets.data()) != 0) return std::perror("socketpair"), 1;
  constexpr int kPort = 0, kDevice = 65538, kHighSpeed = 3;
  std::ofstream attach(std::string(kBus) + "/attach");
  attach << kPort << ' ' << sockets[0] << ' ' << kDevice << ' ' << kHighSpeed << std::flush;
  if (!attach) return std::fprintf(stderr, "usbip_camera: %s/attach cannot be written\n", kBus), 1;
  ::close(sockets[0]);
  const auto spoil = static_cast<std::uint32_t>(argc > 2 ? std::max(0, std::atoi(argv[2])) : 0);
  return Camera(sockets[1], mode, spoil).run();
}
