#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "pipeline/decode/mode_t/polarity.hpp"
#include "pipeline/decode/unwrap/flood.hpp"
#include "pipeline/decode/unwrap/least_cuts.hpp"
#include "tests/bench/study.hpp"
#include "tests/support/crown_scene.hpp"
#include "tests/unit/decode/synthetic.hpp"
#ifdef ENAMEL_PHASE_UNWRAPPING
#include <opencv2/phase_unwrapping.hpp>
#endif

namespace enamel::bench {
namespace {

constexpr int kRepeats = 7;
constexpr std::uint64_t kScenes = 20;  ///< drawn by number, beside the fixed one
/// Phase change of one pixel on a slope of 75 degrees in the reference rig; the crowns' gentle flanks are that steep.
constexpr float kSlope_rad = 0.23F;

template <class Run>
double median_ms(Run run, int repeats = kRepeats) {
  std::vector<double> times_ms;
  for (int k = 0; k < repeats; ++k) {
    const double start_ms = thread_ms();
    run();
    times_ms.push_back(thread_ms() - start_ms);
  }
  std::nth_element(times_ms.begin(), times_ms.begin() + repeats / 2, times_ms.end());
  return times_ms[static_cast<std::size_t>(repeats / 2)];
}

struct Problem {
  test::CrownBurst burst;
  pipeline::PhaseMaps maps;
};

Problem make(double noise_dn, std::uint64_t layout = 0) {
  Problem p{test::render_crowns({.noise_dn = noise_dn, .seed = layout + 1, .layout = layout}), {}};
  pipeline::NoiseModel noise;
  noise.floor_dn2 = static_cast<float>(noise_dn * noise_dn + 1.0 / 12);
  pipeline::compute_phase(p.burst.frames.view(), noise, {}, p.maps);
  std::vector<pipeline::CellSpan> rows;
  rows.reserve(static_cast<std::size_t>(p.maps.phase_rad.height()));
  for (int v = 0; v < p.maps.phase_rad.height(); ++v) rows.push_back({v, 0, p.maps.phase_rad.width(), 0, false});
  pipeline::PolarityMaps polarity;
  pipeline::apply_polarity(rows, {std::vector<float>(4, 1.0F), false}, noise, {}, p.maps, polarity);
  return p;
}

/// Regions of the mask that hang together; each may be off by a number of fringes of its own: without a code nobody
/// can know it.
Map<std::int32_t> regions_of(const Problem& p) {
  const int w = p.maps.phase_rad.width(), h = p.maps.phase_rad.height();
  cv::Mat mask(h, w, CV_8UC1), labels;
  for (int v = 0; v < h; ++v)
    for (int u = 0; u < w; ++u)
      mask.at<std::uint8_t>(v, u) = p.maps.reject(u, v) == pipeline::PixelReject::kNone ? 255 : 0;
  cv::connectedComponents(mask, labels, 4, CV_32S);
  Map<std::int32_t> out(w, h);
  for (int v = 0; v < h; ++v)
    for (int u = 0; u < w; ++u) out(u, v) = labels.at<std::int32_t>(v, u);
  return out;
}

Json score(const Problem& p, const Map<float>& unwrapped, const Map<std::uint8_t>& answered) {
  const Map<std::int32_t> region = regions_of(p);
  std::map<std::int32_t, std::map<long, std::size_t>> shifts;
  std::size_t mask = 0, told = 0;
  for (std::size_t i = 0; i < answered.size(); ++i) {
    mask += p.maps.reject[i] == pipeline::PixelReject::kNone ? 1U : 0U;
    if (answered[i] == 0) continue;
    ++told;
    const double off = (static_cast<double>(unwrapped[i]) - p.burst.phase_rad[i]) / (2 * std::numbers::pi);
    ++shifts[region[i]][std::lround(off)];
  }
  std::size_t right = 0;
  for (const auto& [k, counts] : shifts) {
    right += std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
               return a.second < b.second;
             })->second;
  }
  const auto n = static_cast<double>(std::max<std::size_t>(mask, 1));
  return {{"wrong_pct", 100 * static_cast<double>(told - right) / static_cast<double>(std::max<std::size_t>(told, 1))},
          {"left_out_pct", 100 * static_cast<double>(mask - told) / n},
          {"mask_px", mask}};
}

Json ours(const Problem& p, int repeats = kRepeats) {
  pipeline::LeastCutsWork work;
  pipeline::FloodMaps found;
  const double ms = median_ms(
      [&] {
        pipeline::unwrap_by_least_cuts(p.maps, {p.burst.carrier_rad.pixels().data(), kSlope_rad, kSlope_rad}, {}, work,
                                       found);
      },
      repeats);
  Map<float> unwrapped(p.maps.phase_rad.width(), p.maps.phase_rad.height());
  Map<std::uint8_t> answered(p.maps.phase_rad.width(), p.maps.phase_rad.height());
  for (std::size_t i = 0; i < unwrapped.size(); ++i) {
    unwrapped[i] = p.maps.phase_rad[i] + 2 * std::numbers::pi_v<float> * found.wraps[i];
    answered[i] = p.maps.reject[i] == pipeline::PixelReject::kNone ? 1 : 0;
  }
  Json out = score(p, unwrapped, answered);
  out["ms"] = ms;
  return out;
}

