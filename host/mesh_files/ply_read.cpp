#include "host/mesh_files/ply_read.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>
#include <utility>

#include "host/mesh_files/mesh_soup.hpp"
#include "host/mesh_files/ply_header.hpp"
#include "host/mesh_files/text_scan.hpp"
#include "protocol/base/bytes.hpp"
#include "protocol/base/plain_text.hpp"

namespace enamel::host {
namespace {

tl::unexpected<Error> bad_ply(std::string reason) { return fail(ErrorCode::kMeshInvalid, "PLY: " + std::move(reason)); }

/// Values of a body one after the other, whichever way they are written. After the first failure all are useless.
class Values {
 public:
  Values(std::string_view body, PlyForm form)
      : form_(form), words_(body), reader_(std::as_bytes(std::span(body.data(), body.size()))) {}

  double next(PlyType type) { return form_ == PlyForm::kAscii ? next_word_value() : next_binary(type); }
  [[nodiscard]] bool ok() const { return form_ == PlyForm::kAscii ? ok_ : reader_.ok(); }
  /// What is left has room for so many rows, or list items, of at least so many values and bytes.
  [[nodiscard]] bool holds(std::uint64_t rows, std::uint64_t values, std::uint64_t bytes) const {
    const std::uint64_t least = form_ == PlyForm::kAscii ? 2 * values : bytes;
    // ascii: the last value may do without a separator.
    return rows == 0 || least == 0 || rows <= (left() + 1) / least;
  }

 private:
  [[nodiscard]] std::uint64_t left() const { return form_ == PlyForm::kAscii ? words_.left() : reader_.remaining(); }
  template <class T>
  double binary() {
    std::array<std::byte, sizeof(T)> bytes{};
    const auto taken = reader_.take(sizeof(T));
    std::copy(taken.begin(), taken.end(), bytes.begin());
    if (form_ == PlyForm::kBigEndian) {
      std::reverse(bytes.begin(), bytes.end());
    }
    return static_cast<double>(std::bit_cast<T>(bytes));
  }
  double next_binary(PlyType type) {
    switch (type) {
      case PlyType::kInt8:
        return binary<std::int8_t>();
      case PlyType::kUint8:
        return binary<std::uint8_t>();
      case PlyType::kInt16:
        return binary<std::int16_t>();
      case PlyType::kUint16:
        return binary<std::uint16_t>();
      case PlyType::kInt32:
        return binary<std::int32_t>();
      case PlyType::kUint32:
        return binary<std::uint32_t>();
      case PlyType::kFloat32:
        return binary<float>();
      case PlyType::kFloat64:
        return binary<double>();
    }
    return 0.0;
  }
  double next_word_value() {
    const auto value = to_real(words_.next());
    ok_ = ok_ && value.has_value();
    return value.value_or(std::numeric_limits<double>::quiet_NaN());
  }

