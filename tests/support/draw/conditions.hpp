// One burst's conditions, all drawn from one number: a unit (lenses, pose, pattern set, projector's response, sensor),
// a scene, its paint and its motion. Lengths mm, image places px, angles rad, times s unless a name says otherwise.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "calib/model/rig.hpp"

namespace enamel::test {

using Point3 = Eigen::Vector3d;

enum class ResponseKind : std::uint8_t { kBow, kGamma, kS };

/// What the projector emits of a level, 0 … 1; uncorrected, and unknown to the decoder.
struct Response {
  ResponseKind kind = ResponseKind::kBow;
  double gamma = 1;
  double bow = 0, skew = 0;       ///< kBow: peak of a second-order part and of a third-order one, share of full scale
  double s_share = 0, steep = 0;  ///< kS: share of the S in a mix with the gamma; logistic of this slope, 0: smoothstep
  double dark = 0.002;            ///< emission of level 0

  /// level: 0 … 255.
  [[nodiscard]] double emission(double level) const;
};

enum class SceneKind : std::uint8_t { kPlane, kBalls, kBoxes, kTeeth, kGum };

struct Balls {
  double left_radius_mm = 2, right_radius_mm = 2, distance_mm = 8, rod_radius_mm = 0.8;
};
/// Upright on the plane z = 0, turned about its own middle.
struct Box {
  double x_mm = 0, y_mm = 0, half_x_mm = 1, half_y_mm = 1, height_mm = 1, turn_rad = 0;
};
/// A superellipse of fourth order, raised above the gum.
struct DrawnTooth {
  double x_mm = 0, y_mm = 0, half_x_mm = 2, half_y_mm = 3, rise_mm = 3;
  double rounding = 0.3;  ///< share of the rise lost towards the outline
  double cusp_mm = 0;
  double flank = 0;  ///< share of the way out that the flank takes; 0: upright
};
struct SurfaceWave {
  double x_per_mm = 0, y_per_mm = 0, phase_rad = 0, height_mm = 0;
};

/// Scene coordinates: x along the camera's x, z towards the camera when the scene faces it.
struct SceneValues {
  SceneKind kind = SceneKind::kPlane;
  Eigen::Isometry3d T_cam_scene = Eigen::Isometry3d::Identity();  ///< at mid-burst
  Balls balls;
  std::vector<Box> boxes;
  std::vector<DrawnTooth> teeth;
  std::vector<SurfaceWave> waves;  ///< of the gum
};

/// Albedo over scene coordinates.
struct Paint {
  struct Mottle {
    Point3 per_mm = Point3::Zero();
    double phase_rad = 0, amount = 0;
  };
  struct Stripe {  ///< |normal . p - offset| < half width: albedo times factor, with a sharp edge
    Point3 normal = Point3::UnitX();
    double offset_mm = 0, half_width_mm = 0, factor = 1;
  };
  double albedo = 0.8;
  double gum_factor = 1;  ///< of what lies between teeth
  double haze = 0;        ///< share of the light that comes back without its pattern, as from translucent matter
  std::array<Mottle, 3> mottles;
  std::vector<Stripe> stripes;
};

/// Rigid, in the camera's frame.
struct DrawnMotion {
  Point3 velocity_mm_s = Point3::Zero(), turn_rad_s = Point3::Zero();
  Point3 pivot_mm = {0, 0, 48};

  [[nodiscard]] bool is_still() const { return velocity_mm_s.isZero(0) && turn_rad_s.isZero(0); }
  /// Where a point of mid-burst is `time_s` later.
  [[nodiscard]] Eigen::Isometry3d at(double time_s) const;
};

struct Optics {
  double blur_px = 0.7, blur_px_per_mm = 0.25, focus_mm = 49;  ///< projector's: sigma = hypot(first, second * defocus)
  double psf_px = 0.6;                                         ///< camera's sigma
  double exposure = 0.8;  ///< of full well: level 255 on albedo 0.8, facing at 44 mm
  double ambient = 0.01;  ///< of full well on albedo 1
  double prnu = 0;        ///< standard deviation of the pixels' gains
};

struct Drawn {
  std::uint64_t seed = 0;
  int attempt = 0;
  calib::Rig rig;
  Response response;
  SceneValues scene;
  Paint paint;
  DrawnMotion motion;
  Optics optics;
};

inline constexpr double kFrameInterval_s = 0.004004, kExposure_s = 0.0037;
inline constexpr int kScenes = 5, kResponseClasses = 5, kMotionBands = 4, kAlbedoBands = 3, kViewBands = 3;

/// mode: kPolarity or kMicro. attempt: drawn anew for a rig that a decoder refuses.
[[nodiscard]] Drawn draw(std::uint64_t seed, calib::PatternMode mode, int attempt = 0);
/// The same unit before another scene: that of `scene_seed`.
[[nodiscard]] Drawn before_other_scene(const Drawn& drawn, std::uint64_t scene_seed);

/// Classes by which bursts are counted: below each number of them, with its name.
[[nodiscard]] int response_class(const Drawn& drawn);
[[nodiscard]] int motion_band(const Drawn& drawn);
[[nodiscard]] int albedo_band(const Drawn& drawn);
/// By the fringes that the picture spans: a code needs some of them in view.
[[nodiscard]] int view_band(const Drawn& drawn);
inline constexpr std::array<std::string_view, kResponseClasses> kResponseNames = {"linear", "gamma 1-1.4",
                                                                                  "gamma 1.4-2", "gamma 2-2.8", "S"};
inline constexpr std::array<std::string_view, kScenes> kSceneNames = {"plane", "balls", "boxes", "teeth", "gum"};
inline constexpr std::array<std::string_view, kMotionBands> kMotionNames = {"static", "0-10 mm/s", "10-20 mm/s",
                                                                            "20-30 mm/s"};
inline constexpr std::array<std::string_view, kAlbedoBands> kAlbedoNames = {"albedo <0.2", "albedo 0.2-0.5",
                                                                            "albedo >0.5"};
inline constexpr std::array<std::string_view, kViewBands> kViewNames = {"<8 fringes", "8-14 fringes", ">14 fringes"};
/// One line for an engineer.
[[nodiscard]] std::string describe(const Drawn& drawn);

}  // namespace enamel::test
