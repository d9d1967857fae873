#include "host/mesh_files/ply_read.hpp"

#include <limits>
#include <utility>

#include "host/mesh_files/mesh_check.hpp"
#include "host/mesh_files/ply_header.hpp"
#include "host/mesh_files/text_scan.hpp"
#include "protocol/base/bytes.hpp"

namespace enamel::host {
namespace {

constexpr std::uint64_t kMaxCorners = 1000;

tl::unexpected<Error> bad_ply(std::string reason) { return fail(ErrorCode::kMeshInvalid, "PLY: " + std::move(reason)); }

/// Values of a body one after the other, whichever way they are written. After the first failure all are NaN.
class Values {
 public:
  Values(std::string_view body, bool ascii)
      : ascii_(ascii), text_(body), reader_(std::as_bytes(std::span(body.data(), body.size()))) {}

  double next(PlyType type) { return ascii_ ? next_word_value() : next_binary(type); }
  [[nodiscard]] bool ok() const { return ascii_ ? ok_ : reader_.ok(); }
  /// Bytes not read yet.
  [[nodiscard]] std::uint64_t left() const { return ascii_ ? text_.size() : reader_.remaining(); }

 private:
  double next_binary(PlyType type) {
    switch (type) {
      case PlyType::kInt8:
        return reader_.get<std::int8_t>();
      case PlyType::kUint8:
        return reader_.get<std::uint8_t>();
      case PlyType::kInt16:
        return reader_.get<std::int16_t>();
      case PlyType::kUint16:
        return reader_.get<std::uint16_t>();
      case PlyType::kInt32:
        return reader_.get<std::int32_t>();
      case PlyType::kUint32:
        return reader_.get<std::uint32_t>();
      case PlyType::kFloat32:
        return static_cast<double>(reader_.get<float>());
      case PlyType::kFloat64:
        return reader_.get<double>();
    }
    return 0.0;
  }
  double next_word_value() {
    std::string_view word;
    while (word.empty() && (!line_.empty() || next_line(text_, line_))) {
      word = next_word(line_);
    }
    const auto value = to_number<double>(word);
    ok_ = ok_ && value.has_value();
    return value.value_or(std::numeric_limits<double>::quiet_NaN());
  }

