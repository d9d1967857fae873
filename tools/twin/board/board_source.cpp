#include "tools/twin/board/board_source.hpp"

#include <cmath>
#include <utility>

#include "tools/twin/board/nominal_rig.hpp"

namespace enamel::twin {

BoardSource::BoardSource(const SceneConfig& scene, std::unique_ptr<BoardStage> stage, std::string rig_text)
    : scene_(scene), stage_(std::move(stage)), rig_text_(std::move(rig_text)) {}

Result<std::unique_ptr<BoardSource>> BoardSource::create(const SceneConfig& scene) {
  ENAMEL_TRY_ASSIGN(auto stage, BoardStage::create(scene));
  ENAMEL_TRY_ASSIGN(std::string text, nominal_rig_text(stage->rig(), stage->patterns(), 1, scene.seed));
  return std::unique_ptr<BoardSource>(new BoardSource(scene, std::move(stage), std::move(text)));
}

std::optional<std::uint64_t> BoardSource::count() const {
  return stage_->stands().size() * static_cast<std::uint64_t>(stage_->patterns().sets()) *
         static_cast<std::uint64_t>(scene_.calibration.sweeps);
}

Result<std::optional<fw::SimBurst>> BoardSource::next() {
  if (next_ >= *count()) return std::optional<fw::SimBurst>();
  const std::uint64_t n = next_++;
  const auto sets = static_cast<std::uint64_t>(stage_->patterns().sets());
  const auto stand = static_cast<std::size_t>(n / (sets * static_cast<std::uint64_t>(scene_.calibration.sweeps)));
  if (traced_ != stand) {
    view_ = stage_->trace(stand);
    traced_ = stand;
  }
  fw::SimBurst burst;
  burst.burst_index = n;
  burst.pattern_set = static_cast<int>(n % sets);
  burst.exposure_us = static_cast<std::uint32_t>(std::lround(1e3 * scene_.timing.exposure_ms));
  burst.temp_c = scene_.temp_c;
  burst.width = stage_->rig().camera.width;
  burst.height = stage_->rig().camera.height;
  burst.bit_depth = stage_->sensor().bits;
  const auto light = stage_->electrons(view_, burst.pattern_set);
  for (int k = 0; k < 4; ++k) {
    const auto i = static_cast<std::size_t>(k);
    burst.t_exposure_ns[i] = exposure_start_ns(scene_.timing, n, k);
    burst.frames[i] = digitise(light[i], stage_->sensor(), {scene_.seed, n, k});
  }
  return std::optional<fw::SimBurst>(std::move(burst));
}

}  // namespace enamel::twin
