// The mixed metric with layered stop beside plain point to plane: how many starts drawn about the truth find it, on
// molars of plaster as two stops of a desktop mount see them. Prints a table; --json FILE writes it, too.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/register/icp/layered_icp.hpp"
#include "pipeline/register/icp/patch_view.hpp"
#include "protocol/base/file.hpp"
#include "tests/bench/study.hpp"
#include "tests/support/molar_pairs.hpp"

namespace enamel::bench {
namespace {

using pipeline::IcpResult;

struct StartError {
  double shift_mm = 0.3, turn_deg = 2;
};

struct Prepared {
  const pipeline::PatchPyramid& patch;
  const pipeline::Reference& reference;
  const pipeline::ViewCamera& camera;
};

struct Method {
  const char* name;
  std::function<IcpResult(const Prepared&, const Pose& start)> align;
};

Method layered(const char* name, const pipeline::LayeredConfig& config) {
  return {name, [config](const Prepared& p, const Pose& start) {
            return pipeline::align_layered(p.patch, p.reference, p.camera, start, config);
          }};
}

std::vector<Method> methods() {
  const pipeline::LayeredConfig mixed, published = pipeline::published_layers();
  pipeline::LayeredConfig on_ray = mixed, rim = mixed, to_the_end = mixed;
  on_ray.match.closest = false;
  rim.match.rim = true;
  to_the_end.layers.back().lambda = to_the_end.layers[1].lambda;
  return {layered("mixed metric", mixed),
          layered("plain point to plane", pipeline::plain_point_to_plane(mixed)),
          layered("mixed metric, published layers", published),
          layered("plain, published layers", pipeline::plain_point_to_plane(published)),
          {"the tracker's: projective, plain",
           [](const Prepared& p, const Pose& start) {
             return pipeline::align(p.patch, p.reference, p.camera, start, start, {});
           }},
          layered("mixed metric, matches on the ray", on_ray),
          layered("mixed metric, rim kept", rim),
          layered("mixed metric to the end, lambda 0.7", to_the_end)};
}

struct Tally {
  std::size_t starts = 0, found = 0, not_told = 0;  ///< not_told: off the truth, but no figure of the result says so
  int iterations = 0;
  double ms = 0;
  std::vector<double> shift_um, turn_deg;  ///< of those that found it

