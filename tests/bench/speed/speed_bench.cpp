// bench_speed CAPTURE... [--bursts N] [--repeat R] [--json FILE] [--quick]: what each stage of the pipeline costs on
// recordings, and what its peers cost on the same bursts. --quick: one thread only, no peers, no rates.
#include <hwy/highway.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/version.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"
#include "tests/bench/speed/peers.hpp"
#include "tests/bench/speed/scan_cost.hpp"

namespace enamel::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::vector<std::string> captures;
  std::string json;
  int bursts = 0;  ///< of each recording, 0: all
  int repeat = 3;
  int passes = 1;  ///< there and back
  bool quick = false;
  bool help = false;
};

constexpr const char* kUsage =
    "usage: bench_speed CAPTURE... [--bursts N] [--repeat R] [--passes P] [--json FILE] [--quick]\n"
    "\n"
    "Instructions, core time and heap blocks a burst of every stage; the same of its peers. --quick: stages alone.\n"
    "--passes: plays the way there and back so often, and says what a stage takes at the end beside the beginning.\n";

bool parse_count(std::string_view text, int& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc() && end == text.data() + text.size() && out >= 1;
}

Result<Options> parse(const std::vector<std::string>& words) {
  Options o;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--help") {
      o.help = true;
    } else if (word == "--quick") {
      o.quick = true;
    } else if (word == "--bursts" || word == "--repeat" || word == "--passes" || word == "--json") {
      if (++i == words.size()) return fail(ErrorCode::kUsage, word + " needs a value");
      if (word == "--json") o.json = words[i];
      if (word == "--bursts" && !parse_count(words[i], o.bursts)) return fail(ErrorCode::kUsage, word + " N: N >= 1");
      if (word == "--passes" && !parse_count(words[i], o.passes)) return fail(ErrorCode::kUsage, word + " P: P >= 1");
      if (word == "--repeat" && !parse_count(words[i], o.repeat)) return fail(ErrorCode::kUsage, word + " R: R >= 1");
    } else if (word.starts_with("-")) {
      return fail(ErrorCode::kUsage, "unknown option " + word);
    } else {
      o.captures.push_back(word);
    }
  }
  if (o.captures.empty() && !o.help) return fail(ErrorCode::kUsage, "no recording named");
  return o;
}

/// What instructions depend on beside the source.
Json build_facts() {
#ifdef __clang__
  const std::string compiler = "clang " __clang_version__;
#else
  const std::string compiler = "gcc " __VERSION__;
#endif
  const std::int64_t targets = hwy::SupportedTargets();
  return {{"compiler", compiler}, {"simd", hwy::TargetName(targets & -targets)}, {"opencv", CV_VERSION}};
}

Json stage_json(const StageCost& c) {
  return {{"bursts", c.bursts},
          {"instructions", c.instructions},
          {"ms", {{"mean", c.mean_ms}, {"p50", c.p50_ms}, {"p99", c.p99_ms}}},
          {"heap", {{"blocks", c.blocks}, {"kib", c.kib}}},
          {"ageing", {{"instructions", c.ageing.instructions}, {"ms", c.ageing.ms}}}};
}

Json cost_json(const PeerCost& cost) { return {{"ms", cost.ms}, {"instructions", cost.instructions}}; }

Json peers_json(const Recording& recording, const std::vector<PlacedPatch>& patches, int repeat) {
  Json out;
  const proto::Burst& burst = *recording.bursts[recording.bursts.size() / 2].burst;
  constexpr int kTries = 20;  // of a fraction of a millisecond each
  if (burst.bit_depth == 8) out["phase_opencv"] = cost_json(phase_by_opencv(burst, kTries));
  out["copy"] = cost_json(copy_maps(burst, kTries));
  if (patches.size() < 2) return out;  // nothing was placed: the page says so
  const auto& lens = recording.rig.camera;
  const pipeline::FuseConfig fuse;
  const double truncation_mm = fuse.truncation_voxels * fuse.voxel_mm;
  const IcpLoopCost icp = icp_loop(lens, patches[0], patches[1], 3 * repeat);
  out["icp_loop"] = cost_json(icp.cost);
  out["icp_loop"].update(
      {{"points", icp.points}, {"rounds", icp.rounds}, {"pairs", icp.pairs}, {"apart_um", icp.apart_um}});
  const TsdfLoopCost tsdf = tsdf_loop(lens, patches, fuse.voxel_mm, truncation_mm, repeat);
  out["tsdf_loop"] = cost_json(tsdf.cost);
  out["tsdf_loop"].update({{"voxels", tsdf.voxels}, {"off_um", tsdf.off_um}});
  if (const auto hash = hash_tsdf(lens, patches, fuse.voxel_mm, truncation_mm, repeat)) {
    out["hash_tsdf"] = cost_json(*hash);
  }
  return out;
}