  PlyForm form_;
  Words words_;
  ByteReader reader_;
  bool ok_ = true;
};

/// Length of the list that begins here; nothing when the rest cannot hold it.
std::optional<std::uint64_t> list_length(const PlyProperty& property, Values& values) {
  const double count = values.next(property.count_type);
  constexpr double kAnyCount = 4294967296.0;
  if (!values.ok() || !(count >= 0.0 && count < kAnyCount)) {
    return std::nullopt;
  }
  const auto length = static_cast<std::uint64_t>(count);
  return values.holds(length, 1, size_of(property.type)) ? std::optional(length) : std::nullopt;
}

Result<void> skip(const PlyProperty& property, Values& values) {
  const auto length = property.is_list ? list_length(property, values) : std::optional<std::uint64_t>(1);
  if (!length) {
    return bad_ply("truncated, or an impossible length of a list '" + property.name + "'");
  }
  for (std::uint64_t k = 0; k < *length; ++k) {
    static_cast<void>(values.next(property.type));
  }
  return {};
}

/// Where the values of one vertex property go; a list goes nowhere.
struct Sink {
  double* position = nullptr;
  float* value = nullptr;
  std::size_t step = 1;
};

const PlyProperty* scalar(const PlyElement& element, std::string_view name) {
  const auto at = std::find_if(element.properties.begin(), element.properties.end(),
                               [&](const PlyProperty& p) { return p.name == name && !p.is_list; });
  return at == element.properties.end() ? nullptr : &*at;
}

Sink sink_of(const PlyProperty& property, MeshSoup& out) {
  const std::string& name = property.name;
  if (property.is_list) {
    return {};
  }
  for (int axis = 0; axis < 3; ++axis) {
    const char letter = static_cast<char>('x' + axis);
    if (name.size() == 1 && name[0] == letter) {
      return {&out.positions[0][axis], nullptr, 3};
    }
    if (!out.normals.empty() && name.size() == 2 && name[0] == 'n' && name[1] == letter) {
      return {nullptr, &out.normals[0][axis], 3};
    }
  }
  if (name == "quality") {
    return {nullptr, out.quality.data(), 1};
  }
  std::vector<float>& values = out.vertex_values[name];
  values.resize(out.positions.size());
  return {nullptr, values.data(), 1};
}

Result<void> read_vertices(const PlyElement& element, Values& values, MeshSoup& out) {
  const PlyProperty* x = scalar(element, "x");
  if (x == nullptr || scalar(element, "y") == nullptr || scalar(element, "z") == nullptr) {
    return bad_ply("vertices without x, y, z");
  }
  const auto count = static_cast<std::size_t>(element.count);
  if (count == 0) {
    return {};
  }
  const bool normals = scalar(element, "nx") != nullptr && scalar(element, "ny") != nullptr && scalar(element, "nz");
  out.positions.resize(count);
  out.normals.resize(normals ? count : 0);
  out.quality.resize(scalar(element, "quality") != nullptr ? count : 0);
  std::vector<Sink> sinks;
  for (const PlyProperty& p : element.properties) {
    sinks.push_back(sink_of(p, out));
  }
  for (std::size_t row = 0; row < count && values.ok(); ++row) {
    for (std::size_t k = 0; k < sinks.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      const Sink& sink = sinks[k];
      if (sink.position != nullptr) {
        sink.position[row * sink.step] = values.next(property.type);
      } else if (sink.value != nullptr) {
        sink.value[row * sink.step] = static_cast<float>(values.next(property.type));
      } else {
        ENAMEL_TRY(skip(property, values));
      }
    }
  }
  return {};
}

/// Stripped: every corner after the second makes a triangle with the two before it, turned every other time; -1 begins
/// anew (Stanford's scans).
void add_strip(const std::vector<double>& corners, MeshSoup& out) {
  std::vector<std::uint32_t> strip;
  for (const double corner : corners) {
    if (corner < 0) {
      strip.clear();
      continue;
    }
    strip.push_back(static_cast<std::uint32_t>(corner));
    const std::size_t n = strip.size();
    if (n >= 3) {
      const std::size_t turned = (n - 3) % 2;
      out.triangles.push_back({strip[n - 3 + turned], strip[n - 2 - turned], strip[n - 1]});
    }
  }
}

struct FaceKind {
  std::uint64_t vertices = 0;
  bool strips = false;
};

Result<void> read_face(std::uint64_t row, const FaceKind& kind, std::vector<double>& corners, MeshSoup& out) {
  for (const double index : corners) {
    const bool good = index >= 0.0 && index < static_cast<double>(kind.vertices) &&
                      index == static_cast<double>(static_cast<std::uint64_t>(index));
    if (!good && !(kind.strips && index == -1.0)) {
      return bad_ply("face " + std::to_string(row) + " names a vertex that does not exist");
    }
  }
  kind.strips ? add_strip(corners, out) : out.add_face({corners.begin(), corners.end()});
  return {};
}

Result<void> read_faces(const PlyElement& element, const FaceKind& kind, Values& values, MeshSoup& out) {
  std::vector<double> corners;
  const PlyProperty* synthetic = scalar(element, "synthetic");
  for (std::uint64_t row = 0; row < element.count && values.ok(); ++row) {
    bool made_up = false;
    for (const PlyProperty& p : element.properties) {
      if (&p == synthetic) {
        made_up = values.next(p.type) > 0.5;
        continue;
      }
      if (!p.is_list || (p.name != "vertex_indices" && p.name != "vertex_index")) {
        ENAMEL_TRY(skip(p, values));
        continue;
      }
      const auto length = list_length(p, values);
      if (!length) {
        return bad_ply("truncated, or face " + std::to_string(row) + " has an impossible number of corners");
      }
      corners.clear();
      for (std::uint64_t k = 0; k < *length; ++k) {
        corners.push_back(values.next(p.type));
      }
      if (values.ok()) {
        ENAMEL_TRY(read_face(row, kind, corners, out));
      }
    }
    if (synthetic != nullptr) {
      out.tag_synthetic(made_up);
    }
  }
  return {};
}

Result<void> read_element(const PlyElement& element, std::uint64_t vertices, Values& values, MeshSoup& out) {
  std::uint64_t bytes = 0;  // of a row, at least
  for (const PlyProperty& p : element.properties) {
    bytes += size_of(p.is_list ? p.count_type : p.type);
  }
  if (!values.holds(element.count, element.properties.size(), bytes)) {
    return bad_ply("truncated: " + std::to_string(element.count) + " x " + element.name +
                   " do not fit into what follows");
  }
  if (element.name == "vertex") {
    return read_vertices(element, values, out);
  }
  if (element.name == "face" || element.name == "tristrips") {
    return read_faces(element, {vertices, element.name == "tristrips"}, values, out);
  }
  const std::uint64_t rows = element.properties.empty() ? 0 : element.count;
  for (std::uint64_t row = 0; row < rows && values.ok(); ++row) {
    for (const PlyProperty& p : element.properties) {
      ENAMEL_TRY(skip(p, values));
    }
  }
  return {};
}

}  // namespace

Result<MeshFile> parse_ply(std::string_view bytes) {
  bytes = without_utf8_mark(bytes);
  ENAMEL_TRY_ASSIGN(const PlyHeader header, take_ply_header(bytes));
  Values values(bytes, header.form);
  MeshSoup out;
  std::uint64_t vertices = 0;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      if (vertices > 0) {
        return bad_ply("two elements 'vertex'");
      }
      vertices = element.count;
      const PlyProperty* x = scalar(element, "x");
      out.floats = header.form != PlyForm::kAscii && x != nullptr && x->type == PlyType::kFloat32;
    }
  }
  for (const PlyElement& element : header.elements) {
    ENAMEL_TRY(read_element(element, vertices, values, out));
    if (!values.ok()) {
      return bad_ply("truncated or malformed in element '" + element.name + "'");
    }
  }
  return finish_mesh(std::move(out), "PLY");
}

}  // namespace enamel::host
