#include "tests/bench/speed/recording.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <variant>

#include "host/record/burst_stream.hpp"
#include "host/session/burst_numbering.hpp"

namespace enamel::bench {
namespace {

/// The burst as number `n` at another time.
std::shared_ptr<const proto::Burst> at_time(const proto::Burst& burst, std::uint64_t n, std::uint64_t start_ns,
                                            bool marked) {
  auto out = std::make_shared<proto::Burst>(burst);
  const std::uint64_t shift_ns = start_ns - burst.t_first_exposure_ns;  // wraps: earlier is as good
  for (std::uint64_t* t : {&out->t_first_exposure_ns, &out->t_publish_ns}) *t += shift_ns;
  for (proto::FrameMeta& frame : out->meta) {
    for (std::uint64_t* t : {&frame.t_strobe_ns, &frame.t_sensor_ns, &frame.t_trig_rise_ns, &frame.t_trig_fall_ns})
      *t += shift_ns;
    if (marked && frame.offset < out->payload.size()) out->payload[frame.offset] ^= 1U;
  }
  out->burst_seq = out->burst_index = n;
  return out;
}

}  // namespace

Result<Recording> load_recording(const std::string& path, std::size_t most) {
  ENAMEL_TRY_ASSIGN(const auto stream, host::open_bursts(path));
  Recording out;
  out.name = std::filesystem::path(path).stem().string();
  ENAMEL_TRY_ASSIGN(out.rig, calib::parse_rig(stream->rig_text()));
  host::BurstNumbering numbering;
  while (most == 0 || out.bursts.size() < most) {
    ENAMEL_TRY_ASSIGN(auto record, stream->next());
    if (!record) break;
    auto* burst = std::get_if<proto::Burst>(&record->value);
    if (burst == nullptr || !proto::is_consistent(*burst)) continue;
    auto shared = std::make_shared<const proto::Burst>(std::move(*burst));
    const BurstId id = numbering.number(*shared);
    out.bursts.push_back({.id = id, .burst = std::move(shared)});
  }
  if (out.bursts.empty()) return fail(ErrorCode::kEmptyInput, path + ": no burst to measure");
  return out;
}

Recording there_and_back(const Recording& recording, std::size_t passes) {
  const std::size_t last = recording.bursts.size() - 1;
  const auto begun_ns = [&](std::size_t i) { return recording.bursts[i].burst->t_first_exposure_ns; };
  const std::uint64_t step_ns = last > 0 ? (begun_ns(last) - begun_ns(0)) / last : 0;
  Recording out{recording.name, recording.rig, {}};
  for (std::size_t pass = 0; pass < passes; ++pass) {
    for (std::size_t i = pass == 0 ? 0 : 1; i <= last; ++i) {
      const std::size_t from = pass % 2 == 0 ? i : last - i;
      const std::uint64_t n = out.bursts.size();
      out.bursts.push_back(
          {.id = BurstId{n},
           .burst = at_time(*recording.bursts[from].burst, n, begun_ns(0) + n * step_ns, pass % 2 == 1)});
    }
  }
  return out;
}

Result<host::ScanResult> run_scan(const Recording& recording, int workers, flow::StepObserver* observer) {
  SteadyClock clock;
  host::ScanPipelineOptions options;
  options.workers = workers;
  options.step_observer = observer;
  ENAMEL_TRY_ASSIGN(const auto pipeline, host::ScanPipeline::create(recording.rig, {}, options, clock));
  for (const host::Accepted& burst : recording.bursts) {
    if (!pipeline->push(burst)) break;
  }
  pipeline->finish();
  pipeline->wait_drained();
  ENAMEL_TRY(pipeline->join());
  return pipeline->take_result();
}

}  // namespace enamel::bench
