// bench_study [--bursts N] [--only PART]... OUT: measures what the decode page shows beside times of whole bursts,
// writes OUT/study.json and maps. N: random rows of teeth whose orders are counted.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <set>
#include <string>

#include "pipeline/decode/decode_maps.hpp"
#include "pipeline/decode/mode_t/polarity.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "protocol/base/file.hpp"
#include "tests/bench/study.hpp"
#include "tests/support/blocks_scene.hpp"
#include "tests/support/fold_error.hpp"
#include "tests/support/gamma_scene.hpp"
#include "tests/support/plaster_eye.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::bench {
namespace {

/// rms of (phase - truth)/sigma over all valid pixels.
double normalised_rms(const pipeline::PhaseMaps& maps, const Map<double>& truth) {
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (maps.reject[i] != pipeline::PixelReject::kNone) continue;
    const double e = test::wrap_pi(static_cast<double>(maps.phase_rad[i]) - truth[i]);
    sum += std::pow(e / static_cast<double>(maps.sigma_rad[i]), 2);
    n += 1;
  }
  return std::sqrt(sum / n);
}

Json error_json(const test::FoldedError& e) {
  return {{"rms_rad", e.rms_rad}, {"repeating_rad", e.repeating_rad}, {"constant_rad", e.mean_rad}};
}

}  // namespace

void save(const std::string& path, const Map<float>& map) {
  if (const auto written = write_file(path, pipeline::pfm_bytes(map)); !written) {
    std::fprintf(stderr, "%s\n", written.error().message().c_str());
    std::exit(exit_code(written.error().code));
  }
}

Json noise_study() {
  calib::Rig rig = test::cropped_rig(320, 240);
  rig.patterns.mode = calib::PatternMode::kPlain4;
  rig.patterns.polarity_code.clear();
  Json rows = Json::array();
  for (const double modulation_dn : {5.0, 10.0, 20.0, 50.0, 100.0}) {
    test::SceneOptions o;
    o.noise = true;
    o.modulation_dn = modulation_dn;
    o.mean_dn = 1.25 * modulation_dn + 3;
    const auto scene = test::render(rig, test::flat(48), o);
    const pipeline::NoiseModel noise = pipeline::noise_from_rig(*rig.noise, 8);
    pipeline::PhaseMaps maps;
    pipeline::compute_phase(scene.frames.view(), noise, {}, maps);
    const double three = normalised_rms(maps, scene.phase_rad);
    std::vector<pipeline::CellSpan> spans;
    spans.reserve(240);
    for (int v = 0; v < 240; ++v) spans.push_back({v, 0, 320, 0, false});
    pipeline::PolarityMaps polarity;
    pipeline::apply_polarity(spans, {std::vector<float>(8, 1.0F), false}, noise, {}, maps, polarity);
    rows.push_back({{"modulation_dn", modulation_dn},
                    {"three_frames", three},
                    {"four_frames", normalised_rms(maps, scene.phase_rad)}});
  }
  return rows;
}

Json ripple_study() {
  Json rows = Json::array();
  for (const double gamma : {1.3, 1.5, 1.8, 2.2, 2.5, 2.8}) {
    const auto one = test::measure_gamma({.gamma = gamma, .noise = 0.02}, 1);
    const auto clean = test::measure_gamma({.gamma = gamma}, 1);
    const auto ten = test::measure_gamma({.gamma = gamma, .noise = 0.02}, 10);
    rows.push_back({{"gamma", gamma},
                    {"three_step", ten.three_step},
                    {"double_three_step", ten.double_three_step},
                    {"four_step", ten.four_step},
                    {"one_term", ten.one_term},
                    {"ours_10_bursts", ten.levelled},
                    {"four_step_1_burst", one.four_step},
                    {"ours_1_burst", one.levelled},
                    {"one_term_noise_free", clean.one_term},
                    {"ours_noise_free", clean.levelled}});
  }
  return rows;
}

Json baked_study() {
  const calib::Rig rig = calib::parse_rig(test::kRigText).value();
  const pipeline::RayDepth rays = pipeline::RayDepth::bake(rig, *rig.depth_range).value();
  double worst_um = 0;
  std::size_t points = 0;
  for (int v = 0; v < 480; v += 9) {
    for (int u = 0; u < 640; u += 9) {
      const std::size_t i = static_cast<std::size_t>(v) * 640 + static_cast<std::size_t>(u);
      const calib::PlanePoint ray = calib::undistort(rig.camera, {static_cast<double>(u), static_cast<double>(v)});
      for (int s = 0; s <= 16; ++s) {
        const float share = static_cast<float>(s) / 16;
        const float phase = rays.phase_near_rad[i] * (1 - share) + rays.phase_far_rad[i] * share;
        const auto exact = pipeline::depth_by_iteration(rig, ray, static_cast<double>(phase), 48);
        const double baked = 1 / static_cast<double>(rays.inverse_depth(i, phase));
        worst_um = std::max(worst_um, exact ? 1e3 * std::abs(baked - *exact) : 1e9);
        ++points;
      }
    }
  }
  return {{"worst_um", worst_um}, {"points", points}};
}

