// PLY, ASCII and binary little-endian, with any properties about the ones that matter.
#include <array>
#include <cstring>
#include <sstream>

#include "tools/twin/surface/mesh_file.hpp"

namespace enamel::twin {
namespace {

struct Property {
  std::string name;
  char type = 'f';      // of the value (or of the list's items)
  char count_type = 0;  // of a list's length; 0: not a list
};
struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};
struct Header {
  bool ascii = false;
  std::vector<Element> elements;
  std::size_t body = 0;
};

tl::unexpected<Error> bad_ply(std::string why) { return fail(ErrorCode::kMeshInvalid, "PLY: " + std::move(why)); }

/// One letter a type: b B h H i I f d; 0 when unknown.
char type_code(const std::string& name) {
  if (name == "char" || name == "int8") return 'b';
  if (name == "uchar" || name == "uint8") return 'B';
  if (name == "short" || name == "int16") return 'h';
  if (name == "ushort" || name == "uint16") return 'H';
  if (name == "int" || name == "int32") return 'i';
  if (name == "uint" || name == "uint32") return 'I';
  if (name == "float" || name == "float32") return 'f';
  if (name == "double" || name == "float64") return 'd';
  return 0;
}

std::size_t type_size(char type) {
  switch (type) {
    case 'b':
    case 'B':
      return 1;
    case 'h':
    case 'H':
      return 2;
    case 'd':
      return 8;
    default:
      return 4;
  }
}

Result<void> read_property(std::istringstream& in, Header& header) {
  std::string type;
  Property p;
  if (header.elements.empty() || !(in >> type)) return bad_ply("property outside an element");
  if (type == "list") {
    std::string count;
    if (!(in >> count >> type)) return bad_ply("list property is not understood");
    p.count_type = type_code(count);
    if (p.count_type == 0) return bad_ply("unknown type " + count);
  }
  p.type = type_code(type);
  if (p.type == 0 || !(in >> p.name)) return bad_ply("unknown property type " + type);
  header.elements.back().properties.push_back(p);
  return {};
}

Result<Header> read_header(const std::string& bytes) {
  Header header;
  std::size_t at = 0;
  for (bool first = true;; first = false) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string::npos) return bad_ply("header does not end");
    std::istringstream in(bytes.substr(at, end - at));
    at = end + 1;
    std::string word;
    in >> word;
    if (first && word != "ply") return bad_ply("file does not begin with 'ply'");
    if (word == "format") {
      in >> word;
      if (word != "ascii" && word != "binary_little_endian") return bad_ply("format " + word + " is not supported");
      header.ascii = word == "ascii";
    } else if (word == "element") {
      Element e;
      if (!(in >> e.name >> e.count)) return bad_ply("element line is not understood");
      header.elements.push_back(e);
    } else if (word == "property") {
      ENAMEL_TRY(read_property(in, header));
    } else if (word == "end_header") {
      header.body = at;
      return header;
    }
  }
}

/// Numbers one after the other from either encoding.
class Values {
 public:
  Values(const std::string& bytes, const Header& header) : bytes_(bytes), at_(header.body), ascii_(header.ascii) {
    if (ascii_) text_.str(bytes.substr(at_));
  }
  bool next(char type, double& value) {
    if (ascii_) return static_cast<bool>(text_ >> value);
    const std::size_t size = type_size(type);
    if (bytes_.size() - at_ < size) return false;
    const char* p = bytes_.data() + at_;
    at_ += size;
    switch (type) {
      case 'b':
        value = get<std::int8_t>(p);
        break;
      case 'B':
        value = get<std::uint8_t>(p);
        break;
      case 'h':
        value = get<std::int16_t>(p);
        break;
      case 'H':
        value = get<std::uint16_t>(p);
        break;
      case 'i':
        value = get<std::int32_t>(p);
        break;
      case 'I':
        value = get<std::uint32_t>(p);
        break;
      case 'f':
        value = static_cast<double>(get<float>(p));
        break;
      default:
        value = get<double>(p);
        break;
    }
    return true;
  }

 private:
  template <class T>
  static T get(const char* p) {
    T v;
    std::memcpy(&v, p, sizeof v);
    return v;
  }
  const std::string& bytes_;
  std::size_t at_;
  bool ascii_;
  std::istringstream text_;
};

Result<void> read_row(const Element& e, Values& values, TriSurface& mesh) {
  Vec3f v = Vec3f::Zero();
  for (const auto& p : e.properties) {
    double x = 0;
    if (p.count_type == 0) {
      if (!values.next(p.type, x)) return bad_ply("file ends within " + e.name);
      if (p.name == "x") v.x() = static_cast<float>(x);
      if (p.name == "y") v.y() = static_cast<float>(x);
      if (p.name == "z") v.z() = static_cast<float>(x);
      continue;
    }
    constexpr double kMaxCorners = 4096;
    if (!values.next(p.count_type, x) || !(x >= 0 && x <= kMaxCorners)) return bad_ply("list length is not usable");
    std::vector<std::uint32_t> corners(static_cast<std::size_t>(x));
    for (auto& c : corners) {
      if (!values.next(p.type, x)) return bad_ply("file ends within " + e.name);
      if (!(x >= 0 && x < 4294967295.0)) return bad_ply("a face names a negative vertex");
      c = static_cast<std::uint32_t>(x);
    }
    if (e.name != "face" || p.name.rfind("vertex_ind", 0) != 0) continue;
    for (std::size_t i = 2; i < corners.size(); ++i) mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
  }
  if (e.name == "vertex") mesh.vertices.push_back(v);
  return {};
}

}  // namespace

Result<TriSurface> parse_ply(const std::string& bytes) {
  ENAMEL_TRY_ASSIGN(const Header header, read_header(bytes));
  Values values(bytes, header);
  TriSurface mesh;
  for (const auto& e : header.elements) {
    if (e.properties.empty() && e.count > 0) return bad_ply("element " + e.name + " has no properties");
    for (std::size_t i = 0; i < e.count; ++i) ENAMEL_TRY(read_row(e, values, mesh));
  }
  if (mesh.triangles.empty()) return bad_ply("no triangles");
  for (const auto& v : mesh.vertices) {
    if (!v.allFinite()) return bad_ply("a vertex is not finite");
  }
  for (const auto& t : mesh.triangles) {
    for (const auto i : t) {
      if (i >= mesh.vertices.size()) return bad_ply("a face names a vertex that does not exist");
    }
  }
  return mesh;
}

}  // namespace enamel::twin
