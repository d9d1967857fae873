// enamel calibrate ceramic: a tooth-like ceramic in an opaque frame tells how deep teeth look through this probe.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "calib/io/rig_writer.hpp"
#include "calib/judge/ceramic_tile.hpp"
#include "calib/model/measuring_rig.hpp"
#include "host/app/calibrate/set.hpp"
#include "host/app/calibrate/subcommand.hpp"
#include "host/record/burst_stream.hpp"
#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/stages/burst_view.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/progress.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

struct CeramicOptions {
  std::string capture, rig, out;
  bool json = false;
};

/// A burst with nothing taken off, and what enamel's law would take off.
class TileDecoder {
 public:
  [[nodiscard]] static Result<TileDecoder> make(calib::Rig rig) {
    rig.light_inside.reset();  // what an older calibration says of light inside is not asked
    pipeline::DecodeConfig as_it_is;
    as_it_is.translucency.correct = false;
    ENAMEL_TRY_ASSIGN(auto plain, pipeline::BurstDecoder::make(rig, as_it_is));
    ENAMEL_TRY_ASSIGN(auto enamel, pipeline::BurstDecoder::make(rig));
    return TileDecoder(std::move(plain), std::move(enamel), rig.camera.fx);
  }

  /// False: rejected, or not enough of the tile in view.
  bool add(const proto::Burst& burst, calib::CeramicTile& tile) {
    plain_.decode(stage::view_of(burst), workspace_, as_it_is_);
    enamel_.decode(stage::view_of(burst), workspace_, lifted_);
    if (!as_it_is_.accepted() || !lifted_.accepted()) return false;
    const Map<float>&far = as_it_is_.patch.depth_mm, &near = lifted_.patch.depth_mm;
    Map<float> enamel_mm(far.width(), far.height());
    double depth_mm = 0, count = 0;
    for (std::size_t i = 0; i < far.size(); ++i) {
      enamel_mm[i] = far[i] - near[i];
      if (std::isfinite(far[i])) depth_mm += static_cast<double>(far[i]), ++count;
    }
    return count > 0 && tile.add({as_it_is_.patch.points, enamel_mm, depth_mm / count / focal_px_});
  }

 private:
  TileDecoder(pipeline::BurstDecoder plain, pipeline::BurstDecoder enamel, double focal_px)
      : plain_(std::move(plain)), enamel_(std::move(enamel)), focal_px_(focal_px) {}

  pipeline::BurstDecoder plain_, enamel_;
  double focal_px_;
  pipeline::DecodeWorkspace workspace_;
  pipeline::DecodedBurst as_it_is_, lifted_;
};

struct TileBursts {
  calib::CeramicTile tile;
  int read = 0, used = 0;
};

Result<TileBursts> read_bursts(host::BurstStream& stream, TileDecoder& decoder) {
  TileBursts out;
  const SteadyClock clock;
  Progress progress(clock, "bursts of the tile", 0);
  for (;;) {
    ENAMEL_TRY_ASSIGN(const auto record, stream.next());
    if (!record) return out;
    const auto* burst = std::get_if<proto::Burst>(&record->value);
    if (burst == nullptr || !proto::is_consistent(*burst)) continue;
    ++out.read, out.used += decoder.add(*burst, out.tile) ? 1 : 0;
    progress.advance();
  }
}

Json tile_json(const CeramicOptions& o, const TileBursts& bursts, const calib::TileFit& fit) {
  return {{"out", o.out},
          {"bursts", bursts.read},
          {"used", bursts.used},
          {"of_enamel", fit.light.of_enamel},
          {"sigma", fit.light.sigma},
          {"ceramic_beyond_frame_um",
           {{"as_it_is", fit.before_um}, {"by_enamel", fit.by_enamel_um}, {"now", fit.after_um}}},
          {"frame_rms_um", fit.frame_um}};
}

void print_tile(const Json& json) {
  std::printf("%s: light inside by %d of %d bursts\n", json["out"].get<std::string>().c_str(), json["used"].get<int>(),
              json["bursts"].get<int>());
  std::printf("of what enamel's law takes off, over the picture (+- %.2f):\n", json["sigma"].get<double>());
  for (const auto& row : json["of_enamel"])
    std::printf("  %6.2f %6.2f %6.2f\n", row[0].get<double>(), row[1].get<double>(), row[2].get<double>());
  const auto& um = json["ceramic_beyond_frame_um"];
  std::printf(
      "ceramic beyond its frame, rms: %.1f um as it is, %.1f um by enamel's law, %.1f um now; the frame %.1f um\n",
      um["as_it_is"].get<double>(), um["by_enamel"].get<double>(), um["now"].get<double>(),
      json["frame_rms_um"].get<double>());
}

Result<int> run_ceramic(const CeramicOptions& o) {
  ENAMEL_TRY_ASSIGN(const calib::Rig rig, load_intact(o.rig));
  ENAMEL_TRY_ASSIGN(const auto stream, host::open_bursts(o.capture));
  if (stream->rig_text().empty()) return fail(ErrorCode::kRigMissing, o.capture);
  ENAMEL_TRY_ASSIGN(const calib::Rig recorded, calib::parse_rig(stream->rig_text()));
  ENAMEL_TRY_ASSIGN(calib::Rig optics, calib::measuring_rig(rig, recorded));
  ENAMEL_TRY_ASSIGN(auto decoder, TileDecoder::make(std::move(optics)));
  ENAMEL_TRY_ASSIGN(const TileBursts bursts, read_bursts(*stream, decoder));
  ENAMEL_TRY_ASSIGN(const calib::TileFit fit, bursts.tile.solve());
  ENAMEL_TRY_ASSIGN(const std::string text, calib::with_light_inside(rig, fit.light));
  ENAMEL_TRY(write_file(o.out, text));
  const Json json = tile_json(o, bursts, fit);
  o.json ? static_cast<void>(std::puts(json_text(json, 1).c_str())) : print_tile(json);
  return 0;
}

}  // namespace

CalibrateCommand add_calibrate_ceramic(CLI::App& app) {
  auto o = std::make_shared<CeramicOptions>();
  CLI::App* ceramic = app.add_subcommand("ceramic", "how deep teeth look: a tooth-like ceramic in an opaque frame");
  ceramic
      ->add_option("CAPTURE", o->capture, "recording or exchange folder: the tile at rest, in every part of the view")
      ->required();
  ceramic->add_option("--rig", o->rig, "the probe's solved rig.json")->required();
  ceramic->add_option("--out", o->out, "rig.json to write: the same with section light_inside")->required();
  ceramic->add_flag("--json", o->json, "one JSON object on stdout");
  return {ceramic, [o] { return run_ceramic(*o); }};
}

}  // namespace enamel::app
