// ENAMEL_CHECK: stops the program on a defect of our own. Bad input is a Result, never a check.
#pragma once

#include <string_view>

namespace enamel {

/// Called with the failed expression and where it stands; must not return. The default prints to stderr and aborts.
using CheckHandler = void (*)(const char* expression, const char* file, int line, std::string_view what);

/// Replaces the handler and returns the previous one. Not thread-safe: for tests, before other threads run.
CheckHandler set_check_handler(CheckHandler handler) noexcept;

/// Runs the handler; aborts if it returns.
[[noreturn]] void check_failed(const char* expression, const char* file, int line, std::string_view what = {});

}  // namespace enamel

/// ENAMEL_CHECK(cond) or ENAMEL_CHECK(cond, "what it means"): active in every build.
#define ENAMEL_CHECK(cond, ...) \
  (static_cast<bool>(cond) ? void(0) : ::enamel::check_failed(#cond, __FILE__, __LINE__ __VA_OPT__(, ) __VA_ARGS__))
