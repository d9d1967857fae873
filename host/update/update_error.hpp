// Why an update did not happen, as a person in the field needs it told.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>

#include "protocol/image/refusal.hpp"

namespace enamel::update {

/// Exit codes of `enamel-flash` (docs/flashing.md).
enum class Exit : int {
#define ENAMEL_EXIT(name, number, meaning) name = number,  // NOLINT(bugprone-macro-parentheses)
#include "host/update/exit_codes.def"
#undef ENAMEL_EXIT
};

/// What the tool itself finds wrong; what a probe refuses has its own numbers (image::Refusal).
enum class HostError : std::uint8_t {
#define ENAMEL_HOST_ERROR(name, exit, what, cause, remedy) name,
#include "host/update/host_errors.def"
#undef ENAMEL_HOST_ERROR
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

/// The table's texts; `detail` (which probe, which file, what the system said) follows the first after a colon.
[[nodiscard]] UpdateError make_error(HostError error, const std::string& detail = {});
[[nodiscard]] inline tl::unexpected<UpdateError> fail(HostError error, const std::string& detail = {}) {
  return tl::unexpected(make_error(error, detail));
}

/// The table's texts for a number from a status block, or a plain one for numbers that this version does not know.
[[nodiscard]] UpdateError refused_by_probe(std::uint32_t number);
[[nodiscard]] inline UpdateError refused_by_probe(image::Refusal why) {
  return refused_by_probe(static_cast<std::uint32_t>(why));
}

}  // namespace enamel::update
