// enamel decode: one burst, every intermediate map.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/pattern.hpp"
#include "host/app/calibration.hpp"
#include "host/app/command.hpp"
#include "host/app/input.hpp"
#include "host/app/run_options.hpp"
#include "host/record/burst_stream.hpp"
#include "host/session/wave_before.hpp"
#include "pipeline/decode/decode_maps.hpp"
#include "pipeline/decode/steps/frame_gates.hpp"
#include "pipeline/stages/burst_view.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/progress.hpp"

namespace enamel::app {

namespace {

struct DecodeOptions {
  RunOptions run;
  std::string input, rig;
  std::uint64_t burst = 0;
};

/// Without those that were lost or are damaged: they only tell whether a frame was left over from them.
std::vector<proto::Burst> bursts_before(host::BurstStream& stream, std::uint64_t burst) {
  std::vector<proto::Burst> out;
  for (std::uint64_t back = std::min<std::uint64_t>(burst, pipeline::kBurstsRemembered); back > 0; --back) {
    auto before = stream.burst_with_id({burst - back});
    if (before && proto::is_consistent(*before)) out.push_back(std::move(*before));
  }
  return out;
}

/// As a scan would have by then. Told when it takes longer than a moment.
pipeline::WaveKnowledge learned_before(std::uint64_t burst, const pipeline::BurstDecoder& decoder,
                                       std::uint32_t calib_crc32, host::BurstStream& stream, const Clock& clock) {
  const HostTime start = clock.now();
  std::optional<Progress> progress;
  return host::wave_before(stream, {burst}, decoder, calib_crc32, [&](std::uint64_t place) {
    if (!progress && clock.now() - start > std::chrono::seconds(1))
      progress.emplace(clock, "learning the projector's waveform from the bursts before", burst);
    if (progress) progress->update(place);
  });
}

Result<int> run_decode(const DecodeOptions& o) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const LoadedConfig config, load_config(o.run));
  ENAMEL_TRY_ASSIGN(const auto stream, host::open_bursts(o.input));
  ENAMEL_TRY_ASSIGN(const Calibration calibration, calibration_for(o.rig, *stream, o.input));
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, rig_to_measure(calibration, *stream));
  for (const std::string& key : rig.unknown_keys) log::info("rig", "unknown key '{}' kept and ignored", key);
  ENAMEL_TRY_ASSIGN(const proto::Burst burst, stream->burst_with_id({o.burst}));
  if (!proto::is_consistent(burst)) return fail(ErrorCode::kCaptureCorrupt, "burst " + std::to_string(o.burst));
  if (burst.width != rig.camera.width || burst.height != rig.camera.height) {
    return fail(ErrorCode::kRigInvalid,
                fmt::format("its camera is {} x {} px, the frames of burst {} are {} x {}", rig.camera.width,
                            rig.camera.height, o.burst, burst.width, burst.height));
  }
  const std::vector<proto::Burst> before = bursts_before(*stream, o.burst);
  ENAMEL_TRY_ASSIGN(const auto decoder, pipeline::BurstDecoder::make(calib::rig_at(rig, burst.temp_centi_c / 100.0),
                                                                     config.pipeline.decode));

  const std::uint32_t calib_crc32 = o.rig.empty() ? rig.crc32 : 0;
  const pipeline::WaveKnowledge wave = learned_before(o.burst, decoder, calib_crc32, *stream, clock);

  pipeline::DecodeReport report{
      .burst = o.burst, .mode = calib::mode_name(rig.patterns), .figures = {}, .stage_ms = {}};
  pipeline::DecodeWorkspace workspace;
  HostTime last = clock.now();
  workspace.on_step = [&](const char* step) {
    const HostTime now = clock.now();
    report.stage_ms.emplace_back(step, std::chrono::duration<double, std::milli>(now - last).count());
    last = now;
  };
  pipeline::DecodedBurst decoded;
  std::vector<pipeline::BurstView> views;
  for (const proto::Burst& was : before) views.push_back(stage::view_of(was));
  decoder.decode(stage::view_of(burst), workspace, decoded, {views, wave});
  report.figures = decoder.figures(decoded.diagnostics);
  ENAMEL_TRY(pipeline::write_decode_maps(decoded, report, o.run.out));
  std::fputs(pipeline::decode_json(decoded, report).c_str(), stdout);
  if (decoded.accepted()) return 0;
  std::fprintf(stderr, "burst %llu is rejected: %s; its maps were written as far as they go\n",
               static_cast<unsigned long long>(o.burst), std::string(pipeline::name_of(decoded.verdict)).c_str());
  return exit_code(ErrorCode::kQualityGate);
}

/// CLI11 would take -1 for the largest number and nothing for 0.
CLI::Validator whole_number() {
  const auto check = [](const std::string& text) {
    const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
    return digits ? std::string() : "'" + text + "' is no burst number: a whole number from 0";
  };
  return {check, "", "burst number"};
}

}  // namespace

Run add_decode(CLI::App& app) {
  auto o = std::make_shared<DecodeOptions>();
  app.add_option("CAPTURE", o->input, "recording or exchange folder")->required();
  app.add_option("--burst", o->burst, "number of the burst")->required()->check(whole_number());
  app.add_option("--out", o->run.out, "folder for the maps")->required();
  app.add_option("--rig", o->rig, "another calibration than the recorded one");
  app.add_option("--config", o->run.config_file, "configuration (TOML)");
  app.add_option("--set", o->run.settings, "stage.key=value")->allow_extra_args(false);
  app.add_flag("--json", o->run.json, "decode.json on stdout (always so)");
  return [o]() -> Result<int> { return run_decode(*o); };
}

}  // namespace enamel::app
