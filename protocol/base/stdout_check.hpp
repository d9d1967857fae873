// What was printed has arrived: results that a full disk or a closed pipe swallowed are no success.
#pragma once

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "protocol/base/result.hpp"

namespace enamel {

/// Last act of a program: hands stdout over. Its exit code, or that of kFileWrite with a message on stderr where `code`
/// is 0 and stdout cannot be written. A reader that went away (`| head`) is no error.
[[nodiscard]] inline int with_stdout_written(int code) {
  errno = 0;
  const bool flushed = std::fflush(stdout) == 0;
  const int why = errno;
  if ((flushed && std::ferror(stdout) == 0) || why == EPIPE || code != 0) return code;
  const Error error{ErrorCode::kFileWrite, "standard output: " + std::generic_category().message(why)};
  std::fputs((error.message() + "\n").c_str(), stderr);
  return exit_code(error.code);
}

}  // namespace enamel
