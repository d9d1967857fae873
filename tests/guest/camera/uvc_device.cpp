#include "tests/guest/camera/uvc_device.hpp"

#include <algorithm>
#include <string_view>

namespace enamel::guest {
namespace {

// USB 2.0 table 9-4 and 9-5, UVC 1.0 tables.
constexpr std::uint8_t kGetStatus = 0x00, kGetDescriptor = 0x06, kSetConfiguration = 0x09, kSetInterface = 0x0B;
constexpr std::uint8_t kDevice = 1, kConfiguration = 2, kString = 3;
constexpr std::uint8_t kSetCur = 0x01, kGetCur = 0x81, kGetMin = 0x82, kGetMax = 0x83, kGetLen = 0x85, kGetInfo = 0x86,
                       kGetDef = 0x87;
constexpr std::uint8_t kStreamInterface = 1, kProbe = 1, kCommit = 2;
constexpr std::uint8_t kBulkIn = 0x81;
constexpr std::uint16_t kPacket = 512;

void put16(Bytes& to, std::uint32_t v) {
  to.push_back(static_cast<std::uint8_t>(v & 0xFFU));
  to.push_back(static_cast<std::uint8_t>((v >> 8U) & 0xFFU));
}
void put32(Bytes& to, std::uint32_t v) {
  put16(to, v & 0xFFFFU);
  put16(to, v >> 16U);
}
void put(Bytes& to, std::initializer_list<unsigned> bytes) {
  for (const unsigned b : bytes) to.push_back(static_cast<std::uint8_t>(b));
}

Bytes text(std::string_view s) {
  Bytes d{static_cast<std::uint8_t>(2 + 2 * s.size()), kString};
  for (const char c : s) put(d, {static_cast<unsigned char>(c), 0U});
  return d;
}

/// Grey, eight bits: Y800.
constexpr std::array<unsigned, 16> kGrey{0x59, 0x38, 0x30, 0x30, 0, 0, 0x10, 0, 0x80, 0, 0, 0xAA, 0, 0x38, 0x9B, 0x71};

}  // namespace

UvcDevice::UvcDevice(UvcMode mode) : mode_(mode) {}

std::optional<Bytes> UvcDevice::control(const Setup& setup, const Bytes& sent) {
  const bool class_request = (setup.request_type & 0x60U) == 0x20U;
  if (!class_request) {
    auto answer = standard(setup);
    if (answer && answer->size() > setup.length) answer->resize(setup.length);
    return answer;
  }
  const unsigned selector = setup.value >> 8U;
  if ((setup.index & 0xFFU) != kStreamInterface || (selector != kProbe && selector != kCommit)) return std::nullopt;
  switch (setup.request) {
    case kSetCur:
      return sent.size() >= stream_control().size() ? std::optional(Bytes{}) : std::nullopt;
    case kGetCur:
    case kGetMin:
    case kGetMax:
    case kGetDef: {
      Bytes answer = stream_control();
      answer.resize(std::min<std::size_t>(answer.size(), setup.length));
      return answer;
    }
    case kGetLen:
      return Bytes{static_cast<std::uint8_t>(stream_control().size()), 0};
    case kGetInfo:
      return Bytes{3};
    default:
      return std::nullopt;
  }
}

std::optional<Bytes> UvcDevice::standard(const Setup& setup) const {
  switch (setup.request) {
    case kGetDescriptor:
      return descriptor(setup);
    case kGetStatus:
      return Bytes{0, 0};
    case kSetConfiguration:
    case kSetInterface:
      return Bytes{};
    default:
      return std::nullopt;
  }
}

std::optional<Bytes> UvcDevice::descriptor(const Setup& setup) const {
  switch (setup.value >> 8U) {
    case kDevice: {
      Bytes d;
      put(d, {18, kDevice, 0x00, 0x02, 0xEF, 2, 1, 64, 0x6B, 0x1D, 0x04, 0x01, 0x00, 0x01, 1, 2, 3, 1});
      return d;
    }
    case kConfiguration:
      return configuration();
    case kString:
      switch (setup.value & 0xFFU) {
        case 0:
          return Bytes{4, kString, 0x09, 0x04};
        case 1:
          return text("enamel");
        case 2:
          return text("enamel camera, SIMULATED");
        default:
          return text("guest-1");
      }
    default:
      return std::nullopt;
  }
}

Bytes UvcDevice::configuration() const {
  const std::uint32_t interval = 10'000'000U / mode_.frames_per_second;  // 100 ns
  const std::uint32_t rate = mode_.frame_bytes() * 8 * mode_.frames_per_second;
  Bytes control;  // class descriptors of the control interface: camera, output
  put(control, {18, 0x24, 0x02, 1, 0x01, 0x02, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0});
  put(control, {9, 0x24, 0x03, 2, 0x01, 0x01, 0, 1, 0});
  Bytes stream;  // format, frame
  put(stream, {27, 0x24, 0x04, 1, 1});
  for (const unsigned b : kGrey) put(stream, {b});
  put(stream, {8, 1, 0, 0, 0, 0});
  put(stream, {30, 0x24, 0x05, 1, 0});
  put16(stream, mode_.width);
  put16(stream, mode_.height);
  put32(stream, rate);
  put32(stream, rate);
  put32(stream, mode_.frame_bytes());
  put32(stream, interval);
  put(stream, {1});
  put32(stream, interval);

  Bytes d;
  put(d, {8, 0x0B, 0, 2, 0x0E, 3, 0, 0});
  put(d, {9, 4, 0, 0, 0, 0x0E, 1, 0, 0});
  put(d, {13, 0x24, 0x01, 0x00, 0x01});
  put16(d, static_cast<std::uint32_t>(13 + control.size()));
  put32(d, 48'000'000);
  put(d, {1, 1});
  d.insert(d.end(), control.begin(), control.end());
  put(d, {9, 4, 1, 0, 1, 0x0E, 2, 0, 0});
  put(d, {14, 0x24, 0x01, 1});
  put16(d, static_cast<std::uint32_t>(14 + stream.size()));
  put(d, {kBulkIn, 0, 2, 0, 0, 0, 1, 0});
  d.insert(d.end(), stream.begin(), stream.end());
  put(d, {7, 5, kBulkIn, 2});
  put16(d, kPacket);
  put(d, {0});

  Bytes all;
  put(all, {9, kConfiguration});
  put16(all, static_cast<std::uint32_t>(9 + d.size()));
  put(all, {2, 1, 0, 0x80, 50});
  all.insert(all.end(), d.begin(), d.end());
  return all;
}

/// Of UVC 1.0, 26 bytes: nothing is negotiable.
Bytes UvcDevice::stream_control() const {
  Bytes d;
  put16(d, 0);
  put(d, {1, 1});
  put32(d, 10'000'000U / mode_.frames_per_second);
  for (int i = 0; i < 5; ++i) put16(d, 0);
  put32(d, mode_.frame_bytes());
  put32(d, payload_bytes());
  return d;
}

}  // namespace enamel::guest