/// The links and the flood that the decoder's code works on.
Json links_and_flood(const Problem& p, int repeats = kRepeats) {
  pipeline::LinkMaps links;
  pipeline::FloodMaps flooded;
  Map<pipeline::PixelReject> reject = p.maps.reject;
  pipeline::PhaseMaps maps = p.maps;
  const double ms = median_ms(
      [&] {
        maps.reject = p.maps.reject;
        pipeline::reject_half_lit(maps.modulation_dn, maps.reject);
        pipeline::compute_links(maps, {p.burst.carrier_rad.pixels().data(), kSlope_rad, kSlope_rad}, {}, links);
        pipeline::reject_edges(links, maps);
        pipeline::flood(maps.phase_rad, links, flooded);
      },
      repeats);
  // In every region of the mask the largest component is the answer; the rest is left out.
  const Map<std::int32_t> region = regions_of(p);
  std::map<std::int32_t, std::size_t> sizes;
  std::map<std::int32_t, std::int32_t> largest;
  for (const std::int32_t c : flooded.component.pixels())
    if (c >= 0) ++sizes[c];
  for (std::size_t i = 0; i < region.size(); ++i) {
    const std::int32_t c = flooded.component[i];
    if (c < 0) continue;
    const auto known = largest.emplace(region[i], c).first;
    if (sizes[c] > sizes[known->second]) known->second = c;
  }
  Map<float> unwrapped(maps.phase_rad.width(), maps.phase_rad.height());
  Map<std::uint8_t> answered(maps.phase_rad.width(), maps.phase_rad.height());
  for (std::size_t i = 0; i < unwrapped.size(); ++i) {
    unwrapped[i] = maps.phase_rad[i] + 2 * std::numbers::pi_v<float> * flooded.wraps[i];
    answered[i] = flooded.component[i] >= 0 && flooded.component[i] == largest[region[i]] ? 1 : 0;
  }
  Json out = score(p, unwrapped, answered);
  out["ms"] = ms;
  return out;
}

#ifdef ENAMEL_PHASE_UNWRAPPING
Json opencv_histogram(const Problem& p, int repeats = kRepeats) {
  cv::setNumThreads(1);
  const int w = p.maps.phase_rad.width(), h = p.maps.phase_rad.height();
  cv::Mat wrapped(h, w, CV_32FC1), mask(h, w, CV_8UC1), result;
  for (int v = 0; v < h; ++v) {
    for (int u = 0; u < w; ++u) {
      wrapped.at<float>(v, u) = p.maps.phase_rad(u, v);
      mask.at<std::uint8_t>(v, u) = p.maps.reject(u, v) == pipeline::PixelReject::kNone ? 255 : 0;
    }
  }
  cv::phase_unwrapping::HistogramPhaseUnwrapping::Params params;
  params.width = w, params.height = h;
  const double ms = median_ms(
      [&] {  // a fresh object each time: a reused one grows slower call by call
        const auto unwrapper = cv::phase_unwrapping::HistogramPhaseUnwrapping::create(params);
        unwrapper->unwrapPhaseMap(wrapped, result, mask);
      },
      repeats);
  Map<float> unwrapped(w, h);
  Map<std::uint8_t> answered(w, h);
  for (int v = 0; v < h; ++v) {
    for (int u = 0; u < w; ++u) {
      unwrapped(u, v) = result.at<float>(v, u);
      answered(u, v) = mask.at<std::uint8_t>(v, u) != 0 ? 1 : 0;
    }
  }
  Json out = score(p, unwrapped, answered);
  out["ms"] = ms;
  return out;
}
#endif

/// For peers in other languages: the same phase (NaN where masked) and the truth.
void save_problem(const Problem& p, const std::string& stem) {
  Map<float> masked = p.maps.phase_rad, truth(masked.width(), masked.height());
  for (std::size_t i = 0; i < masked.size(); ++i) {
    if (p.maps.reject[i] != pipeline::PixelReject::kNone) masked[i] = std::nanf("");
    truth[i] = static_cast<float>(p.burst.phase_rad[i]);
  }
  save(stem + "_wrapped.pfm", masked);
  save(stem + "_truth.pfm", truth);
}

/// One run each on scenes drawn by number.
Json many_scenes(const std::string& folder, int noise_dn) {
  Json rows = Json::array();
  for (std::uint64_t k = 1; k <= kScenes; ++k) {
    const Problem p = make(noise_dn, k);
    Json row = {{"ours", ours(p, 3)}, {"links_and_flood", links_and_flood(p, 1)}};
#ifdef ENAMEL_PHASE_UNWRAPPING
    row["opencv_histogram"] = opencv_histogram(p, 1);
#endif
    save_problem(p, fmt::format("{}/unwrap_s{}_{}", folder, noise_dn, k));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Json unwrap_study(const std::string& folder) {
  Json out;
  for (const int noise_dn : {2, 6}) {
    const Problem p = make(noise_dn);
    const std::string name = "s" + std::to_string(noise_dn);
    out[name]["ours"] = ours(p);
    out[name]["links_and_flood"] = links_and_flood(p);
    out[name]["ours_with_code"] = unwrap_with_code(noise_dn);
    out[name]["marker_only"] = unwrap_with_marker(noise_dn);
#ifdef ENAMEL_PHASE_UNWRAPPING
    out[name]["opencv_histogram"] = opencv_histogram(p);
#endif
    out[name]["scenes"] = many_scenes(folder, noise_dn);
    const std::string stem = fmt::format("{}/unwrap_{}", folder, name);
    save_problem(p, stem);
    save(stem + "_modulation.pfm", p.maps.modulation_dn);
  }
  return out;
}

}  // namespace enamel::bench
