#include "protocol/base/plain_text.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace enamel {
namespace {

constexpr std::string_view kUtf8Mark = "\xef\xbb\xbf", kLittleMark = "\xff\xfe", kBigMark = "\xfe\xff";

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// Up to CR, LF or both; false at the end of the text.
bool take_line(std::string_view& text, std::string_view& line) {
  if (text.empty()) return false;
  const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
  line = text.substr(0, end);
  text.remove_prefix(end);
  if (!text.empty()) text.remove_prefix(text.starts_with("\r\n") ? 2 : 1);
  return true;
}

/// Fields between separators that stand outside quotes, without those quotes.
std::vector<std::string> fields_of(std::string_view line, char separator) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[++i];
    } else if (line[i] == '"') {
      quoted = !quoted;
    } else if (line[i] == separator && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  return fields;
}

void point_for_comma(std::string& field) {
  const bool number = field.find_first_not_of("0123456789+-eE,") == std::string::npos;
  if (number && std::count(field.begin(), field.end(), ',') == 1) field[field.find(',')] = '.';
}

std::string joined(std::vector<std::string> fields, std::size_t& columns) {
  for (std::string& field : fields) {
    field = std::string(trimmed(field));
    point_for_comma(field);
  }
  if (std::all_of(fields.begin(), fields.end(), [](const std::string& f) { return f.empty(); })) return {};
  while (fields.size() > columns && fields.back().empty()) fields.pop_back();
  if (columns == 0) columns = fields.size();
  std::string line = fields.front();
  for (std::size_t i = 1; i < fields.size(); ++i) line += "," + fields[i];
  return line;
}

char separator_of(std::string_view header) {
  if (header.find(';') != std::string_view::npos) return ';';
  return header.find('\t') != std::string_view::npos && header.find(',') == std::string_view::npos ? '\t' : ',';
}

}  // namespace

std::string_view without_utf8_mark(std::string_view bytes) noexcept {
  bytes.remove_prefix(bytes.starts_with(kUtf8Mark) ? kUtf8Mark.size() : 0);
  return bytes;
}

std::string_view plain_text(std::string_view bytes, std::string& room) {
  const bool big = bytes.starts_with(kBigMark);
  if (!big && !bytes.starts_with(kLittleMark)) return without_utf8_mark(bytes);
  room.clear();
  for (std::size_t i = 2; i + 1 < bytes.size(); i += 2) {
    const auto low = static_cast<unsigned char>(bytes[i + (big ? 1 : 0)]);
    const bool ascii = bytes[i + (big ? 0 : 1)] == 0 && low < 0x80;
    room += ascii ? static_cast<char>(low) : '?';
  }
  return room;
}

std::string plain_table(std::string_view bytes) {
  std::string room, out;
  std::string_view text = plain_text(bytes, room), line;
  char separator = 0;
  std::size_t columns = 0;  // of the header, once it is known
  while (take_line(text, line)) {
    const bool first = separator == 0;
    if (first && line.size() == 5 && line.starts_with("sep=")) {
      separator = line[4];
      continue;
    }
    if (first && !trimmed(line).empty()) separator = separator_of(line);
    out += joined(fields_of(line, separator == 0 ? ',' : separator), columns) + "\n";
  }
  while (out.ends_with("\n\n")) out.pop_back();
  return out == "\n" ? std::string() : out;
}

std::string_view cut(std::string_view& rest, char separator) noexcept {
  const std::size_t at = rest.find(separator);
  const std::string_view head = rest.substr(0, at);
  rest.remove_prefix(at == std::string_view::npos ? rest.size() : at + 1);
  return head;
}

std::vector<std::string_view> table_fields(std::string_view line) {
  std::vector<std::string_view> fields;
  for (bool more = true; more;) {
    more = line.find(',') != std::string_view::npos;
    fields.push_back(cut(line, ','));
  }
  return fields;
}

}  // namespace enamel
