#include "protocol/base/result.hpp"

namespace enamel {

ErrorInfo describe(ErrorCode code) noexcept {
  switch (code) {
#define ENAMEL_ERROR(name, number, text, cause, remedy) \
  case ErrorCode::name:                                 \
    return {#name, text, cause, remedy};
#include "protocol/base/error_codes.def"
#undef ENAMEL_ERROR
  }
  return {"kUnknown", "unknown error", "", ""};
}

int exit_code(ErrorCode code) noexcept { return static_cast<int>(code) / 100; }

std::string Error::message() const {
  const ErrorInfo info = describe(code);
  std::string out = "error: " + std::string(info.text);
  if (!detail.empty()) out += ": " + detail;
  out += "\n  likely cause: " + std::string(info.cause);
  out += "\n  what to do:   " + std::string(info.remedy);
  return out;
}

}  // namespace enamel
