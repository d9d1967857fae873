#include "host/update/update_error.hpp"

#include <array>

namespace enamel::update {
namespace {

struct Entry {
  Exit exit;
  const char* what;
  const char* cause;
  const char* remedy;
};

constexpr std::array kEntries = {
#define ENAMEL_HOST_ERROR(name, exit, what, cause, remedy) Entry{Exit::exit, what, cause, remedy},
#include "host/update/host_errors.def"
#undef ENAMEL_HOST_ERROR
};

}  // namespace

UpdateError make_error(HostError error, const std::string& detail) {
  const Entry& e = kEntries[static_cast<std::size_t>(error)];
  return {e.exit, detail.empty() ? e.what : e.what + (": " + detail), e.cause, e.remedy};
}

UpdateError refused_by_probe(std::uint32_t number) {
  const image::RefusalText text = image::describe_refusal(number);
  if (text.what.empty()) {
    UpdateError unknown = make_error(HostError::kUnknownRefusal, std::to_string(number));
    unknown.refusal = number;
    return unknown;
  }
  return {static_cast<Exit>(image::exit_code(static_cast<image::Refusal>(number))), std::string(text.what),
          std::string(text.cause), std::string(text.remedy), number};
}

}  // namespace enamel::update
