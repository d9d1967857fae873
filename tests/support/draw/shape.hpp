// The surfaces of drawn scenes as rays meet them. Scene coordinates, mm.
#pragma once

#include <limits>
#include <memory>

#include "tests/support/draw/conditions.hpp"

namespace enamel::test {

struct SceneRay {
  Point3 origin, direction;  ///< direction of any length
};

struct SceneHit {
  double at = std::numeric_limits<double>::infinity();  ///< in lengths of the ray's direction; infinite: none
  Point3 normal = Point3::UnitZ();                      ///< unit, outwards
  int face = 0;  ///< neighbours of one face and of near depth lie on one smooth surface
  bool gum = false;
};

class SceneShape {
 public:
  SceneShape() = default;
  SceneShape(const SceneShape&) = delete;
  SceneShape& operator=(const SceneShape&) = delete;
  virtual ~SceneShape() = default;

  /// The first surface that the ray meets.
  [[nodiscard]] virtual SceneHit hit(const SceneRay& ray) const = 0;
  /// Whether anything lies between the hit point `from` and the light.
  [[nodiscard]] virtual bool blocks(const Point3& from, const SceneHit& hit, const Point3& light) const = 0;
};

[[nodiscard]] std::unique_ptr<const SceneShape> make_shape(const SceneValues& scene);
/// Teeth and gum, as heights on a grid.
[[nodiscard]] std::unique_ptr<const SceneShape> make_height_shape(const SceneValues& scene);

}  // namespace enamel::test
