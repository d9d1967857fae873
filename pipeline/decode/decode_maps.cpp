#include "pipeline/decode/decode_maps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <string_view>

#include "protocol/base/file.hpp"

namespace enamel::pipeline {
namespace {

static_assert(std::endian::native == std::endian::little, "the writers copy floats as they lie in memory");

void append(std::string& out, const void* data, std::size_t bytes) {
  out.append(static_cast<const char*>(data), bytes);
}

double median_sigma_um(const SurfacePatch& patch) {
  std::vector<float> sigma;
  for (const float s : patch.sigma_mm.pixels())
    if (s == s) sigma.push_back(s);
  if (sigma.empty()) return 0;
  const auto middle = sigma.begin() + static_cast<std::ptrdiff_t>(sigma.size() / 2);
  std::nth_element(sigma.begin(), middle, sigma.end());
  return 1e3 * static_cast<double>(*middle);
}

Result<std::string> png_bytes(const Map<std::uint8_t>& map, const char* name) {
  std::vector<std::uint8_t> pixels(map.pixels().begin(), map.pixels().end());
  std::vector<std::uint8_t> png;
  try {
    const cv::Mat image(map.height(), map.width(), CV_8UC1, pixels.data());
    if (!cv::imencode(".png", image, png)) return fail(ErrorCode::kFileWrite, std::string(name) + " cannot be encoded");
  } catch (const cv::Exception& e) {
    return fail(ErrorCode::kFileWrite, std::string(name) + ": " + e.what());
  }
  return std::string(png.begin(), png.end());
}

/// Grey levels far enough apart to be told by eye: 0 = measured, then 32 a reason in the order of pixel_reject.hpp.
Map<std::uint8_t> reject_picture(const Map<PixelReject>& reject) {
  constexpr int kLevels = 32;  // layout: grey levels a reason
  Map<std::uint8_t> out(reject.width(), reject.height());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<std::uint8_t>(static_cast<int>(reject[i]) * kLevels);
  return out;
}

std::string figure_json(const Figure& figure) {
  std::string values;
  for (const double v : figure.values) values += fmt::format("{}{:.{}f}", values.empty() ? "" : ", ", v, figure.digits);
  if (figure.is_list) values = "[" + values + "]";
  return fmt::format("\"{}\": {}", figure.name, values);
}

std::string sight_json(const Sight& s) {
  const std::vector<Figure> all = {
      {"spoilt_share", 5, {static_cast<double>(s.spoilt_share)}},
      {"veil_dn", 2, {static_cast<double>(s.veil_dn)}},
      {"translucent_share", 4, {static_cast<double>(s.translucent_share)}},
      {"apparent_depth_um", 2, {1e3 * static_cast<double>(s.apparent_depth_mm)}},
      {"at_px", 1, {static_cast<double>(s.x_px), static_cast<double>(s.y_px)}, true},
  };
  std::string out = fmt::format("\"trouble\": \"{}\"", name_of(s.trouble));
  for (const Figure& figure : all) out += ", " + figure_json(figure);
  return out;
}

/// Figures that the verdict rests on: of every mode, then of the burst's.
std::string diagnostics_json(const DecodeDiagnostics& d, const std::vector<Figure>& of_mode) {
  std::vector<Figure> all = {
      {"wave_harmonics", 4, {d.wave.harmonic.begin(), d.wave.harmonic.end()}, true},
      {"repeated_share", 5, {d.repeated_share}},
      {"linked_share", 5, {d.linked_share}},
      {"code_agreement", 5, {d.code_agreement}},
      {"withdrawn_share", 5, {d.withdrawn_share}},
      {"torn_share", 5, {d.torn_share}},
      {"light_ripple_rad", 6, {d.light_ripple_rad}},
      {"light_proof", 2, {d.light_proof}},
      {"motion_rad", 6, {static_cast<double>(d.motion_rad)}},
      {"shift_mm_per_frame", 6, {d.rigid.shift_mm.begin(), d.rigid.shift_mm.end()}, true},
      {"turn_rad_per_frame", 7, {d.rigid.turn_rad.begin(), d.rigid.turn_rad.end()}, true},
  };
  all.insert(all.end(), of_mode.begin(), of_mode.end());
  std::string out = fmt::format("\"noise_from\": \"{}\"", d.noise.source == NoiseSource::kRig ? "rig" : "closure");
  for (const Figure& figure : all) out += ",\n  " + figure_json(figure);
  return out;
}

}  // namespace

std::string pfm_bytes(const Map<float>& map) {
  std::string out = fmt::format("Pf\n{} {}\n-1.0\n", map.width(), map.height());
  const auto width = static_cast<std::size_t>(map.width());
  for (int v = map.height() - 1; v >= 0; --v)
    append(out, &map[static_cast<std::size_t>(v) * width], width * sizeof(float));
  return out;
}

std::string points_ply(const SurfacePatch& patch) {
  std::string body;
  std::size_t count = 0;
  for (std::size_t i = 0; i < patch.depth_mm.size(); ++i) {
    if (!(patch.depth_mm[i] == patch.depth_mm[i])) continue;
    const Vec3f n = patch.normals[i].allFinite() ? patch.normals[i] : Vec3f(Vec3f::Zero());
    append(body, patch.points[i].data(), 3 * sizeof(float));
    append(body, n.data(), 3 * sizeof(float));
    append(body, &patch.texture_dn[i], sizeof(float));
    ++count;
  }
  return fmt::format(
             "ply\nformat binary_little_endian 1.0\ncomment camera frame, mm\nelement vertex {}\n"
             "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
             "property float nz\nproperty float intensity\nend_header\n",
             count) +
         body;
}

std::string decode_json(const DecodedBurst& burst, const DecodeReport& report) {
  std::string rejected, stages;
  for (std::size_t r = 1; r < kPixelRejects; ++r)
    rejected += fmt::format("{}\"{}\": {}", rejected.empty() ? "" : ", ", kPixelRejectNames[r], burst.counts[r]);
  for (const auto& [name, ms] : report.stage_ms)
    stages += fmt::format("{}\"{}\": {:.3f}", stages.empty() ? "" : ", ", name, ms);
  return fmt::format(
      "{{\"burst\": {}, \"mode\": \"{}\", \"verdict\": \"{}\", \"valid_px\": {}, \"undecided_px\": {},\n"
      " \"rejected_px\": {{{}}},\n \"sigma_um_median\": {:.3f},\n \"diagnostics\": {{{}}},\n"
      " \"sight\": {{{}}},\n \"stage_ms\": {{{}}}}}\n",
      report.burst, report.mode, name_of(burst.verdict), burst.patch.valid_px,
      burst.counts[static_cast<std::size_t>(PixelReject::kRelative)], rejected, median_sigma_um(burst.patch),
      diagnostics_json(burst.diagnostics, report.figures), sight_json(burst.sight), stages);
}

Result<void> write_decode_maps(const DecodedBurst& burst, const DecodeReport& report, const std::string& folder) {
  ENAMEL_TRY(make_folder(folder));
  ENAMEL_TRY_ASSIGN(const std::string order, png_bytes(burst.order, "order.png"));
  ENAMEL_TRY_ASSIGN(const std::string reject, png_bytes(reject_picture(burst.reject), "reject.png"));
  ENAMEL_TRY(write_file(folder + "/phase.pfm", pfm_bytes(burst.phase_rad)));
  ENAMEL_TRY(write_file(folder + "/modulation.pfm", pfm_bytes(burst.patch.modulation_dn)));
  ENAMEL_TRY(write_file(folder + "/order.png", order));
  ENAMEL_TRY(write_file(folder + "/reject.png", reject));
  ENAMEL_TRY(write_file(folder + "/depth.pfm", pfm_bytes(burst.patch.depth_mm)));
  ENAMEL_TRY(write_file(folder + "/sigma.pfm", pfm_bytes(burst.patch.sigma_mm)));
  ENAMEL_TRY(write_file(folder + "/points.ply", points_ply(burst.patch)));
  return write_file(folder + "/decode.json", decode_json(burst, report));
}

}  // namespace enamel::pipeline