  void add(const IcpResult& r, const Pose& truth, double took_ms) {
    const test::PoseError e = test::pose_error(r.T_model_cam, truth);
    ++starts;
    iterations += r.iterations;
    ms += took_ms;
    if (r.converged && test::found_truth(e)) {
      ++found;
      shift_um.push_back(e.shift_um), turn_deg.push_back(e.turn_deg);
    } else if (r.converged && r.overlap >= 0.3 && r.consistency >= 0.9 && r.rms_mm < 0.03) {
      ++not_told;
    }
  }
  [[nodiscard]] Json json() const {
    const auto n = static_cast<double>(starts);
    return {{"starts", starts},
            {"found", found},
            {"found_pct", 100 * static_cast<double>(found) / n},
            {"not_told", not_told},
            {"shift_um_median", quantile(shift_um, 0.5)},
            {"shift_um_p95", quantile(shift_um, 0.95)},
            {"turn_deg_p95", quantile(turn_deg, 0.95)},
            {"iterations", iterations / n},
            {"ms", ms / n}};
  }
  static double quantile(std::vector<double> of, double q) {
    if (of.empty()) return NAN;
    std::sort(of.begin(), of.end());
    return of[static_cast<std::size_t>(q * static_cast<double>(of.size() - 1))];
  }
};

using Tallies = std::vector<std::vector<Tally>>;  ///< by start error, by method

/// All starts of one pair.
void measure(const test::MolarPair& pair, const calib::Rig& rig, const std::vector<StartError>& errors, int starts,
             Tallies& out) {
  const auto all = methods();
  const pipeline::LayeredConfig config;
  const pipeline::Reference reference(pipeline::view_from_patch(pair.reference, pair.T_jaw_reference, rig.camera),
                                      pipeline::ReferenceConfig{});
  const pipeline::PatchPyramid pyramid = pipeline::make_pyramid(pair.patch, config);
  const pipeline::ViewCamera camera(rig.camera);
  for (std::size_t e = 0; e < errors.size(); ++e) {
    for (int k = 0; k < starts; ++k) {
      const auto seed = static_cast<std::uint64_t>(out[e][0].starts);
      const Pose start = test::drawn_start(pair.T_jaw_patch, errors[e].shift_mm, errors[e].turn_deg, seed);
      for (std::size_t m = 0; m < all.size(); ++m) {
        const double begin = thread_ms();
        const IcpResult r = all[m].align({pyramid, reference, camera}, start);
        out[e][m].add(r, pair.T_jaw_patch, thread_ms() - begin);
      }
    }
  }
}

Json study(test::Molars kind, const char* name, const std::vector<StartError>& errors, int starts_a_pair) {
  const auto all = methods();
  Tallies tallies(errors.size(), std::vector<Tally>(all.size()));
  for (const std::uint64_t seed : {1ULL, 2ULL}) {
    const test::MolarTable table(std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/desktop_arch.toml", kind, seed);
    for (const int tooth : {6, 7}) {
      for (const double swing_deg : {-20.0, 0.0, 20.0}) {
        const auto pair = table.pair(tooth, swing_deg, seed);
        std::fprintf(stderr, "%s, seed %d, tooth %d, swing %+.0f: %zu and %zu px\n", name, static_cast<int>(seed),
                     tooth, swing_deg, pair.patch.valid_px, pair.reference.valid_px);
        measure(pair, table.rig(), errors, starts_a_pair, tallies);
      }
    }
  }
  Json rows = Json::array();
  for (std::size_t e = 0; e < errors.size(); ++e) {
    for (std::size_t m = 0; m < all.size(); ++m) {
      Json row = {{"molars", name},
                  {"start_mm", errors[e].shift_mm},
                  {"start_deg", errors[e].turn_deg},
                  {"method", all[m].name}};
      row.update(tallies[e][m].json());
      rows.push_back(row);
    }
  }
  return rows;
}

void print(const Json& rows) {
  std::printf(
      "| Molars | Start off by | Method | Found | Not told | Shift, median; 95 %% | Turn, 95 %% | Iterations | ms |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  for (const Json& r : rows) {
    std::printf("| %s | %.1f mm, %.0f deg | %s | %d of %d (%.1f %%) | %d | %.2f; %.2f um | %.4f deg | %.1f | %.0f |\n",
                r["molars"].get<std::string>().c_str(), r["start_mm"].get<double>(), r["start_deg"].get<double>(),
                r["method"].get<std::string>().c_str(), r["found"].get<int>(), r["starts"].get<int>(),
                r["found_pct"].get<double>(), r["not_told"].get<int>(), r["shift_um_median"].get<double>(),
                r["shift_um_p95"].get<double>(), r["turn_deg_p95"].get<double>(), r["iterations"].get<double>(),
                r["ms"].get<double>());
  }
}

}  // namespace
}  // namespace enamel::bench

int main(int argc, char** argv) {
  using namespace enamel::bench;
  int starts = 17;  // of each of twelve pairs: 204
  std::string json;
  for (int next = 1; next < argc; next += 2) {
    const std::string key = argv[next];
    if (next + 1 < argc && key == "--starts") starts = std::atoi(argv[next + 1]);
    if (next + 1 < argc && key == "--json") json = argv[next + 1];
    if (next + 1 < argc && starts > 0 && (key == "--starts" || key == "--json")) continue;
    std::fprintf(stderr, "usage: %s [--starts A_PAIR] [--json FILE]\n", argv[0]);
    return 1;
  }
  const std::vector<StartError> errors{{0.3, 2}, {1.0, 8}, {1.5, 12}};
  Json rows = study(enamel::test::Molars::kCusped, "cusped", errors, starts);
  for (const Json& row : study(enamel::test::Molars::kSmooth, "smooth", errors, starts)) rows.push_back(row);
  print(rows);
  if (json.empty()) return 0;
  const auto written = enamel::write_file(json, rows.dump(1) + "\n");
  if (!written) std::fprintf(stderr, "%s\n", written.error().message().c_str());
  return written ? 0 : 2;
}
