// What a surface is made of, as far as the projector's light tells: how much returns, how far it spreads inside, how
// the surface mirrors. Number 0 is plaster: Lambert, nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace enamel::twin {

enum class MaterialId : std::uint8_t {
  kPlaster,
  kEnamel,
  kDentine,
  kStained,  ///< enamel, brown
  kDark,     ///< a tooth without a live pulp
  kGum,
  kMetal,  ///< cast crown
  kAmalgam,
  kCeramic,  ///< glazed
  kBlood,
  kFoam,  ///< rim of a bubble in saliva
};
inline constexpr std::size_t kMaterials = 11;
[[nodiscard]] constexpr std::size_t index_of(MaterialId id) { return static_cast<std::size_t>(id); }

/// A share of the light that goes inside: seen from straight above it comes back from `depth_mm` below the surface, the
/// pattern blurred by a Gaussian of `sigma_mm` along the surface. At a slant it comes from less deep: what enters and
/// what leaves keep their direction inside for a way of that length, not down to that depth.
struct Lobe {
  double weight = 0;    ///< relative to the other lobes
  double sigma_mm = 0;  ///< standard deviation along one axis
  double depth_mm = 0;  ///< below the surface, true; seen from air it looks shallower by the index
};
inline constexpr std::size_t kMaxLobes = 4;

/// Reflectance of a dielectric at normal incidence, from the index inside relative to outside.
[[nodiscard]] constexpr double mirror_of_index(double relative) {
  const double r = (relative - 1.0) / (relative + 1.0);
  return r * r;
}

struct Material {
  double albedo = 0.8;        ///< diffuse reflectance, inside and surface light together
  double surface_share = 1;   ///< of the diffuse light: scattered at the surface itself
  std::vector<Lobe> lobes{};  ///< of the rest; none: all of it is surface light
  double index = 1.5;         ///< of refraction
  double specular = 0;        ///< times the index's mirror reflectance; of a metal: its reflectance itself
  double roughness = 0.5;     ///< GGX alpha (Walter 2007)
  bool is_metal = false;

  [[nodiscard]] bool is_plain() const { return lobes.empty() && specular <= 0; }
  /// Reflectance at normal incidence under a medium of index `outside`.
  [[nodiscard]] double mirror(double outside) const {
    return is_metal ? specular : specular * mirror_of_index(index / outside);
  }
};
using MaterialTable = std::array<Material, kMaterials>;

/// Names of keys and truth files, by number.
inline constexpr std::array<std::string_view, kMaterials> kMaterialNames{
    "plaster", "enamel", "dentine", "stained", "dark", "gum", "metal", "amalgam", "ceramic", "blood", "foam"};

/// Published or derived values; sources beside the numbers.
[[nodiscard]] MaterialTable default_materials();

/// Widest spread of the table, mm.
[[nodiscard]] double widest_spread_mm(const MaterialTable& materials);

}  // namespace enamel::twin
