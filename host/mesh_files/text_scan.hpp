// Words and numbers of text formats, bounds-checked.
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace enamel::host {

[[nodiscard]] constexpr bool is_space(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// Next line without its end; false at the end of the text.
inline bool next_line(std::string_view& text, std::string_view& line) noexcept {
  if (text.empty()) {
    return false;
  }
  const std::size_t end = text.find('\n');
  line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (!line.empty() && line.back() == '\r') {
    line.remove_suffix(1);
  }
  return true;
}

/// Next word of a line; empty at its end.
inline std::string_view next_word(std::string_view& line) noexcept {
  std::size_t from = 0;
  while (from < line.size() && is_space(line[from])) {
    ++from;
  }
  std::size_t to = from;
  while (to < line.size() && !is_space(line[to])) {
    ++to;
  }
  const std::string_view word = line.substr(from, to - from);
  line.remove_prefix(to);
  return word;
}

/// The whole word as a number, or nothing.
template <class T>
[[nodiscard]] std::optional<T> to_number(std::string_view word) noexcept {
  if (!word.empty() && word.front() == '+') {
    word.remove_prefix(1);
  }
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) {
    return std::nullopt;
  }
  return value;
}

}  // namespace enamel::host
