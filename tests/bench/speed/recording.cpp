#include "tests/bench/speed/recording.hpp"

#include <filesystem>
#include <utility>
#include <variant>

#include "host/record/burst_stream.hpp"
#include "host/session/burst_numbering.hpp"

namespace enamel::bench {

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
