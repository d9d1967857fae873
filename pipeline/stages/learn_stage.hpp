// The projector's waveform over a scan: what every decoded burst shows of it goes in, what is known by then comes out.
#pragma once

#include "pipeline/flow/stage.hpp"
#include "pipeline/stages/items.hpp"

namespace enamel::stage {

class LearnStage final : public flow::Stage {
 public:
  LearnStage() : Stage("learn") {}

  flow::In<Decoded> decoded{*this, "decoded"};
  flow::Out<pipeline::WaveKnowledge> known{*this, "known"};

  /// What is known is wanted after every burst.
  [[nodiscard]] bool handles_rejected() const noexcept override { return true; }
  Result<void> step() override;

 private:
  pipeline::WaveKnowledge wave_;
};

}  // namespace enamel::stage
