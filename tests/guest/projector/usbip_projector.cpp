// A SIMULATED LightCrafter 4500 on this machine's USB: USB/IP with the kernel's vhci_hcd, a MODEL of its controller
// behind one HID interface, so that usbhid and hidraw drive it as they drive any other.
// usage: usbip_projector STATE_FILE [PRODUCT [SILENT_FROM]]; ends when the kernel closes the connection. STATE_FILE:
// LEDs and sequence after each message. SILENT_FROM: number of the message from which on nothing is answered.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <string>

#include "tests/guest/camera/usbip_link.hpp"
#include "tests/unit/firmware/dlpc350_model.hpp"

namespace enamel::guest {
namespace {

constexpr const char* kAttach = "/sys/devices/platform/vhci_hcd.0/attach";
constexpr int kPort = 0, kDevice = 65538, kHighSpeed = 3;
constexpr std::uint32_t kSubmit = 1, kUnlink = 2, kSubmitted = 3, kUnlinked = 4, kIn = 1;
constexpr int kStall = -32, kConnectionReset = -104;

// One input and one output report of 64 bytes, of a vendor's own kind.
const Bytes kReportDescriptor{0x06, 0x00, 0xFF, 0x09, 0x01, 0xA1, 0x01, 0x15, 0x00, 0x26, 0xFF, 0x00, 0x75, 0x08,
                              0x95, 0x40, 0x09, 0x01, 0x81, 0x02, 0x95, 0x40, 0x09, 0x01, 0x91, 0x02, 0xC0};

class UsbipProjector {
 public:
  UsbipProjector(std::string state_file, unsigned product, int silent_from)
      : state_file_(std::move(state_file)), product_(product) {
    model_.faults = [=](int n) {
      return n >= silent_from ? fw::test::Dlpc350Model::Fault::kSilence : fw::test::Dlpc350Model::Fault::kNone;
    };
  }

  bool attach() {
    std::array<int, 2> sockets{};
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, sockets.data()) != 0) return std::perror("socketpair"), false;
    std::ofstream file(kAttach);
    file << kPort << ' ' << sockets[0] << ' ' << kDevice << ' ' << kHighSpeed << std::flush;
    if (!file) return std::fprintf(stderr, "%s cannot be written\n", kAttach), false;
    ::close(sockets[0]);
    socket_ = sockets[1];
    return true;
  }

  bool take() {
    UsbipHeader h;
    if (!read_all(&h, sizeof h)) return false;
    if (h.command() == kUnlink) return unlink(h);
    if (h.command() != kSubmit) return false;
    Bytes sent(h.direction() == kIn ? 0 : h.length());
    if (!sent.empty() && !read_all(sent.data(), sent.size())) return false;
    if (h.endpoint() == 0) {
      const auto answer = control(h.setup());
      return reply(h, answer ? 0 : kStall, answer.value_or(Bytes{}), answer ? static_cast<unsigned>(sent.size()) : 0);
    }
    if (h.direction() == kIn) {
      waiting_.push_back(h);
    } else if (!hear(h, sent)) {
      return false;
    }
    return answer_waiting();
  }

 private:
  bool hear(const UsbipHeader& h, const Bytes& sent) {
    fw::HidReport report{};
    if (sent.size() != report.size()) return reply(h, kStall, {}, 0);
    std::copy(sent.begin(), sent.end(), report.begin());
    if (!model_.write(report)) return false;
    std::ofstream(state_file_) << "leds " << int{model_.leds} << " runs " << model_.runs << "\n";
    return reply(h, 0, {}, static_cast<std::uint32_t>(sent.size()));
  }

  bool answer_waiting() {
    while (!waiting_.empty()) {
      fw::HidReport report{};
      const auto n = model_.read(report, Nanoseconds{0});
      if (!n || *n == 0) return true;
      if (!reply(waiting_.front(), 0, Bytes(report.begin(), report.end()), 0)) return false;
      waiting_.pop_front();
    }
    return true;
  }

