// A USB video camera as its descriptors and control requests say it: UVC 1.0, one grey format, one bulk endpoint.
// SIMULATION, for the guest.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace enamel::guest {

using Bytes = std::vector<std::uint8_t>;

struct Setup {
  std::uint8_t request_type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;
};

struct UvcMode {
  std::uint16_t width = 640;
  std::uint16_t height = 480;
  std::uint32_t frames_per_second = 30;
  [[nodiscard]] std::uint32_t frame_bytes() const { return std::uint32_t{width} * height; }
};

/// Answers requests on endpoint 0.
class UvcDevice {
 public:
  explicit UvcDevice(UvcMode mode);
  /// Data of an IN request, empty for an OUT one that is accepted; nullopt: stall.
  [[nodiscard]] std::optional<Bytes> control(const Setup& setup, const Bytes& sent);
  [[nodiscard]] const UvcMode& mode() const { return mode_; }
  /// Bytes of a frame's payload: header and pixels.
  [[nodiscard]] std::uint32_t payload_bytes() const { return mode_.frame_bytes() + kPayloadHeader; }
  static constexpr std::uint32_t kPayloadHeader = 2;

 private:
  [[nodiscard]] std::optional<Bytes> standard(const Setup& setup) const;
  [[nodiscard]] std::optional<Bytes> descriptor(const Setup& setup) const;
  [[nodiscard]] Bytes configuration() const;
  [[nodiscard]] Bytes stream_control() const;

  UvcMode mode_;
};

}  // namespace enamel::guest
