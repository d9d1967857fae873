#include "tests/guest/camera/usbip_link.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>

namespace enamel::guest {
namespace {

constexpr const char* kBus = "/sys/devices/platform/vhci_hcd.0";
constexpr int kPort = 0, kDevice = 65538, kHighSpeed = 3;
constexpr std::uint32_t kSubmit = 1, kUnlink = 2, kSubmitted = 3, kUnlinked = 4;
constexpr std::uint32_t kIn = 1;
constexpr int kStall = -32, kConnectionReset = -104;

}  // namespace

std::uint32_t UsbipHeader::command() const { return ntohl(word[0]); }
std::uint32_t UsbipHeader::sequence() const { return ntohl(word[1]); }
std::uint32_t UsbipHeader::direction() const { return ntohl(word[3]); }
std::uint32_t UsbipHeader::endpoint() const { return ntohl(word[4]); }
std::uint32_t UsbipHeader::length() const { return ntohl(word[6]); }
std::uint32_t UsbipHeader::unlinked() const { return ntohl(word[5]); }
Setup UsbipHeader::setup() const {
  std::array<std::uint8_t, 8> b{};
  std::memcpy(b.data(), &word[10], b.size());
  const auto u16 = [&](std::size_t i) { return static_cast<std::uint16_t>(b[i] | (b[i + 1] << 8)); };
  return {b[0], b[1], u16(2), u16(4), u16(6)};
}

UsbipCamera::UsbipCamera(UvcMode mode, FrameContent content)
    : device_(mode), content_(std::move(content)), payload_(device_.payload_bytes()) {}

bool UsbipCamera::attach() {
  std::array<int, 2> sockets{};
  if (::socketpair(AF_UNIX, SOCK_STREAM, 0, sockets.data()) != 0) return std::perror("socketpair"), false;
  std::ofstream file(std::string(kBus) + "/attach");
  file << kPort << ' ' << sockets[0] << ' ' << kDevice << ' ' << kHighSpeed << std::flush;
  if (!file) return std::fprintf(stderr, "%s/attach cannot be written\n", kBus), false;
  ::close(sockets[0]);
  socket_ = sockets[1];
  return true;
}

int UsbipCamera::run() {
  for (;;) {
    pollfd wait{socket_, POLLIN, 0};
    if (::poll(&wait, 1, waiting_.empty() ? -1 : ms_to_next()) < 0) return 1;
    if ((wait.revents & (POLLIN | POLLHUP)) != 0 && !take()) return 0;
    while (!waiting_.empty() && ms_to_next() == 0) send_part();
  }
}

bool UsbipCamera::take() {
  UsbipHeader h;
  if (!read_all(&h, sizeof h)) return false;
  if (h.command() == kUnlink) return unlink(h);
  if (h.command() != kSubmit) return false;
  Bytes sent(h.direction() == kIn ? 0 : h.length());
  if (!sent.empty() && !read_all(sent.data(), sent.size())) return false;
  if (h.endpoint() != 0) {
    if (waiting_.empty() && at_ == 0) next_ = std::max(next_, Clock::now());
    waiting_.push_back(h);
    return true;
  }
  const auto answer = device_.control(h.setup(), sent);
  return reply(h, answer ? 0 : kStall, answer.value_or(Bytes{}), answer && h.direction() != kIn ? h.length() : 0);
}

bool UsbipCamera::unlink(const UsbipHeader& h) {
  const auto it = std::find_if(waiting_.begin(), waiting_.end(),
                               [&](const UsbipHeader& w) { return w.sequence() == h.unlinked(); });
  const bool was_waiting = it != waiting_.end();
  if (was_waiting) waiting_.erase(it);
  at_ = 0;  // the stream was stopped: the next one begins with a whole frame
  UsbipHeader r;
  r.word[0] = htonl(kUnlinked);
  r.word[1] = h.word[1];
  r.word[5] = htonl(static_cast<std::uint32_t>(was_waiting ? kConnectionReset : 0));
  return write_all(&r, sizeof r);
}

/// The next piece of the current payload into the oldest transfer that waits.
void UsbipCamera::send_part() {
  if (at_ == 0) {
    payload_[0] = UvcDevice::kPayloadHeader;
    payload_[1] = static_cast<std::uint8_t>(0x80U | 0x02U | (counter_ & 1U));  // end of header, of frame; frame id
    content_(counter_, std::span(payload_).subspan(UvcDevice::kPayloadHeader));
  }
  const UsbipHeader h = waiting_.front();
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
  next_ = std::max(next_ + period(), Clock::now() - period());
}

bool UsbipCamera::reply(const UsbipHeader& to, int status, const Bytes& data, std::uint32_t taken) {
  UsbipHeader r;
  r.word[0] = htonl(kSubmitted);
  r.word[1] = to.word[1];
  r.word[5] = htonl(static_cast<std::uint32_t>(status));
  r.word[6] = htonl(data.empty() ? taken : static_cast<std::uint32_t>(data.size()));
  return write_all(&r, sizeof r) && (data.empty() || write_all(data.data(), data.size()));
}

std::chrono::nanoseconds UsbipCamera::period() const {
  return std::chrono::nanoseconds{1'000'000'000 / device_.mode().frames_per_second};
}

/// Inside a frame at once.
int UsbipCamera::ms_to_next() const {
  const auto left = next_ - Clock::now();
  if (at_ > 0 || left.count() <= 0) return 0;
  return static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(left).count()) + 1;
}

bool UsbipCamera::read_all(void* to, std::size_t size) {
  auto* p = static_cast<std::uint8_t*>(to);
  for (std::size_t done = 0; done < size;) {
    const ssize_t n = ::read(socket_, p + done, size - done);
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

bool UsbipCamera::write_all(const void* from, std::size_t size) {
  const auto* p = static_cast<const std::uint8_t*>(from);
  for (std::size_t done = 0; done < size;) {
    const ssize_t n = ::write(socket_, p + done, size - done);
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace enamel::guest
