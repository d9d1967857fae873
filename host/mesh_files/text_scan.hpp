// Words and numbers of text formats, bounds-checked.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

namespace enamel::host {

[[nodiscard]] constexpr bool is_space(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// Next line without its end (LF, CR or both); false at the end of the text.
inline bool next_line(std::string_view& text, std::string_view& line) noexcept {
  if (text.empty()) {
    return false;
  }
  std::size_t end = 0;
  while (end < text.size() && text[end] != '\n' && text[end] != '\r') {
    ++end;
  }
  line = text.substr(0, end);
  const bool both = end + 1 < text.size() && text[end] == '\r' && text[end + 1] == '\n';
  text.remove_prefix(end == text.size() ? end : end + (both ? 2 : 1));
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

/// Words of a whole text, and the line that they are in, counted from 1.
class Words {
 public:
  explicit Words(std::string_view text) noexcept : text_(text) {}
  /// Empty at the end of the text.
  std::string_view next() noexcept {
    std::string_view word = next_word(line_);
    while (word.empty() && next_line(text_, line_)) {
      ++number_;
      word = next_word(line_);
    }
    return word;
  }
  void skip_line() noexcept { line_ = {}; }
  [[nodiscard]] std::size_t line() const noexcept { return number_; }
  [[nodiscard]] std::size_t left() const noexcept { return text_.size() + line_.size(); }

 private:
  std::string_view text_, line_;
  std::size_t number_ = 0;
};

/// ASCII letters alone; `lower` is in small letters.
[[nodiscard]] constexpr bool same_letters(std::string_view word, std::string_view lower) noexcept {
  if (word.size() != lower.size()) {
    return false;
  }
  for (std::size_t i = 0; i < word.size(); ++i) {
    const char c = word[i] >= 'A' && word[i] <= 'Z' ? static_cast<char>(word[i] - 'A' + 'a') : word[i];
    if (c != lower[i]) {
      return false;
    }
  }
  return true;
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

/// A real number as any program prints it: sign, exponent (also Fortran's D), decimal comma, too small (0), and what is
/// none to their authors: nan, inf, -nan(ind), 1.#QNAN, an exponent too large. Nothing for another word.
[[nodiscard]] std::optional<double> to_real(std::string_view word) noexcept;

}  // namespace enamel::host
