#include "host/session/wave_before.hpp"

#include <array>
#include <deque>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "host/session/burst_numbering.hpp"
#include "pipeline/decode/steps/frame_gates.hpp"
#include "pipeline/stages/burst_view.hpp"

namespace enamel::host {
namespace {

/// The next burst that a scan would get, nothing at the end. Records that cannot be read are counted elsewhere.
std::optional<proto::Burst> next_burst(BurstStream& stream) {
  while (true) {
    auto record = stream.next();
    if (!record) continue;
    if (!record->has_value()) return std::nullopt;
    auto* burst = std::get_if<proto::Burst>(&(*record)->value);
    if (burst != nullptr && proto::is_consistent(*burst)) return std::move(*burst);
  }
}

/// One decoder's way through the stream, with the views that a scan's source remembers.
class Learner {
 public:
  Learner(const pipeline::BurstDecoder& decoder, std::uint32_t calib_crc32)
      : decoder_(decoder), calib_crc32_(calib_crc32), known_(kWaveDelay) {}

  /// As the delay edge gives it to the next burst.
  [[nodiscard]] const pipeline::WaveKnowledge& for_next() const { return known_.front(); }
  /// Every burst under way was decoded when nothing more was to be learned.
  [[nodiscard]] bool has_settled() const { return settled_ >= kWaveDelay; }

  void take(proto::Burst burst) {
    pipeline::WaveKnowledge next = known_.back();
    const bool is_settled = pipeline::is_settled(for_next(), decoder_.config().wave);
    settled_ = is_settled ? settled_ + 1 : 0;
    if (!is_settled && tells(burst) && out_.accepted() && out_.diagnostics.wave_shown)
      pipeline::learn(*out_.diagnostics.wave_shown, next);
    known_.pop_front();
    known_.push_back(next);
    before_.push_back(std::move(burst));
    if (before_.size() > pipeline::kBurstsRemembered) before_.pop_front();
  }

 private:
  /// Whether it was decoded; bursts of another calibration are turned away before.
  bool tells(const proto::Burst& burst) {
    if (calib_crc32_ != 0 && burst.calib_crc32 != calib_crc32_) return false;
    std::vector<pipeline::BurstView> views;
    for (const proto::Burst& was : before_) views.push_back(stage::view_of(was));
    decoder_.decode(stage::view_of(burst), workspace_, out_, {views, for_next()});
    return true;
  }

  const pipeline::BurstDecoder& decoder_;
  std::uint32_t calib_crc32_;
  pipeline::DecodeWorkspace workspace_;
  pipeline::DecodedBurst out_;
  std::deque<proto::Burst> before_;
  std::deque<pipeline::WaveKnowledge> known_;  ///< the oldest is in force, the youngest is learned into
  std::size_t settled_ = 0;
};

}  // namespace

pipeline::WaveKnowledge wave_before(BurstStream& stream, BurstId burst, const pipeline::BurstDecoder& decoder,
                                    std::uint32_t calib_crc32, const std::function<void(std::uint64_t)>& on_burst) {
  stream.rewind();
  BurstNumbering numbering;
  Learner learner(decoder, calib_crc32);
  for (std::uint64_t place = 1; !learner.has_settled(); ++place) {
    auto next = next_burst(stream);
    if (!next || !(numbering.number(*next) < burst)) break;
    learner.take(std::move(*next));
    if (on_burst) on_burst(place);
  }
  return learner.for_next();
}

}  // namespace enamel::host
