// Text however other programs save it.
#pragma once

#include <charconv>
#include <string>
#include <string_view>
#include <vector>

namespace enamel {

/// Without the mark of UTF-8 in front, where there is one.
[[nodiscard]] std::string_view without_utf8_mark(std::string_view bytes) noexcept;

/// The text without its byte order mark. UTF-16 (known by its mark) becomes UTF-8 in `room`, what is not ASCII as '?';
/// else the result is a view of `bytes`. `room` must outlive the result.
[[nodiscard]] std::string_view plain_text(std::string_view bytes, std::string& room);

/// A table as spreadsheets save it, rewritten with commas, decimal points and LF. The first line tells the separator:
/// semicolon, tab or comma (Excel's own first line "sep=;" is dropped). Quotes and blanks about fields go; a comma
/// inside a number (0,5 between other separators or in quotes) becomes a point; rows of separators alone become empty
/// lines, and those at the end go. Lines keep their numbers. What is no number is left for the reader to refuse.
[[nodiscard]] std::string plain_table(std::string_view bytes);

/// The text up to the separator, which is taken off `rest` with it; all of `rest` where there is none.
[[nodiscard]] std::string_view cut(std::string_view& rest, char separator) noexcept;

/// Fields of a line of plain_table(), empty ones too; at least one.
[[nodiscard]] std::vector<std::string_view> table_fields(std::string_view line);

/// Whether the whole text is a number; `value` is it then.
template <class V>
[[nodiscard]] bool read_number(std::string_view text, V& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace enamel
