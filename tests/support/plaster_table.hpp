// A plaster model on the table of a desktop mount, drawn by seed, as stops see it: patches by rays instead of rendered
// bursts, and which parts of its surface which stops can show. Needs the twin.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "calib/model/mount.hpp"
#include "calib/model/rig.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::test {

enum class Plaster : std::uint8_t { kArch, kQuadrant };

/// The surface by samples of about equal area.
struct ShownSurface {
  std::vector<std::uint8_t> shown;  ///< a sample each
  std::vector<float> area_mm2;
  [[nodiscard]] double shown_mm2() const;
};

struct SurfaceSample {
  Vec3d point, normal;  ///< model frame, mm
};

/// Drawn: jaw, its place on the table (2 mm, 10 degrees), the mount's lines. A scene that cannot be read ends the
/// program. Not thread-safe.
class PlasterTable {
 public:
  PlasterTable(Plaster kind, std::uint64_t seed);
  ~PlasterTable();
  PlasterTable(const PlasterTable&) = delete;
  PlasterTable& operator=(const PlasterTable&) = delete;

  /// A quarter of the probe's pixels either way: planning looks no closer.
  [[nodiscard]] const calib::Rig& rig() const;
  /// As calibrated, without error.
  [[nodiscard]] const calib::Mount& mount() const;

  [[nodiscard]] SurfacePatch see(const calib::AxisAngles& angles) const;
  [[nodiscard]] ShownSurface surface() const;
  /// In ShownSurface's order.
  [[nodiscard]] const std::vector<SurfaceSample>& samples() const;
  /// Marks what a stop shows camera and projector at an incidence of max_incidence_deg or better.
  void show(const calib::AxisAngles& angles, double max_incidence_deg, ShownSurface& surface) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

[[nodiscard]] calib::AxisAngles stop_at(double rot_deg, double swing_deg);

/// What these stops show together.
[[nodiscard]] ShownSurface shown_by(const PlasterTable& table, const std::vector<calib::AxisAngles>& stops,
                                    double max_incidence_deg);
/// Share of goal's area that `shown` has, too.
[[nodiscard]] double share_of(const ShownSurface& shown, const ShownSurface& goal);
/// Every rotation of a turn with every swing.
[[nodiscard]] std::vector<calib::AxisAngles> stops_all_round(double rot_step_deg,
                                                             const std::vector<double>& swings_deg);

/// derived: the incidence at which sigma of depth has doubled, and the one up to which the decoder measures.
inline constexpr double kShownWell_deg = 65, kMeasured_deg = 75;

}  // namespace enamel::test
