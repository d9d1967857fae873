// A scan learns its projector's waveform: the same bits however many workers share it, and what decodes one burst by
// itself knows as much as the scan did.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "host/session/scan_pipeline.hpp"
#include "host/session/wave_before.hpp"
#include "pipeline/stages/burst_view.hpp"
#include "pipeline/stages/digest.hpp"
#include "tests/support/draw/ready.hpp"
#include "tests/support/draw/render.hpp"
#include "tests/unit/host/bare_stream.hpp"
#include "tests/unit/protocol/random_messages.hpp"

namespace enamel::host {
namespace {

constexpr std::uint64_t kBursts = 12;

/// One unit of weak gamma over one slow scene, burst after burst: h_2 of 0.056, which a burst alone leaves alone.
class Scan {
 public:
  Scan() {
    test::Drawn drawn = test::ready_draw(700, calib::PatternMode::kMicro).drawn;
    drawn.motion.velocity_mm_s = {1, 0.5, 0}, drawn.motion.turn_rad_s.setZero();
    rig = drawn.rig;
    for (std::uint64_t k = 0; k < kBursts; ++k) {
      const test::Shot shot{.later_s = 0.03 * static_cast<double>(k), .noise = k, .with_truth = false};
      proto::Burst burst = test::camera_burst(k, rig.camera.width, rig.camera.height);
      // Exposed alike, as a probe exposes a burst.
      for (proto::FrameMeta& frame : burst.meta) frame.analogue_gain_q8 = burst.meta[0].analogue_gain_q8;
      burst.payload.clear();
      for (const auto& frame : test::render(drawn, shot).frames.frames)
        burst.payload.insert(burst.payload.end(), frame.begin(), frame.end());
      burst.payload_crc32 = crc32(std::as_bytes(std::span(burst.payload)));
      bursts.push_back(std::move(burst));
    }
  }
  calib::Rig rig;
  std::vector<proto::Burst> bursts;
};

const Scan& scan() {
  static const Scan made;
  return made;
}

class ScanStream final : public test::BareStream {
 public:
  [[nodiscard]] Result<std::optional<capture::Record>> next() override {
    if (next_ == kBursts) return std::optional<capture::Record>();
    return std::optional(capture::Record{.value = scan().bursts[next_++]});
  }
  void rewind() noexcept override { next_ = 0; }

 private:
  std::size_t next_ = 0;
};

std::vector<TraceRow> traced(int workers) {
  SteadyClock clock;
  auto pipeline = ScanPipeline::create(scan().rig, {}, {.workers = workers}, clock).value();
  for (const proto::Burst& burst : scan().bursts)
    pipeline->push({burst.id(), std::make_shared<const proto::Burst>(burst), std::nullopt});
  pipeline->finish();
  pipeline->wait_drained();
  EXPECT_TRUE(pipeline->join());
  return pipeline->take_result().trace.rows();
}

/// As DecodeStage makes it.
std::uint64_t decode_digest(const pipeline::BurstDecoder& decoder, std::uint64_t k,
                            const pipeline::WaveKnowledge& wave) {
  pipeline::DecodeWorkspace workspace;
  pipeline::DecodedBurst out;
  decoder.decode(stage::view_of(scan().bursts[k]), workspace, out, {{}, wave});
  return stage::Digest().add(out.patch.depth_mm).add(out.patch.sigma_mm).add(out.patch.texture_dn).value();
}

TEST(WaveScan, gives_the_same_bits_at_any_worker_count) {
  const std::vector<TraceRow> one = traced(0);
  ASSERT_EQ(one.size(), kBursts);
  for (const int workers : {1, 2, 4, 6}) {  // two decoders, and four
    const std::vector<TraceRow> more = traced(workers);
    ASSERT_EQ(more.size(), kBursts);
    for (std::size_t k = 0; k < kBursts; ++k) EXPECT_EQ(more[k].digest, one[k].digest) << workers << ' ' << k;
  }
}

TEST(WaveScan, burst_decoded_by_itself_is_the_scans) {
  const auto decoder = pipeline::BurstDecoder::make(scan().rig).value();
  const std::vector<TraceRow> rows = traced(2);
  std::size_t taught = 0;
  for (std::uint64_t k = 0; k < kBursts; ++k) {
    ASSERT_EQ(rows[k].verdict, "fused") << k;
    ScanStream stream;
    EXPECT_EQ(decode_digest(decoder, k, wave_before(stream, {k}, decoder, 0, {})), rows[k].digest[1]) << k;
    if (decode_digest(decoder, k, {}) != rows[k].digest[1]) ++taught;
  }
  EXPECT_GE(taught, kBursts - 2 * kWaveDelay) << "negative control: what was learned changes what is decoded";
}

TEST(WaveScan, nothing_is_learned_from_bursts_of_another_calibration) {
  const auto decoder = pipeline::BurstDecoder::make(scan().rig).value();
  ScanStream stream;
  EXPECT_EQ(wave_before(stream, {kBursts}, decoder, scan().bursts[0].calib_crc32 ^ 1U, {}).bursts, 0U);
  EXPECT_GT(wave_before(stream, {kBursts}, decoder, 0, {}).bursts, 0U) << "negative control";
}

TEST(WaveScan, bursts_before_are_counted_as_they_are_decoded) {
  const auto decoder = pipeline::BurstDecoder::make(scan().rig).value();
  ScanStream stream;
  std::vector<std::uint64_t> places;
  const auto known = wave_before(stream, {5}, decoder, 0, [&](std::uint64_t place) { places.push_back(place); });
  EXPECT_EQ(places, (std::vector<std::uint64_t>{1, 2, 3, 4, 5}));
  EXPECT_EQ(known.bursts, 5 - kWaveDelay + 1) << "of bursts 0 and 1";
}

TEST(Workers, are_as_many_as_the_machine_has_use_for) {
  EXPECT_EQ(usual_workers(0), 2) << "unknown";
  EXPECT_EQ(usual_workers(1), 2);
  EXPECT_EQ(usual_workers(4), 4);
  EXPECT_EQ(usual_workers(64), 6) << "four decoders, registration, fusion";
}

}  // namespace
}  // namespace enamel::host
