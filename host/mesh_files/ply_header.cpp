#include "host/mesh_files/ply_header.hpp"

#include <array>
#include <optional>
#include <utility>

#include "host/mesh_files/text_scan.hpp"

namespace enamel::host {
namespace {

tl::unexpected<Error> bad_header(std::string reason) {
  return fail(ErrorCode::kMeshInvalid, "PLY header: " + std::move(reason));
}

std::optional<PlyType> type_named(std::string_view word) {
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> kNames{{{"char", PlyType::kInt8},
                                                                         {"int8", PlyType::kInt8},
                                                                         {"uchar", PlyType::kUint8},
                                                                         {"uint8", PlyType::kUint8},
                                                                         {"short", PlyType::kInt16},
                                                                         {"int16", PlyType::kInt16},
                                                                         {"ushort", PlyType::kUint16},
                                                                         {"uint16", PlyType::kUint16},
                                                                         {"int", PlyType::kInt32},
                                                                         {"int32", PlyType::kInt32},
                                                                         {"uint", PlyType::kUint32},
                                                                         {"uint32", PlyType::kUint32},
                                                                         {"float", PlyType::kFloat32},
                                                                         {"float32", PlyType::kFloat32},
                                                                         {"double", PlyType::kFloat64},
                                                                         {"float64", PlyType::kFloat64}}};
  for (const auto& [name, type] : kNames) {
    if (name == word) {
      return type;
    }
  }
  return std::nullopt;
}

Result<PlyProperty> property_of(std::string_view line) {
  PlyProperty property;
  std::string_view word = next_word(line);
  if (word == "list") {
    property.is_list = true;
    const auto count = type_named(next_word(line));
    if (!count || *count == PlyType::kFloat32 || *count == PlyType::kFloat64) {
      return bad_header("a list needs a whole number as its count");
    }
    property.count_type = *count;
    word = next_word(line);
  }
  const auto type = type_named(word);
  if (!type) {
    return bad_header("unknown type '" + std::string(word.substr(0, 40)) + "'");
  }
  property.type = *type;
  property.name = next_word(line);
  return property;
}

Result<PlyForm> form_named(std::string_view word) {
  if (word == "ascii") {
    return PlyForm::kAscii;
  }
  if (word == "binary_little_endian") {
    return PlyForm::kLittleEndian;
  }
  if (word == "binary_big_endian") {
    return PlyForm::kBigEndian;
  }
  return bad_header("format '" + std::string(word.substr(0, 40)) +
                    "' is not ascii, binary_little_endian or binary_big_endian");
}

/// Where lines end in CR alone, an LF after one is the first byte of a binary body.
bool next_header_line(std::string_view& bytes, std::string_view& line, bool only_cr) {
  if (!only_cr) {
    return next_line(bytes, line);
  }
  const std::size_t end = bytes.find('\r');
  line = bytes.substr(0, end);
  bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
  return end != std::string_view::npos;
}

}  // namespace

std::size_t size_of(PlyType type) noexcept {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kFloat64:
      return 8;
    default:
      return 4;
  }
}

Result<PlyHeader> take_ply_header(std::string_view& bytes) {
  PlyHeader header;
  std::string_view line;
  const bool only_cr = bytes.size() > 4 && bytes[3] == '\r' && bytes[4] != '\n';
  if (!next_line(bytes, line) || next_word(line) != "ply") {
    return bad_header("the file does not begin with 'ply'");
  }
  bool has_form = false;
  while (next_header_line(bytes, line, only_cr)) {
    const std::string_view word = next_word(line);
    if (word == "end_header") {
      return has_form ? Result<PlyHeader>(std::move(header)) : bad_header("no format line");
    }
    if (word == "format") {
      ENAMEL_TRY_ASSIGN(header.form, form_named(next_word(line)));
      has_form = true;
    } else if (word == "element") {
      const std::string_view name = next_word(line);
      const auto count = to_number<std::uint64_t>(next_word(line));
      if (!count) {
        return bad_header("element without a count");
      }
      header.elements.push_back({std::string(name), *count, {}});
    } else if (word == "property") {
      if (header.elements.empty()) {
        return bad_header("property before any element");
      }
      ENAMEL_TRY_ASSIGN(PlyProperty property, property_of(line));
      header.elements.back().properties.push_back(std::move(property));
    } else if (!word.empty() && word != "comment" && word != "obj_info") {
      return bad_header("unknown line '" + std::string(word.substr(0, 40)) + "'");
    }
  }
  return bad_header("no end_header: truncated");
}

}  // namespace enamel::host
