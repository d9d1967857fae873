#include "host/app/calibrate/pose_feed.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "calib/model/rig.hpp"
#include "host/ingest/probe_facts.hpp"
#include "protocol/base/log.hpp"

namespace enamel::app {

namespace {

Map<float> image_of(const proto::Burst& burst, int k) {
  const auto bytes = proto::frame_bytes(burst, k);
  Map<float> image(burst.width, burst.height);
  const bool is_wide = burst.bit_depth > 8;
  for (std::size_t i = 0; i < image.size(); ++i) {
    image[i] = is_wide ? static_cast<float>(bytes[2 * i] + 256 * bytes[2 * i + 1]) : static_cast<float>(bytes[i]);
  }
  return image;
}

/// Photon transfer line of one frame, rounded by the converter.
calib::PixelNoise noise_of(const calib::NoiseValues& n) {
  const double read_dn = n.read_noise_e / n.gain_e_per_dn;
  return {read_dn * read_dn + 1.0 / 12, 1 / n.gain_e_per_dn};
}

Result<ProbeSeen> seen(const proto::DeviceInfo& info) {
  ENAMEL_TRY_ASSIGN(const std::string text, host::rig_text_of(info));
  ProbeSeen probe;
  ENAMEL_TRY_ASSIGN(probe.rig, calib::parse_rig(text));
  if (!probe.rig.noise) return fail(ErrorCode::kRigInvalid, "probe " + info.serial + " states no noise of its sensor");
  probe.noise = noise_of(*probe.rig.noise);
  probe.saturation_dn = std::exp2(probe.rig.noise->bits) - 1;
  probe.is_simulated = host::says_simulated(info);
  return probe;
}

}  // namespace

Result<std::unique_ptr<PoseFeed>> PoseFeed::create(const dds::Participant& participant, const PoseFeedConfig& config,
                                                   Clock& clock) {
  host::ProbeLinkConfig link_config;
  link_config.serial = config.serial;
  ENAMEL_TRY_ASSIGN(auto link, host::ProbeLink::create(participant, link_config, clock));
  host::FeedConfig feed;
  feed.session_id = host::new_session_id(clock);
  feed.find_timeout = Nanoseconds(static_cast<std::int64_t>(config.wait_seconds * 1e9));
  std::unique_ptr<PoseFeed> self(new PoseFeed(std::move(link), config, feed, clock));
  self->thread_ = std::jthread([raw = self.get()](const std::stop_token& stop) { raw->run(stop); });
  return self;
}

PoseFeed::PoseFeed(std::unique_ptr<host::ProbeLink> link, const PoseFeedConfig& config, const host::FeedConfig& feed,
                   Clock& clock)
    : config_(config), link_(std::move(link)), feed_(*link_, *this, feed, clock) {}

PoseFeed::~PoseFeed() { stop(); }

void PoseFeed::stop() {
  thread_.request_stop();
  link_->wake();
  if (thread_.joinable()) thread_.join();
}

void PoseFeed::run(const std::stop_token& stop) {
  if (const auto ran = feed_.run(stop); !ran && ran.error().code != ErrorCode::kCancelled) {
    const std::lock_guard lock(mutex_);
    error_ = ran.error();
  }
  ended_.store(true, std::memory_order_release);
}

Result<void> PoseFeed::on_probe(const proto::DeviceInfo& info, bool came_back) {
  ENAMEL_TRY_ASSIGN(ProbeSeen now, seen(info));
  ENAMEL_TRY_ASSIGN(calib::MultiSets sets, calib::multi_sets(now.rig));
  const std::lock_guard lock(mutex_);
  if (came_back && probe_ && probe_->rig.crc32 != now.rig.crc32)
    return fail(ErrorCode::kRigForeign, "probe " + info.serial + " came back with another calibration");
  gatherer_.emplace(std::move(sets), config_.sweeps, now.noise);
  probe_ = std::move(now);
  return {};
}

void PoseFeed::on_burst(dds::Received<proto::Burst> burst, HostTime) {
  const bool whole = burst.valid && proto::is_consistent(burst.value);
  if (!whole || !gatherer_) return;  // its set is missing from the sweep, which is then dropped
  temp_sum_c_ += burst.value.temp_centi_c / 100.0;
  ++bursts_;
  std::array<Map<float>, 4> frames;
  for (int k = 0; k < proto::kFramesPerBurst; ++k) frames[static_cast<std::size_t>(k)] = image_of(burst.value, k);
  const int before = gatherer_->sweeps_so_far();
  const calib::GatherEvent event = gatherer_->add(burst.value.pattern_set, frames);
  if (event == calib::GatherEvent::kNothing) return;
  PoseNews news;
  news.sweeps = before;
  if (event == calib::GatherEvent::kPose) news.frames = gatherer_->take();
  if (news_.push(std::move(news))) dropped_.fetch_add(1, std::memory_order_relaxed);
}

std::optional<double> PoseFeed::temp_c() const {
  if (bursts_ == 0) return std::nullopt;
  return temp_sum_c_ / static_cast<double>(bursts_);
}

std::optional<ProbeSeen> PoseFeed::probe() const {
  const std::lock_guard lock(mutex_);
  return probe_;
}

std::optional<Error> PoseFeed::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

}  // namespace enamel::app
