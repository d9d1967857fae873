// Frames to surface patch. Keeps no state between bursts, so that several replicas may share the work: what earlier
// bursts tell comes through a delay edge.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/flow/stage.hpp"
#include "pipeline/stages/digest.hpp"
#include "pipeline/stages/items.hpp"

namespace enamel::stage {

class DecodeStage final : public flow::Stage {
 public:
  /// calib_crc32: of the rig in force; bursts that name another are rejected. 0: any.
  DecodeStage(const std::string& name, std::shared_ptr<const pipeline::BurstDecoder> decoder, std::uint32_t calib_crc32)
      : Stage(name), decoder_(std::move(decoder)), calib_crc32_(calib_crc32) {}

  flow::In<proto::Burst> burst{*this, "burst"};
  flow::In<pipeline::WaveKnowledge> wave{*this, "wave"};
  flow::Out<Decoded> patch{*this, "patch"};

  Result<void> step() override;

 private:
  std::shared_ptr<const pipeline::BurstDecoder> decoder_;
  std::uint32_t calib_crc32_;
  pipeline::DecodeWorkspace workspace_;
};

}  // namespace enamel::stage
