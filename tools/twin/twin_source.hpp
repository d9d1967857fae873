// The twin as a source of bursts: a probe in a virtual mouth. SIMULATION ONLY.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/device/sim/burst_source.hpp"
#include "tools/twin/render/burst_renderer.hpp"
#include "tools/twin/scene/scene.hpp"

namespace enamel::twin {

/// What is known of a rendered burst.
struct BurstTruth {
  std::uint64_t burst_index = 0;
  std::int64_t t_mid_ns = 0;
  Pose T_model_cam = Pose::Identity();  ///< at t_mid_ns
  TruthMaps maps;
  struct Mover {
    std::size_t index;    ///< in SceneConfig::movers
    std::size_t seen_px;  ///< pixels whose middle shows it
  };
  std::vector<Mover> movers;  ///< that were there
};

/// Renders burst after burst, with as many threads as TBB's arena has; the images depend on scene, rig and seed only.
/// Not thread-safe itself.
class TwinSource final : public fw::BurstSource {
 public:
  /// Builds body, rig and path. Errors: those of the rig and of mesh files; kRigInvalid when the rig carries no noise;
  /// kPatternSet when its pattern set is not one of four frames; kConfigValue when the path leaves no burst to take.
  [[nodiscard]] static Result<std::unique_ptr<TwinSource>> create(const SceneConfig& config);
  [[nodiscard]] static Result<std::unique_ptr<TwinSource>> create(const SceneConfig& config, const calib::Rig& rig);
  ~TwinSource() override;
  TwinSource(const TwinSource&) = delete;
  TwinSource& operator=(const TwinSource&) = delete;

  [[nodiscard]] const std::string& rig_text() const override;
  [[nodiscard]] std::optional<std::uint64_t> count() const override;
  [[nodiscard]] Result<std::optional<fw::SimBurst>> next() override;

  /// Burst n as far as it is known before it is exposed: times and sizes, no frames.
  [[nodiscard]] fw::SimBurst planned(std::uint64_t n) const;
  /// The four frames of burst n as seen from these poses, whatever the path says, exposed `share` times as long as the
  /// scene says.
  [[nodiscard]] fw::SimFrames frames(std::uint64_t n, const BurstPoses& poses, double share = 1) const;

  /// Poses of burst n, whether rendered or not.
  [[nodiscard]] BurstPoses poses(std::uint64_t n) const;
  [[nodiscard]] std::int64_t t_mid_ns(std::uint64_t n) const;
  /// Of the burst that next() returned last.
  [[nodiscard]] const BurstTruth& truth() const;
  /// A burst that frames() made from there counts as seen, at rest; next() counts by itself.
  void count_seen(const Pose& T_model_cam);
  /// Truth so far: the whole surface and, a vertex, in how many bursts it was seen.
  [[nodiscard]] const TriSurface& surface() const;
  [[nodiscard]] std::span<const std::uint8_t> seen() const;
  [[nodiscard]] const std::string& scene_json() const;
  /// Of the known artefact (docs/registration.md); empty without one.
  [[nodiscard]] const std::string& certificate_json() const;
  [[nodiscard]] const calib::Rig& rig() const;

  /// Mean light of burst n, full-well fractions, without noise: for validation.
  [[nodiscard]] std::array<std::vector<float>, 4> mean_light(std::uint64_t n) const;

 private:
  struct Impl;
  explicit TwinSource(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// The twin of a scene file, as a probe's light source. `seed` overrides the scene's.
[[nodiscard]] Result<std::unique_ptr<fw::BurstSource>> open_twin_source(const std::string& scene_path,
                                                                        std::optional<std::uint64_t> seed);

}  // namespace enamel::twin
