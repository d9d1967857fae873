// Why an image or a step of an update is refused: small enough for a bootloader, with texts for people beside it.
#pragma once

#include <cstdint>
#include <string_view>
#include <tl/expected.hpp>

#include "protocol/image/dfu.hpp"

namespace enamel::image {

/// The numbers travel in the status block (`last_error`); 0 there means none.
enum class Refusal : std::uint16_t {
#define ENAMEL_REFUSAL(name, number, status, exit, what, cause, remedy) \
  name = number,  // NOLINT(bugprone-macro-parentheses)
#include "protocol/image/refusals.def"
#undef ENAMEL_REFUSAL
};

/// A value, or why there is none. No heap.
template <class T>
using Checked = tl::expected<T, Refusal>;

[[nodiscard]] constexpr tl::unexpected<Refusal> refuse(Refusal why) noexcept { return tl::unexpected<Refusal>(why); }

/// The DFU status that tells a host of it (bStatus of GETSTATUS).
[[nodiscard]] constexpr DfuStatus dfu_status(Refusal why) noexcept {
  struct Entry {
    Refusal why;
    DfuStatus status;
  };
  constexpr Entry kEntries[] = {
#define ENAMEL_REFUSAL(name, number, status, exit, what, cause, remedy) {Refusal::name, DfuStatus::status},
#include "protocol/image/refusals.def"
#undef ENAMEL_REFUSAL
  };
  for (const Entry& e : kEntries) {
    if (e.why == why) return e.status;
  }
  return DfuStatus::kErrUnknown;
}

/// Exit code of `enamel-flash` and `enamel-sign`: 5 incompatible image, 6 signature, 7 rollback refused, 8 transfer,
/// 9 verify, 10 not confirmed.
[[nodiscard]] int exit_code(Refusal why) noexcept;

struct RefusalText {
  std::string_view name;
  std::string_view what;
  std::string_view cause;
  std::string_view remedy;
};

/// Texts of a number from a status block; what is empty for a number that this table does not have.
[[nodiscard]] RefusalText describe_refusal(std::uint32_t number) noexcept;

}  // namespace enamel::image

/// ENAMEL_CHECK_THAT(expr): returns the refusal of a Checked<void> expression from the calling function.
#define ENAMEL_CHECK_THAT(expr)                                                   \
  do {                                                                            \
    if (const auto enamel_checked_ = (expr); !enamel_checked_) {                  \
      return ::tl::unexpected<::enamel::image::Refusal>(enamel_checked_.error()); \
    }                                                                             \
  } while (false)
