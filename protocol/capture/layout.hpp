// Names inside a recording. Private to this folder; documented in docs/recording-format.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace enamel::capture {

enum class Kind : std::uint8_t { kBurst, kShed, kStatus, kEvent, kDeviceInfo, kAxes };
inline constexpr std::size_t kKinds = 6;

struct ChannelName {
  std::string_view topic;   ///< as on DDS, where it is on DDS
  std::string_view schema;  ///< type in scanner.idl
};

inline constexpr std::array<ChannelName, kKinds> kChannelNames{{
    {"enamel/v1/burst", "enamel::v1::Burst"},
    {"enamel/v1/shed", "enamel::v1::ShedNote"},
    {"enamel/v1/status", "enamel::v1::Status"},
    {"enamel/v1/event", "enamel::v1::Event"},
    {"enamel/v1/device_info", "enamel::v1::DeviceInfo"},
    {"enamel/v1/axes", "enamel::v1::AxesReading"},
}};

inline constexpr std::string_view kProfile = "enamel";
inline constexpr std::string_view kSchemaEncoding = "omgidl";
inline constexpr std::string_view kMessageEncoding = "cdr";
inline constexpr const char* kMetadataName = "enamel";
inline constexpr const char* kProgramKey = "program";

}  // namespace enamel::capture
