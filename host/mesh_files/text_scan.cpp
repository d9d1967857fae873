#include "host/mesh_files/text_scan.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace enamel::host {
namespace {

constexpr std::size_t kLongestNumber = 64;  ///< with a comma or Fortran's exponent

std::optional<double> out_of_range(std::string_view word) noexcept {
  const std::size_t exponent = word.find_first_of("eE");
  const bool tiny = exponent != std::string_view::npos ? word.substr(exponent).find('-') != std::string_view::npos
                                                       : word.find('.') != std::string_view::npos;
  return tiny ? 0.0 : std::numeric_limits<double>::infinity();
}

std::optional<double> plain_real(std::string_view word) noexcept {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error == std::errc::invalid_argument) {
    return std::nullopt;
  }
  return error == std::errc::result_out_of_range ? out_of_range(word) : std::optional(value);
}

}  // namespace

std::optional<double> to_real(std::string_view word) noexcept {
  if (!word.empty() && word.front() == '+') {
    word.remove_prefix(1);
  }
  if (const auto value = plain_real(word)) {
    return value;
  }
  if (word.empty() || word.size() > kLongestNumber) {
    return std::nullopt;
  }
  const std::string_view bare = word.front() == '-' ? word.substr(1) : word;
  const bool microsoft = bare.size() > 3 && bare[1] == '.' && bare[2] == '#';
  if (microsoft || (bare.size() >= 3 && same_letters(bare.substr(0, 3), "nan"))) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (std::count(word.begin(), word.end(), ',') > 1) {
    return std::nullopt;
  }
  std::array<char, kLongestNumber> room{};
  std::transform(word.begin(), word.end(), room.begin(), [](char c) {
    const char point = c == ',' ? '.' : c;
    return c == 'd' || c == 'D' ? 'e' : point;
  });
  return plain_real({room.data(), word.size()});
}

}  // namespace enamel::host