  bool ascii_;
  std::string_view text_, line_;
  ByteReader reader_;
  bool ok_ = true;
};

/// Where the values of one vertex property go.
struct Sink {
  float* first = nullptr;
  std::size_t step = 1;
};

bool has_scalar(const PlyElement& element, std::string_view name) {
  for (const PlyProperty& p : element.properties) {
    if (p.name == name && !p.is_list) {
      return true;
    }
  }
  return false;
}

Sink sink_of(const std::string& name, std::size_t count, MeshFile& out) {
  Mesh& mesh = out.mesh;
  const auto component = [&](std::size_t k) { return std::string_view("xyz")[k]; };
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    if (name.size() == 1 && name[0] == component(k)) {
      return {&mesh.vertices[0][axis], 3};
    }
    if (!mesh.normals.empty() && name.size() == 2 && name[0] == 'n' && name[1] == component(k)) {
      return {&mesh.normals[0][axis], 3};
    }
  }
  if (name == "quality") {
    return {mesh.quality.data(), 1};
  }
  std::vector<float>& values = out.vertex_values[name];
  values.resize(count);
  return {values.data(), 1};
}

Result<void> read_vertices(const PlyElement& element, Values& values, MeshFile& out) {
  if (!has_scalar(element, "x") || !has_scalar(element, "y") || !has_scalar(element, "z")) {
    return bad_ply("vertices without x, y, z");
  }
  const auto count = static_cast<std::size_t>(element.count);
  if (count == 0) {
    return {};
  }
  const bool normals = has_scalar(element, "nx") && has_scalar(element, "ny") && has_scalar(element, "nz");
  out.mesh.vertices.resize(count);
  out.mesh.normals.resize(normals ? count : 0);
  out.mesh.quality.resize(has_scalar(element, "quality") ? count : 0);
  std::vector<Sink> sinks;
  for (const PlyProperty& p : element.properties) {
    if (p.is_list) {
      return bad_ply("a list among the vertex properties");
    }
    sinks.push_back(sink_of(p.name, count, out));
  }
  for (std::size_t row = 0; row < count && values.ok(); ++row) {
    for (std::size_t k = 0; k < sinks.size(); ++k) {
      sinks[k].first[row * sinks[k].step] = static_cast<float>(values.next(element.properties[k].type));
    }
  }
  return {};
}

/// A row of the element is at least this long.
std::uint64_t least_row_bytes(const PlyElement& element, bool ascii) {
  std::uint64_t bytes = 0;
  for (const PlyProperty& p : element.properties) {
    bytes += ascii ? 2U : size_of(p.is_list ? p.count_type : p.type);
  }
  return bytes;
}

Result<void> read_faces(const PlyElement& element, Values& values, MeshFile& out) {
  std::vector<std::uint32_t> corners;
  const std::size_t vertices = out.mesh.vertices.size();
  for (std::uint64_t row = 0; row < element.count && values.ok(); ++row) {
    for (const PlyProperty& p : element.properties) {
      const double count = p.is_list ? values.next(p.count_type) : 1.0;
      if (!values.ok()) {
        break;
      }
      if (!(count >= 0.0 && count <= static_cast<double>(kMaxCorners))) {
        return bad_ply("face " + std::to_string(row) + " has an impossible number of corners");
      }
      const bool wanted = p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
      corners.clear();
      for (std::uint64_t k = 0; k < static_cast<std::uint64_t>(count) && values.ok(); ++k) {
        const double index = values.next(p.type);
        if (!wanted || !values.ok()) {
          continue;
        }
        if (!(index >= 0.0 && index < static_cast<double>(vertices) &&
              index == static_cast<double>(static_cast<std::uint64_t>(index)))) {
          return bad_ply("face " + std::to_string(row) + " names a vertex that does not exist");
        }
        corners.push_back(static_cast<std::uint32_t>(index));
      }
      if (wanted && values.ok() && corners.size() < 3) {
        return bad_ply("face " + std::to_string(row) + " has fewer than three corners");
      }
      for (std::size_t k = 2; k < corners.size(); ++k) {
        out.mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
      }
    }
  }
  return {};
}

void skip_element(const PlyElement& element, Values& values) {
  for (std::uint64_t row = 0; row < element.count && values.ok(); ++row) {
    for (const PlyProperty& p : element.properties) {
      const double count = p.is_list ? values.next(p.count_type) : 1.0;
      for (double k = 0.0; k < count && values.ok(); k += 1.0) {
        static_cast<void>(values.next(p.type));
      }
    }
  }
}

}  // namespace

Result<MeshFile> parse_ply(std::string_view bytes) {
  ENAMEL_TRY_ASSIGN(const PlyHeader header, take_ply_header(bytes));
  Values values(bytes, header.ascii);
  MeshFile out;
  bool has_vertices = false;
  for (const PlyElement& element : header.elements) {
    const std::uint64_t row = least_row_bytes(element, header.ascii);
    // ascii: the last value may do without a separator.
    if (element.count > 0 && (row == 0 || element.count > (values.left() + 1) / row)) {
      return bad_ply("truncated: " + std::to_string(element.count) + " x " + element.name +
                     " do not fit into what follows");
    }
    if (element.name == "vertex") {
      has_vertices = true;
      ENAMEL_TRY(read_vertices(element, values, out));
    } else if (element.name == "face") {
      if (!has_vertices) {
        return bad_ply("faces before vertices");
      }
      ENAMEL_TRY(read_faces(element, values, out));
    } else {
      skip_element(element, values);
    }
    if (!values.ok()) {
      return bad_ply("truncated or malformed in element '" + element.name + "'");
    }
  }
  ENAMEL_TRY(check_mesh(out.mesh, "PLY"));
  return out;
}

}  // namespace enamel::host
