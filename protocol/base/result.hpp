// Errors as values. A function that can fail returns Result<T>; it never throws and leaves its arguments usable.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

namespace enamel {

enum class ErrorCode : int {
#define ENAMEL_ERROR(name, number, text, cause, remedy) name = number,  // NOLINT(bugprone-macro-parentheses): a name
#include "protocol/base/error_codes.def"
#undef ENAMEL_ERROR
};

/// What a code means to a person. All views are to static storage.
struct ErrorInfo {
  std::string_view name;
  std::string_view text;
  std::string_view cause;
  std::string_view remedy;
};

[[nodiscard]] ErrorInfo describe(ErrorCode code) noexcept;

/// Exit code of a program that ends with this error: 1 usage, 2 input/configuration, 3 device, 4 data loss, 5 internal,
/// 6 quality gate.
[[nodiscard]] int exit_code(ErrorCode code) noexcept;

struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string detail;  ///< which file, line, key, value: what the table cannot know

  /// Three lines: what (with detail), cause, remedy.
  [[nodiscard]] std::string message() const;
};

template <class T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string detail = {}) {
  return tl::unexpected<Error>(Error{code, std::move(detail)});
}

}  // namespace enamel

#define ENAMEL_CONCAT_(a, b) a##b
#define ENAMEL_CONCAT(a, b) ENAMEL_CONCAT_(a, b)

/// ENAMEL_TRY(expr): returns the error of a Result<void> expression from the calling function.
#define ENAMEL_TRY(expr)                                                         \
  do {                                                                           \
    if (auto enamel_result_ = (expr); !enamel_result_) {                         \
      return tl::unexpected<::enamel::Error>(std::move(enamel_result_).error()); \
    }                                                                            \
  } while (false)

/// ENAMEL_TRY_ASSIGN(decl, expr): decl = value of the Result<T> expression, or returns its error.
#define ENAMEL_TRY_ASSIGN(decl, expr) ENAMEL_TRY_ASSIGN_(ENAMEL_CONCAT(enamel_or_, __LINE__), decl, expr)
// NOLINTBEGIN(bugprone-macro-parentheses): tmp and decl are names and declarations, not expressions
#define ENAMEL_TRY_ASSIGN_(tmp, decl, expr)                         \
  auto tmp = (expr);                                                \
  if (!tmp) {                                                       \
    return tl::unexpected<::enamel::Error>(std::move(tmp).error()); \
  }                                                                 \
  decl = std::move(*tmp)
// NOLINTEND(bugprone-macro-parentheses)
