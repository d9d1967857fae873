// Why an update did not happen, as a person in the field needs it told.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>

#include "protocol/image/refusal.hpp"

namespace enamel::update {

/// Exit codes of `enamel-flash` (docs/flashing.md).
enum class Exit : int {
  kOk = 0,
  kInternal = 1,
  kUsage = 2,
  kNoDevice = 3,
  kPermission = 4,
  kImage = 5,
  kSignature = 6,
  kRollback = 7,
  kTransfer = 8,
  kVerify = 9,
  kNotConfirmed = 10,
  kCancelled = 11,
};

struct UpdateError {
  Exit exit = Exit::kInternal;
  std::string what;
  std::string cause;
  std::string remedy;
  std::uint32_t refusal = 0;  ///< the probe's own number, 0 when the host decided
};

template <class T>
using Updated = tl::expected<T, UpdateError>;

/// The table's texts for a number from a status block, or a plain one for numbers that this version does not know.
[[nodiscard]] UpdateError refused_by_probe(std::uint32_t number);
[[nodiscard]] inline UpdateError refused_by_probe(image::Refusal why) {
  return refused_by_probe(static_cast<std::uint32_t>(why));
}

[[nodiscard]] UpdateError no_device(const std::string& wanted);
/// With the text of the udev rule, ready to install.
[[nodiscard]] UpdateError no_permission(const std::string& port);
[[nodiscard]] UpdateError transfer_failed(const std::string& where, const std::string& fault);
[[nodiscard]] UpdateError cancelled();

}  // namespace enamel::update
