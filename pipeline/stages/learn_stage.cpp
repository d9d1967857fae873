#include "pipeline/stages/learn_stage.hpp"

namespace enamel::stage {

Result<void> LearnStage::step() {
  const auto item = decoded.take();
  if (item.ok() && item->wave_shown) pipeline::learn(*item->wave_shown, wave_);
  flow::ItemHead head = item;
  head.rejected = nullptr;
  known.emit(flow::make_item<pipeline::WaveKnowledge>(head, wave_));
  return {};
}

}  // namespace enamel::stage
