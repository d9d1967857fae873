#include "protocol/image/version_text.hpp"

#include <charconv>
#include <limits>

namespace enamel::image {
namespace {

/// The number at the front of `text`, which gets shorter by it.
template <class T>
bool take_number(std::string_view& text, T& out) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || value > std::numeric_limits<T>::max()) return false;
  out = static_cast<T>(value);
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

bool take_mark(std::string_view& text, char mark) {
  if (text.empty() || text.front() != mark) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

std::optional<ImageVersion> parse_version(std::string_view text) {
  ImageVersion v;
  std::string_view rest = text;
  if (!take_number(rest, v.major) || !take_mark(rest, '.') || !take_number(rest, v.minor) || !take_mark(rest, '.') ||
      !take_number(rest, v.revision)) {
    return std::nullopt;
  }
  if (rest.empty()) return v;
  if (!take_mark(rest, '+') || !take_number(rest, v.build) || !rest.empty()) return std::nullopt;
  return v;
}

std::string to_text(const ImageVersion& v) {
  return std::to_string(v.major) + "." + std::to_string(v.minor) + "." + std::to_string(v.revision) + "+" +
         std::to_string(v.build);
}

}  // namespace enamel::image