  [[nodiscard]] std::optional<Bytes> control(const Setup& setup) const {
    constexpr std::uint8_t kGetStatus = 0, kSetConfiguration = 9, kSetIdle = 10, kSetInterface = 11;
    if (setup.request == kGetStatus) return Bytes{0, 0};
    if (setup.request == kSetConfiguration || setup.request == kSetIdle || setup.request == kSetInterface)
      return Bytes{};
    if (setup.request != 6) return std::nullopt;
    auto answer = descriptor(setup.value >> 8U);
    if (answer && answer->size() > setup.length) answer->resize(setup.length);
    return answer;
  }

  [[nodiscard]] std::optional<Bytes> descriptor(unsigned type) const {
    const auto low = [](std::size_t v) { return static_cast<std::uint8_t>(v & 0xFFU); };
    const auto report_size = low(kReportDescriptor.size());
    switch (type) {
      case 1:
        return Bytes{18, 1, 0, 2, 0, 0, 0, 64, 0x51, 0x04, low(product_), low(product_ >> 8U), 0, 1, 0, 0, 0, 1};
      case 2:
        return Bytes{9, 2,    41,   0, 1,  1, 0,    0x80,        50,  // configuration
                     9, 4,    0,    0, 2,  3, 0,    0,           0,   // HID interface
                     9, 0x21, 0x11, 1, 0,  1, 0x22, report_size, 0,   // with one report descriptor
                     7, 5,    0x81, 3, 64, 0, 4,                      // interrupt in
                     7, 5,    0x01, 3, 64, 0, 4};                     // interrupt out
      case 0x22:
        return kReportDescriptor;
      default:
        return std::nullopt;
    }
  }

  bool unlink(const UsbipHeader& h) {
    const auto it = std::find_if(waiting_.begin(), waiting_.end(),
                                 [&](const UsbipHeader& w) { return w.sequence() == h.unlinked(); });
    UsbipHeader r;
    r.word[0] = htonl(kUnlinked);
    r.word[1] = h.word[1];
    r.word[5] = htonl(static_cast<std::uint32_t>(it != waiting_.end() ? kConnectionReset : 0));
    if (it != waiting_.end()) waiting_.erase(it);
    return write_all(&r, sizeof r);
  }

  bool reply(const UsbipHeader& to, int status, const Bytes& data, std::uint32_t taken) {
    UsbipHeader r;
    r.word[0] = htonl(kSubmitted);
    r.word[1] = to.word[1];
    r.word[5] = htonl(static_cast<std::uint32_t>(status));
    r.word[6] = htonl(data.empty() ? taken : static_cast<std::uint32_t>(data.size()));
    return write_all(&r, sizeof r) && (data.empty() || write_all(data.data(), data.size()));
  }

  bool read_all(void* to, std::size_t size) const {
    return ::recv(socket_, to, size, MSG_WAITALL) == static_cast<ssize_t>(size);
  }
  bool write_all(const void* from, std::size_t size) const {
    return ::send(socket_, from, size, MSG_NOSIGNAL) == static_cast<ssize_t>(size);
  }

  fw::test::Dlpc350Model model_;
  std::string state_file_;
  unsigned product_;
  int socket_ = -1;
  std::deque<UsbipHeader> waiting_;
};

}  // namespace
}  // namespace enamel::guest

int main(int argc, char** argv) {
  if (argc < 2) return std::fputs("usage: usbip_projector STATE_FILE [PRODUCT [SILENT_FROM]]\n", stderr), 1;
  const auto product = static_cast<unsigned>(argc > 2 ? std::strtoul(argv[2], nullptr, 16) : 0x6401UL);
  enamel::guest::UsbipProjector projector(argv[1], product, argc > 3 ? std::atoi(argv[3]) : 1'000'000'000);
  if (!projector.attach()) return 1;
  while (projector.take()) {
  }
  return 0;
}