Result<Json> measure(const std::string& path, const Options& o) {
  ENAMEL_TRY_ASSIGN(Recording recording, load_recording(path, static_cast<std::size_t>(o.bursts)));
  if (o.passes > 1) recording = there_and_back(recording, static_cast<std::size_t>(o.passes));
  std::fprintf(stderr, "%s: %zu bursts, %d times on one thread ...\n", recording.name.c_str(), recording.bursts.size(),
               o.repeat);
  ENAMEL_TRY_ASSIGN(const ScanCost cost, measure_scan(recording, o.repeat));
  const proto::Burst& first = *recording.bursts.front().burst;
  Json out = {{"name", recording.name},
              {"mode", recording.rig.patterns.mode == calib::PatternMode::kMicro ? "M" : "T"},
              {"bursts", recording.bursts.size()},
              {"width", first.width},
              {"height", first.height},
              {"fused", cost.fused},
              {"rejected", cost.rejected},
              {"counter_problem", cost.counter_problem},
              {"rss_mib", {{"before", cost.rss_before_mib}, {"peak", cost.rss_peak_mib}}}};
  double core_ms = 0, instructions = 0;
  for (const auto& [name, stage] : cost.stages) {
    out["stages"][name] = stage_json(stage);
    const double share = static_cast<double>(stage.bursts) / static_cast<double>(recording.bursts.size());
    core_ms += share * stage.mean_ms;
    instructions += share * stage.instructions;
  }
  out["whole"] = {{"core_ms", core_ms}, {"instructions", instructions}};
  if (o.quick) return out;
  constexpr std::size_t kPatches = 8;
  ENAMEL_TRY_ASSIGN(const auto patches, placed_patches(recording, cost.poses, kPatches));
  out["peers"] = peers_json(recording, patches, o.repeat);
  for (const int workers : {1, 2}) {
    ENAMEL_TRY_ASSIGN(const double rate, scan_rate(recording, workers, std::max(1, o.repeat - 1)));
    out["whole"]["bursts_per_s"][std::to_string(workers)] = rate;
  }
  return out;
}

void print(const Json& recording) {
  std::printf("%s\n", recording["name"].get<std::string>().c_str());
  const auto problem = recording["counter_problem"].get<std::string>();
  if (!problem.empty()) std::printf("  %s\n", problem.c_str());
  for (const auto& [name, s] : recording["stages"].items()) {
    std::printf("  %-8s %9.3f M instructions  %8.3f ms  p99 %8.3f  %7.1f blocks %9.1f KiB\n", name.c_str(),
                1e-6 * s["instructions"].get<double>(), s["ms"]["mean"].get<double>(), s["ms"]["p99"].get<double>(),
                s["heap"]["blocks"].get<double>(), s["heap"]["kib"].get<double>());
    std::printf("  %-8s p99 of the end by the beginning's: %.3f of instructions, %.3f of time\n", "",
                s["ageing"]["instructions"].get<double>(), s["ageing"]["ms"].get<double>());
  }
  std::printf("  whole %s\n", recording["whole"].dump().c_str());
  if (recording.contains("peers")) std::printf("  peers %s\n", recording["peers"].dump().c_str());
}

Result<void> run(const Options& o) {
  cv::setNumThreads(1);
  log::set_level(log::Level::kError);
  Json out = {{"build", build_facts()}, {"repeat", o.repeat}, {"recordings", Json::array()}};
  for (const std::string& capture : o.captures) {
    ENAMEL_TRY_ASSIGN(Json measured, measure(capture, o));
    print(measured);
    out["recordings"].push_back(std::move(measured));
  }
  return o.json.empty() ? Result<void>{} : write_file(o.json, out.dump(1) + "\n");
}

}  // namespace
}  // namespace enamel::bench

int main(int argc, char** argv) {
  const auto options = enamel::bench::parse({argv + 1, argv + argc});
  if (!options) {
    std::fprintf(stderr, "%s\n%s", options.error().message().c_str(), enamel::bench::kUsage);
    return enamel::exit_code(options.error().code);
  }
  if (options->help) {
    std::fputs(enamel::bench::kUsage, stdout);
    return 0;
  }
  const auto done = enamel::bench::run(*options);
  if (done) return 0;
  std::fprintf(stderr, "%s\n", done.error().message().c_str());
  return enamel::exit_code(done.error().code);
}
