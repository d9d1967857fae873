// A probe that is shown a calibration board: at every stand the whole pattern set, over and over. SIMULATION ONLY.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "firmware/device/sim/burst_source.hpp"
#include "tools/twin/board/board_stage.hpp"

namespace enamel::twin {

/// Burst n shows pattern set n mod sets at stand n / (sets * sweeps). The rig it states is nominal, of mode multi.
/// Images depend on scene, rig and seed only. Not thread-safe.
class BoardSource final : public fw::BurstSource {
 public:
  /// Errors: those of BoardStage.
  [[nodiscard]] static Result<std::unique_ptr<BoardSource>> create(const SceneConfig& scene);

  [[nodiscard]] const std::string& rig_text() const override { return rig_text_; }
  [[nodiscard]] std::optional<std::uint64_t> count() const override;
  [[nodiscard]] Result<std::optional<fw::SimBurst>> next() override;
  [[nodiscard]] const BoardStage& stage() const { return *stage_; }

 private:
  BoardSource(const SceneConfig& scene, std::unique_ptr<BoardStage> stage, std::string rig_text);

  SceneConfig scene_;
  std::unique_ptr<BoardStage> stage_;
  std::string rig_text_;
  std::uint64_t next_ = 0;
  std::optional<std::size_t> traced_;  ///< stand that view_ shows
  StillView view_;
};

}  // namespace enamel::twin
