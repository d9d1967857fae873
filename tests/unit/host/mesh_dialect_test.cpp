// Meshes as other programs write them: every dialect of one tetrahedron is the same tetrahedron.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "host/mesh_files/mesh_file.hpp"
#include "tests/unit/host/tetrahedron.hpp"

namespace enamel::host {
namespace {

using testing::HasSubstr;

void expect_tetrahedron(std::string_view bytes, MeshFormat format, const std::string& what) {
  const auto file = parse_mesh(bytes, format);
  ASSERT_TRUE(file.has_value()) << what << ": " << file.error().detail;
  EXPECT_EQ(soup_of(*file), expected()) << what;
  EXPECT_EQ(left_out_text(file->left_out), "") << what;
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return text;
}

std::string utf16(std::string_view text, bool big) {
  std::string out = big ? "\xfe\xff" : "\xff\xfe";
  for (const char c : text) out += big ? std::string{'\0', c} : std::string{c, '\0'};
  return out;
}

TEST(MeshDialect, text_stl_in_every_form_is_read) {
  const std::string plain = stl_text();
  const std::pair<const char*, std::string> forms[] = {
      {"plain", plain},
      {"blank before solid", "  " + plain},
      {"empty lines before solid", "\r\n\n\t" + plain},
      {"byte order mark", "\xef\xbb\xbf" + plain},
      {"byte order mark and blank", "\xef\xbb\xbf \n" + plain},
      {"UTF-16", utf16(plain, false)},
      {"UTF-16 the other way", utf16(plain, true)},
      {"capitals", upper(plain)},
      {"CRLF", replaced(plain, "\n", "\r\n")},
      {"CR", replaced(plain, "\n", "\r")},
      {"no name", stl_text("")},
      {"keywords in its name", stl_text("facet vertex endsolid 1 2 3")},
      {"Latin-1 in its name", stl_text("Gr\xf6\xdf"
                                       "e")},
      {"decimal commas", replaced(plain, ".", ",")},
      {"exponents", replaced(replaced(plain, "12.500000", "+1.25E+001"), "0.250000", "2.5e-1")},
      {"Fortran's exponents", replaced(plain, "12.500000", "0.125D+02")},
      {"too small for a double", replaced(plain, "0.000000", "1e-400")},
      {"two words for the end", replaced(replaced(plain, "endfacet", "end facet"), "endsolid", "end solid")},
      {"two solids", replaced(plain, "endfacet\n facet", "endfacet\nendsolid\n\nsolid other\n facet")},
      {"without solid", plain.substr(plain.find("facet"))},
      {"remarks before solid", "# vertex 1 2 3 by a program\n; facet\n// solid\n" + plain},
      {"remarks between facets", replaced(plain, "endfacet", "endfacet\n# facet vertex\n")},
      {"all in one line", "solid\n" + replaced(plain.substr(plain.find('\n') + 1), "\n", " ")},
      {"blank lines and blanks at the end", plain + " \r\n\n"},
      {"NUL bytes at the end", plain + std::string(2000, '\0')},
  };
  for (const auto& [what, text] : forms) {
    expect_tetrahedron(text, MeshFormat::kStl, what);
  }
}

TEST(MeshDialect, binary_stl_is_read_whatever_its_header_says) {
  const std::string plain = stl_bytes(tetrahedron());
  const std::string headers[] = {"solid cad export",
                                 "  solid",
                                 "SOLID facet normal",
                                 "\xef\xbb\xbfsolid",
                                 "facet",
                                 std::string("\0\0", 2),
                                 "\xff\xfe"
                                 "COLOR=\1\2\3\4"};
  for (const std::string& header : headers) {
    for (const std::string& tail :
         {std::string(), std::string("\0\0", 2), std::string(49, 'x'), std::string(4096, '\n')}) {
      std::string bytes = plain + tail;
      bytes.replace(0, header.size(), header);
      expect_tetrahedron(bytes, MeshFormat::kStl, header + " + " + std::to_string(tail.size()));
    }
  }
}

TEST(MeshDialect, binary_stl_of_writers_that_never_went_back_to_their_count_is_read_by_its_size) {
  const std::string plain = stl_bytes(tetrahedron());
  for (const char byte : {'\0', '\xff'}) {
    expect_tetrahedron(std::string(plain).replace(80, 4, std::string(4, byte)), MeshFormat::kStl, "not counted");
    const std::string cut = std::string(plain).replace(80, 4, std::string(4, byte)).substr(0, plain.size() - 7);
    EXPECT_FALSE(parse_mesh(cut, MeshFormat::kStl));
  }
}

TEST(MeshDialect, cut_stl_is_still_refused) {
  const std::string text = stl_text();
  EXPECT_THAT(parse_mesh(text.substr(0, text.size() / 2), MeshFormat::kStl).error().detail, HasSubstr("truncated"));
  std::string two = text + text;
  two.resize(two.size() - 80);
  EXPECT_THAT(parse_mesh(two, MeshFormat::kStl).error().detail, HasSubstr("truncated"));
  std::string binary = stl_bytes(tetrahedron());
  binary.replace(0, 5, "solid");
  binary.pop_back();
  EXPECT_THAT(parse_mesh(binary, MeshFormat::kStl).error().detail, HasSubstr("truncated"));
  EXPECT_THAT(parse_mesh(replaced(text, "12.5", "12.x"), MeshFormat::kStl).error().detail, HasSubstr("three numbers"));
}

/// A body in any number type and byte order.
class PlyBody {
 public:
  explicit PlyBody(std::endian order) : order_(order) {}
  template <class T>
  PlyBody& put(T value) {
    std::array<char, sizeof(T)> raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (order_ != std::endian::native) std::reverse(raw.begin(), raw.end());
    bytes_.append(raw.data(), raw.size());
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::endian order_;
  std::string bytes_;
};

template <class Coordinate, class Count, class Index>
std::string binary_ply(std::endian order, const std::string& types, const std::string& line_end = "\n") {
  const auto word = [&](int k) {
    std::string rest = types;
    for (; k > 0; --k) rest = rest.substr(rest.find(' ') + 1);
    return rest.substr(0, rest.find(' '));
  };
  const std::string form = order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
  std::string head = "ply\nformat " + form +
                     " 1.0\ncomment end_header comes later\nobj_info num_cols 512\nelement camera 1\n" +
                     "property list uchar short name\nelement vertex 4\nproperty uchar red\n";
  for (const char* axis : {"x", "y", "z"}) head += "property " + word(0) + " " + axis + "\n";
  head +=
      "property list ushort double weights\nproperty double confidence\nelement face 4\nproperty char flag\nproperty "
      "list " +
      word(1) + " " + word(2) +
      " vertex_indices\nproperty list uchar float texcoord\nelement edge 0\nproperty int vertex1\nend_header\n";
  PlyBody body(order);
  body.put<std::uint8_t>(2).put<std::int16_t>(7).put<std::int16_t>(-7);
  for (const auto& p : kCorners) {
    body.put<std::uint8_t>(200);
    for (const double c : p) body.put(static_cast<Coordinate>(c));
    body.put<std::uint16_t>(1).put(0.5).put(1.0);
  }
  for (const auto& f : kFaces) {
    body.put<std::int8_t>(-1).put(static_cast<Count>(3));
    for (const std::uint32_t corner : f) body.put(static_cast<Index>(corner));
    body.put<std::uint8_t>(2).put(0.5F).put(1.0F);
  }
  return replaced(head, "\n", line_end) + body.bytes();
}

TEST(MeshDialect, binary_ply_in_either_byte_order_and_every_type_is_read) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const std::string what = order == std::endian::little ? "little" : "big";
    expect_tetrahedron(binary_ply<float, std::uint8_t, std::int32_t>(order, "float uchar int"), MeshFormat::kPly, what);
    expect_tetrahedron(binary_ply<double, std::uint8_t, std::uint32_t>(order, "float64 uint8 uint32"), MeshFormat::kPly,
                       what);
    expect_tetrahedron(binary_ply<double, std::int32_t, std::int16_t>(order, "double int32 int16"), MeshFormat::kPly,
                       what);
    expect_tetrahedron(binary_ply<float, std::uint16_t, std::uint8_t>(order, "float32 ushort uchar"), MeshFormat::kPly,
                       what);
    expect_tetrahedron(binary_ply<float, std::int8_t, std::uint16_t>(order, "float char ushort"), MeshFormat::kPly,
                       what);
    for (const char* end : {"\r\n", "\r"}) {
      expect_tetrahedron(binary_ply<float, std::uint8_t, std::int32_t>(order, "float uchar int", end), MeshFormat::kPly,
                         what);
    }
  }
  std::string cut = binary_ply<float, std::uint8_t, std::int32_t>(std::endian::big, "float uchar int");
  cut.pop_back();
  EXPECT_THAT(parse_mesh(cut, MeshFormat::kPly).error().detail, HasSubstr("truncated"));
}

TEST(MeshDialect, ascii_ply_in_every_form_is_read) {
  const std::string plain =
      "ply\nformat ascii 1.0\ncomment x\nelement face 4\nproperty list uchar int vertex_index\nelement vertex 4\n"
      "property int x\nproperty double y\nproperty float z\nproperty list uchar int marks\nend_header\n"
      "3 0 1 2\n3 0 3 1\n3 1 3 2\n3 2 3 0\n0 0 0 0\n12.5 0 0 1 9\n0 1.5e1 0 2 9 9\n0 0.25 -48.125 0\n";
  const std::pair<const char*, std::string> forms[] = {
      {"faces first", plain},
      {"CRLF", replaced(plain, "\n", "\r\n")},
      {"CR", replaced(plain, "\n", "\r")},
      {"byte order mark", "\xef\xbb\xbf" + plain},
      {"blanks", replaced(replaced(plain, " ", "\t  "), "\n", " \n")},
      {"decimal commas", replaced(plain, "0.25 -48.125", "0,25 -48,125")},
      {"no line end", plain.substr(0, plain.size() - 1)},
  };
  for (const auto& [what, text] : forms) {
    expect_tetrahedron(text, MeshFormat::kPly, what);
  }
  EXPECT_THAT(parse_mesh(replaced(plain, "3 2 3 0\n", "3 2 4 0\n"), MeshFormat::kPly).error().detail,
              HasSubstr("face 3"));
}

TEST(MeshDialect, triangle_strips_keep_their_winding) {
  const auto file = parse_mesh(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement "
      "tristrips 1\n"
      "property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 3\n",
      MeshFormat::kPly);
  ASSERT_TRUE(file.has_value()) << file.error().detail;
  using T = std::array<std::uint32_t, 3>;
  EXPECT_EQ(file->mesh.triangles, (std::vector<T>{{0, 1, 2}, {2, 1, 3}, {0, 1, 3}}));
}

TEST(MeshDialect, obj_in_every_form_is_read) {
  const std::string v = "v 0 0 0\nv 12.5 0 0\nv 0 1.5e1 0\nv 0 0.25 -48.125\n";
  const std::string f = "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";
  const std::string plain = v + f;
  const std::pair<const char*, std::string> forms[] = {
      {"plain", plain},
      {"faces first", f + v},
      {"CRLF", replaced(plain, "\n", "\r\n")},
      {"CR", replaced(plain, "\n", "\r")},
      {"byte order mark", "\xef\xbb\xbf" + plain},
      {"UTF-16", utf16(plain, false)},
      {"comment in Latin-1 that ends in a backslash",
       "# Gr\xf6\xdf"
       "e in mm, C:\\scans\\\n" +
           plain},
      {"comments behind", replaced(plain, "\n", " # f 1 2 3 \\\n")},
      {"continued", replaced(plain, " 4 ", " \\\n 4 ")},
      {"continued twice", replaced(plain, " 4 ", " \\\n\t\\\r\n 4\\\n ")},
      {"continued with blanks behind", replaced(plain, " 12.5", " \\  \r\n12.5")},
      {"groups and materials", "mtllib C:\\a b\\c.mtl\no jaw\ng teeth upper\ns off\nusemtl none\n" +
                                   replaced(plain, "f 3", "g other\ns 1\nf 3")},
      {"textures", v + "vt 0 0\nvt 1 0 0\n" + "f 1/1 2/2 3/1\nf 1/1 4/1 2/2\nf 2/2 4/1 3/1\nf 3/1 4/1 1/1\n"},
      {"normals", v + "vn 0 0 1\n" + "f 1//1 2//1 3//1\nf 1/1/1 4/1/1 2/1/1\nf 2 4 3\nf 3 4 1\n"},
      {"from the end", v + "f -4 -3 -2\nf -4 -1 -3\nf -3 -1 -2\nf -2 -1 -4\n"},
      {"colours", replaced(replaced(plain, "0 0 0", "0 0 0 0.5 0.5 1"), "-48.125", "-48.125 1 1 0")},
      {"weights", replaced(plain, "0 0 0", "0 0 0 1.0")},
      {"decimal commas", replaced(plain, ".", ",")},
      {"lines and points", plain + "p 1\nl 1 2 3 \\\n4\nvp 0.5\ncurv 0 1 1 2\n"},
  };
  for (const auto& [what, text] : forms) {
    expect_tetrahedron(text, MeshFormat::kObj, what);
  }
  EXPECT_THAT(parse_mesh(f + v.substr(v.find('v', 1)), MeshFormat::kObj).error().detail, HasSubstr("line 2: names"));
  EXPECT_THAT(parse_mesh(v + "f 1 2 -5\n", MeshFormat::kObj).error().detail, HasSubstr("line 5: names"));
  EXPECT_THAT(parse_mesh(v + "f 1 2 0\n", MeshFormat::kObj).error().detail, HasSubstr("line 5: names"));
}

}  // namespace
}  // namespace enamel::host