Json captured_study(const std::string& folder) {
  const std::string fringe = test::shared_folder() + "/data/fringe";
  Json out;
  const auto set = test::load_plaster(fringe + "/plaster_eye_12step_gray");
  if (set) {
    for (std::size_t burst = 0; burst < 3; ++burst) {
      const auto f = test::measure_plaster(*set, burst).value();
      out["plaster_eye"].push_back({{"burst", burst},
                                    {"raw", error_json(f.raw)},
                                    {"one_term", error_json(f.fourth)},
                                    {"four_terms", error_json(f.levelled)},
                                    {"ours", error_json(f.full)},
                                    {"ours_against_raw", error_json(f.full_raw)},
                                    {"offset_cos", f.frames.offset_cos},
                                    {"offset_sin", f.frames.offset_sin},
                                    {"squeeze", f.frames.squeeze},
                                    {"shear", f.frames.shear},
                                    {"reference_px", f.reference_px},
                                    {"solved_px", f.solved_px},
                                    {"orders_equal_pct", 100 * f.orders_equal},
                                    {"orders_equal_literal_pct", 100 * f.orders_equal_literal},
                                    {"near_mm", f.near_mm},
                                    {"far_mm", f.far_mm},
                                    {"raw_curve_rad", f.raw_curve},
                                    {"curve_rad", f.full_curve}});
      if (burst != 0) continue;
      Map<float> order(f.order.width(), f.order.height());
      for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = f.order[i] < 0 ? std::nanf("") : static_cast<float>(f.order[i]);
      save(folder + "/plaster_modulation.pfm", f.modulation_dn);
      save(folder + "/plaster_order.pfm", order);
      save(folder + "/plaster_depth.pfm", f.depth_mm);
      save(folder + "/plaster_error.pfm", f.error_rad);
    }
  } else {
    std::fprintf(stderr, "captured fringes skipped: %s\n", set.error().message().c_str());
  }
  if (const auto f = test::measure_blocks(fringe + "/blocks_3step_2freq_gray")) {
    out["blocks"] = {{"lit_px", f->lit_px},
                     {"solved_px", f->solved_px},
                     {"orders_equal_pct", 100 * f->orders_equal},
                     {"links_torn_pct", 100 * f->links_torn},
                     {"ripple_before_rad", f->ripple_before},
                     {"ripple_after_rad", f->ripple_after}};
  }
  return out;
}

}  // namespace enamel::bench

int main(int argc, char** argv) {
  using namespace enamel::bench;
  int bursts = 500, next = 1;
  std::set<std::string> only;
  for (; next + 1 < argc && argv[next][0] == '-'; next += 2) {
    if (std::string(argv[next]) == "--bursts") bursts = std::atoi(argv[next + 1]);
    if (std::string(argv[next]) == "--only") only.insert(argv[next + 1]);
  }
  if (next + 1 != argc || argv[next][0] == '-' || bursts < 1) {
    std::fprintf(stderr, "usage: %s [--bursts N] [--only PART]... OUT_FOLDER\n", argv[0]);
    return 1;
  }
  const std::string folder = argv[next];
  std::error_code ec;
  std::filesystem::create_directories(folder, ec);
  Json out;
  const auto part = [&](const char* name, auto study) {
    if (!only.empty() && only.count(name) == 0) return;
    std::fprintf(stderr, "study: %s ...\n", name);
    out[name] = study();
  };
  part("phase_noise", noise_study);
  part("gamma_ripple", ripple_study);
  part("triangulation", baked_study);
  part("unwrapping", [&] { return unwrap_study(folder); });
  part("modes", modes_study);
  part("orders", [&] { return orders_study(bursts); });
  part("twin", twin_study);
  part("captured", [&] { return captured_study(folder); });
  if (const auto written = enamel::write_file(folder + "/study.json", out.dump(1) + "\n"); !written) {
    std::fprintf(stderr, "%s\n", written.error().message().c_str());
    return enamel::exit_code(written.error().code);
  }
  return 0;
}
