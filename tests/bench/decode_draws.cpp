// decode_draws: draws many bursts under random conditions, decodes them, and says by class of condition what became of
// them. --dump writes one of them as an exchange folder.
#include <fmt/format.h>

#include <atomic>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "protocol/base/file.hpp"
#include "tests/bench/draw_table.hpp"
#include "tests/bench/thread_time.hpp"
#include "tests/support/draw/folder.hpp"
#include "tests/support/plain_decoder.hpp"

namespace enamel::bench {
namespace {

constexpr const char* kUsage =
    "decode_draws [--mode M|T|both] [--count N] [--first-seed S] [--faults] [--scan N] [--threads N] [--json FILE]\n"
    "             [--worst K]      --scan N: each burst after N others of its unit, which are learned from\n"
    "decode_draws --mode M|T --dump SEED DIR\n";

struct Options {
  bool micro = true, polarity = true, faults = false;
  std::uint64_t count = 100, first_seed = 1, worst = 10, threads = 2, dump = 0, scan = 0;
  std::string json, dump_folder;
};

bool read_number(const char* text, std::uint64_t& out) {
  const std::string_view s(text);
  return std::from_chars(s.data(), s.data() + s.size(), out).ptr == s.data() + s.size();
}

std::optional<Options> read_options(const std::vector<const char*>& args) {
  Options o;
  for (std::size_t i = 0; i < args.size(); ++i) {
    const std::string name = args[i];
    const auto value = [&] { return i + 1 < args.size() ? args[++i] : ""; };
    if (name == "--faults") {
      o.faults = true;
    } else if (name == "--mode") {
      const std::string mode = value();
      o.micro = mode != "T", o.polarity = mode != "M";
      if (mode != "T" && mode != "M" && mode != "both") return std::nullopt;
    } else if (name == "--json") {
      o.json = value();
    } else if (name == "--dump") {
      if (!read_number(value(), o.dump)) return std::nullopt;
      o.dump_folder = value();
    } else {
      std::uint64_t* number = name == "--count"        ? &o.count
                              : name == "--first-seed" ? &o.first_seed
                              : name == "--worst"      ? &o.worst
                              : name == "--threads"    ? &o.threads
                              : name == "--scan"       ? &o.scan
                                                       : nullptr;
      if (number == nullptr || !read_number(value(), *number)) return std::nullopt;
    }
  }
  return o;
}

/// Memory of one thread.
struct Worker {
  pipeline::DecodeWorkspace workspace;
  pipeline::DecodedBurst decoded;
};

void try_faults(const pipeline::BurstDecoder& decoder, const test::DrawnBurst& burst, Worker& worker, DrawRow& row) {
  const test::Drawn& drawn = row.drawn;
  for (std::size_t k = 0; k < test::kFrameFaults; ++k) {
    const auto fault = static_cast<test::FrameFault>(k);
    const test::FaultedBurst bad = test::faulted(drawn, burst.frames, fault, drawn.seed);
    decoder.decode(bad.frames.view(), worker.workspace, worker.decoded);
    const test::Judged judged = test::judge(drawn, burst.truth, worker.decoded);
    row.faults.push_back({fault, bad.what, judged.verdict, judged.misled_share()});
  }
}

/// What a scan of the same unit would know after `bursts` of other scenes.
pipeline::WaveKnowledge scanned(const test::Drawn& drawn, const pipeline::BurstDecoder& decoder, std::uint64_t bursts,
                                Worker& worker) {
  constexpr std::uint64_t kSeedsApart = 1'000'003;
  pipeline::WaveKnowledge known;
  for (std::uint64_t k = 0; k < bursts; ++k) {
    const test::Drawn other = test::before_other_scene(drawn, drawn.seed * kSeedsApart + k);
    const test::DrawnBurst burst = test::render(other, {.with_truth = false});
    decoder.decode(burst.frames.view(), worker.workspace, worker.decoded, {{}, known});
    const auto& shown = worker.decoded.diagnostics.wave_shown;
    if (worker.decoded.accepted() && shown) pipeline::learn(*shown, known);
  }
  return known;
}

void run_draw(std::uint64_t seed, calib::PatternMode mode, const Options& o, Worker& worker, DrawRow& row) {
  test::ReadyDraw ready = test::ready_draw(seed, mode);
  row.drawn = ready.drawn, row.refused = std::move(ready.refused);
  if (!ready.decoder) return;
  row.decoded = true;
  const test::Drawn& drawn = row.drawn;
  const pipeline::BurstDecoder& decoder = *ready.decoder;
  const pipeline::WaveKnowledge known = scanned(drawn, decoder, o.scan, worker);
  const double start = thread_ms();
  const test::DrawnBurst burst = test::render(drawn);
  const double rendered = thread_ms();
  decoder.decode(burst.frames.view(), worker.workspace, worker.decoded, {{}, known});
  row.render_ms = rendered - start, row.decode_ms = thread_ms() - rendered;
  row.judged = test::judge(drawn, burst.truth, worker.decoded);
  const test::DepthTruth truth{burst.truth.depth_mm, burst.truth.lit, burst.truth.near_edge};
  row.beside = test::beside_plain(drawn.rig, truth, worker.decoded.patch.depth_mm,
                                  test::plain_decode(drawn.rig, burst.frames.view()));
  if (o.faults && row.judged.accepted() && row.judged.is_true_burst()) try_faults(decoder, burst, worker, row);
}

std::vector<DrawRow> run_draws(const Options& o) {
  std::vector<calib::PatternMode> modes;
  if (o.micro) modes.push_back(calib::PatternMode::kMicro);
  if (o.polarity) modes.push_back(calib::PatternMode::kPolarity);
  std::vector<DrawRow> rows(o.count * modes.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    Worker worker;
    for (std::size_t i = next++; i < rows.size(); i = next++)
      run_draw(o.first_seed + i / modes.size(), modes[i % modes.size()], o, worker, rows[i]);
  };
  std::vector<std::thread> threads;
  for (std::uint64_t k = 1; k < o.threads; ++k) threads.emplace_back(work);
  work();
  for (auto& thread : threads) thread.join();
  return rows;
}

int dump(const Options& o) {
  const test::ReadyDraw ready =
      test::ready_draw(o.dump, o.micro ? calib::PatternMode::kMicro : calib::PatternMode::kPolarity);
  const auto written = test::write_folder(ready.drawn, test::render(ready.drawn), o.dump_folder);
  if (!written) {
    fmt::print(stderr, "{}\n", written.error().message());
    return EXIT_FAILURE;
  }
  fmt::print("{}\n", test::describe(ready.drawn));
  return EXIT_SUCCESS;
}

int run(const Options& o) {
  if (!o.dump_folder.empty()) return dump(o);
  const std::vector<DrawRow> rows = run_draws(o);
  fmt::print("{}{}", draw_tables(rows), worst_draws(rows, o.worst));
  if (o.json.empty() || write_file(o.json, draws_json(rows))) return EXIT_SUCCESS;
  fmt::print(stderr, "{} cannot be written\n", o.json);
  return EXIT_FAILURE;
}

}  // namespace
}  // namespace enamel::bench

int main(int argc, char** argv) {
  const auto options = enamel::bench::read_options({argv + 1, argv + argc});
  if (options) return enamel::bench::run(*options);
  fmt::print(stderr, "{}", enamel::bench::kUsage);
  return EXIT_FAILURE;
}
