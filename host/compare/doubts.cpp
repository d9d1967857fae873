#include "host/compare/doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "protocol/base/json_text.hpp"

namespace enamel::host {
namespace {

constexpr double kSmallestMm = 5.0, kLargestMm = 400.0;        ///< across: half a tooth … a head
constexpr double kLikelyLeastMm = 8.0, kLikelyMostMm = 150.0;  ///< across: a tooth … a full jaw on its base
constexpr double kSameSize = 1.25;   ///< two meshes of one thing differ by less, parts and borders aside
constexpr double kSameThing = 1.03;  ///< two meshes of all of one thing
constexpr double kApart_um = 500.0;  ///< mean deviation of two meshes that do not lie on each other
constexpr double kNoFit_um = 50.0;   ///< the least of two that are not of one form
constexpr double kCoarseStepMm = 1e-3;
constexpr std::size_t kStray = 100;  ///< one vertex in so many, at either end of an axis, does not count as size

struct Unit {
  const char* name;
  double mm;
};
constexpr std::array<Unit, 6> kUnits{{{"metres", 1000.0},
                                      {"centimetres", 10.0},
                                      {"inches", 25.4},
                                      {"feet", 304.8},
                                      {"micrometres", 1e-3},
                                      {"nanometres", 1e-6}}};

/// Diagonal of the box of all references (or the mesh), stray vertices aside.
double size_mm(std::span<const MeshFile> files) {
  Vec3d extent = Vec3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const MeshFile& file : files) {
      for (const Vec3f& v : file.mesh.vertices) {
        values.push_back(static_cast<double>(v[axis]) + file.origin_mm[axis]);
      }
    }
    const std::size_t off = values.size() / kStray;
    const auto low = values.begin() + static_cast<std::ptrdiff_t>(off);
    const auto high = values.end() - 1 - static_cast<std::ptrdiff_t>(off);
    std::nth_element(values.begin(), low, values.end());
    const double first = *low;
    std::nth_element(values.begin(), high, values.end());
    extent[axis] = *high - first;
  }
  return extent.norm();
}

bool is_mouth(double mm) { return mm >= kSmallestMm && mm <= kLargestMm; }

double apart(double a, double b) { return std::max(a / b, b / a); }

/// The units in which a size could be a mouth's; one alone where it is then the size of the other mesh.
std::vector<Unit> units_for(double size, double other) {
  std::vector<Unit> out;
  for (const Unit& unit : kUnits) {
    const double mm = size * unit.mm;
    if (is_mouth(other) && apart(mm, other) < kSameSize) {
      return {unit};
    }
    if (mm >= kLikelyLeastMm && mm <= kLikelyMostMm) {
      out.push_back(unit);
    }
  }
  return out;
}

std::optional<std::string> size_words(double size, double other) {
  if (is_mouth(size)) {
    return std::nullopt;
  }
  std::string words = fmt::format("{:.3g} mm across, too {} for a mouth", size, size < kSmallestMm ? "small" : "large");
  const auto units = units_for(size, other);
  for (std::size_t i = 0; i < units.size(); ++i) {
    words += fmt::format("{} in {} (times {:g}) {:.3g} mm", i == 0 ? "; it would be" : ", or", units[i].name,
                         units[i].mm, size * units[i].mm);
  }
  return words + (units.empty() ? "; no common unit fits" : ": is the unit wrong?");
}

/// Sizes that both could be, one of them in another unit: told only where the two do not lie on each other, be they
/// laid on each other as well as it goes.
std::optional<std::string> ratio_words(double mesh, double reference, const CompareResult& result) {
  if (!is_mouth(mesh) || !is_mouth(reference)) {
    return std::nullopt;
  }
  for (const Unit& unit : kUnits) {
    const double off = apart(apart(mesh, reference), unit.mm);
    if (unit.mm > 1 &&
        ((off < kSameSize && result.mean_abs_um > kApart_um) || (off < kSameThing && result.mean_abs_um > kNoFit_um))) {
      const double small = std::min(mesh, reference), large = std::max(mesh, reference);
      return fmt::format(
          "{:.3g} mm across, the other {:.3g} mm; it would be in {} (times {:g}) {:.3g} mm: is the unit wrong?", small,
          large, unit.name, unit.mm, small * unit.mm);
    }
  }
  return std::nullopt;
}

void tell_file(const MeshFile& file, const std::string& name, Doubts& out) {
  if (const std::string left_out = left_out_text(file.left_out); !left_out.empty()) {
    out.words.push_back(name + ": left out: " + left_out);
  }
  if (file.step_mm > kCoarseStepMm) {
    out.words.push_back(
        fmt::format("{}: lies {:.4g} m from the origin, where its numbers go in steps of {:.3g} um: what is finer is "
                    "lost in the file",
                    name, file.origin_mm.norm() * 1e-3, file.step_mm * 1e3));
  }
}

void add(const LeftOut& file, LeftOut& sum) {
  sum.unused_vertices += file.unused_vertices;
  sum.broken_vertices += file.broken_vertices;
  sum.broken_faces += file.broken_faces;
  sum.flat_faces += file.flat_faces;
  sum.synthetic_faces += file.synthetic_faces;
  sum.normals = sum.normals || file.normals;
}

nlohmann::ordered_json counts(const LeftOut& left_out) {
  return {{"unused_vertices", left_out.unused_vertices},
          {"broken_vertices", left_out.broken_vertices},
          {"broken_faces", left_out.broken_faces},
          {"flat_faces", left_out.flat_faces},
          {"synthetic_faces", left_out.synthetic_faces}};
}

}  // namespace

Doubts doubts_of(const MeshFile& mesh, std::span<const MeshFile> references, std::span<const std::string> names,
                 const CompareResult& result) {
  Doubts out;
  tell_file(mesh, names[0], out);
  out.mesh = mesh.left_out;
  for (std::size_t i = 0; i < references.size(); ++i) {
    tell_file(references[i], names[i + 1], out);
    add(references[i].left_out, out.reference);
  }
  const double mesh_mm = size_mm({&mesh, 1}), reference_mm = size_mm(references);
  const std::string reference_name = names[1] + (references.size() > 1 ? " and the other references" : "");
  const auto tell = [&](const std::string& name, const std::optional<std::string>& words) {
    if (words) {
      out.words.push_back(name + ": " + *words);
      out.unit = true;
    }
  };
  tell(names[0], size_words(mesh_mm, reference_mm));
  tell(reference_name, size_words(reference_mm, mesh_mm));
  tell(mesh_mm < reference_mm ? names[0] : reference_name, ratio_words(mesh_mm, reference_mm, result));
  if (!out.unit && result.alignment == Alignment::kNone && result.mean_abs_um > kApart_um) {
    out.words.push_back(
        fmt::format("{}: lies {:.3g} mm off in the mean, as the files stand; --align best lays it on the "
                    "reference first",
                    names[0], result.mean_abs_um * 1e-3));
  }
  return out;
}

std::string compare_json(const CompareResult& result, const Doubts& doubts) {
  auto j = nlohmann::ordered_json::parse(compare_json(result));
  j["left_out"] = {{"mesh", counts(doubts.mesh)}, {"reference", counts(doubts.reference)}};
  j["warnings"] = doubts.words;
  return json_text(j, 2);
}

}  // namespace enamel::host
