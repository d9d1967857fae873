// Any rig.json that parses and any four frames: the decoder must end, with a verdict, and account for every pixel.
// Entry point of libFuzzer; run_seeds.cpp calls it elsewhere.
#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/fuzz/byte_source.hpp"
#include "tests/fuzz/demand.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace {

using namespace enamel;
using test::demand;

void replace_value(std::string& text, const std::string& key, const std::string& value) {
  const auto at = text.find("\"" + key + "\": ");
  if (at == std::string::npos) return;
  const auto begin = at + key.size() + 4, end = text.find_first_of(",}]", begin);
  text.replace(begin, end - begin, value);
}

/// A rig as small as fuzzing needs, some of its values odd, sometimes its text broken.
std::string rig_text(test::ByteSource& in, int width, int height, int bits) {
  std::string text = test::kRigText;
  replace_value(text, "width", std::to_string(width));
  replace_value(text, "height", std::to_string(height));
  replace_value(text, "bits", std::to_string(bits));
  if (in.one_in(2)) replace_value(text, "cx", std::to_string(width / 2.0));
  if (in.one_in(2)) replace_value(text, "cy", std::to_string(height / 2.0));
  const std::array<const char*, 5> modes = {"\"T\"", "\"M\"", "\"plain4\"", "\"single\"", "\"multi\""};
  if (in.one_in(2)) replace_value(text, "mode", modes[in.below(modes.size())]);
  if (text.find("\"M\"") != std::string::npos) {
    replace_value(text, "steps", "3");
    replace_value(text, "first_cell", "0, \"code_ratio\": 6");
  }
  if (text.find("\"single\"") != std::string::npos) replace_value(text, "first_cell", "0, \"marker_fringe\": 17");
  const std::array<const char*, 14> keys = {"fx",           "fy",           "cx",
                                            "cy",           "period_px",    "mean",
                                            "amplitude",    "black_dn",     "gain_e_per_dn",
                                            "read_noise_e", "first_cell",   "full_well_e",
                                            "bits",         "polarity_code"};
  const std::array<const char*, 10> values = {"0",  "-1",  "1e-300", "1e300",  "2.0001",
                                              "24", "1e9", "16",     "\"+-\"", "NaN"};
  for (std::size_t edits = in.below(3); edits > 0; --edits)
    replace_value(text, keys[in.below(keys.size())], values[in.below(values.size())]);
  if (in.one_in(8)) text.replace(text.find("[40, 56]"), 8, in.one_in(2) ? "[56, 40]" : "[1e-9, 1e9]");
  if (in.one_in(16)) text[in.below(text.size())] = static_cast<char>(in.byte());
  return text;
}

/// Fringes of the rig on a slanted plane, or bytes as they come, some frames swapped or blinded.
test::FrameSet frames_of(test::ByteSource& in, const calib::Rig& rig, int bits) {
  const int w = rig.camera.width, h = rig.camera.height;
  test::FrameSet out{w, h, {}, bits};
  if (in.one_in(2) && rig.noise && rig.patterns.mode != calib::PatternMode::kMulti &&
      rig.patterns.mode != calib::PatternMode::kSingle) {
    const double z = 40 + static_cast<double>(in.below(16)), slope = static_cast<double>(in.byte()) / 500;
    test::SceneOptions o = test::noisy();
    o.bits = bits;
    const auto plane = [=](int u, int v) { return z + slope * u + 0.01 * v; };
    out = test::render(rig, plane, o).frames;
  } else {
    for (auto& f : out.frames) {
      f.resize(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * (bits > 8 ? 2 : 1));
      const std::uint8_t base = in.byte(), spread = in.byte();
      for (auto& p : f) p = static_cast<std::uint8_t>(base + (spread > 0 ? in.byte() % spread : 0));
    }
  }
  if (in.one_in(4)) std::swap(out.frames[in.below(4)], out.frames[in.below(4)]);
  if (in.one_in(4)) out.frames[in.below(4)].assign(out.frames[0].size(), in.byte());
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  test::ByteSource in(data, size);
  const int width = static_cast<int>(1 + in.below(in.one_in(4) ? 3 : 96)), height = static_cast<int>(1 + in.below(40));
  const std::array<int, 4> depths = {8, 8, 10, 16};
  const int bits = depths[in.below(depths.size())];
  const auto rig = calib::parse_rig(rig_text(in, width, height, bits));
  if (!rig || rig->camera.width > 96 || rig->camera.height > 40) return 0;
  pipeline::DecodeConfig config;
  config.light.min_points = 1 + in.below(50);  // images of this size would otherwise hardly get past the first gate
  const auto decoder = pipeline::BurstDecoder::make(*rig, config);
  if (!decoder) {
    demand(!decoder.error().detail.empty(), "a refusal has a reason");
    return 0;
  }
  const test::FrameSet frames = frames_of(in, *rig, bits);
  const pipeline::DecodedBurst out = decoder->decode(frames.view());
  std::size_t counted = 0;
  for (const std::size_t n : out.counts) counted += n;
  demand(counted == out.reject.size(), "every pixel is counted");
  demand(out.counts[0] == out.patch.valid_px, "accepted pixels are the valid ones");
  for (std::size_t i = 0; i < out.reject.size(); ++i) {
    const float z = out.patch.depth_mm[i];
    demand((out.reject[i] == pipeline::PixelReject::kNone) == (z == z), "accepted means a depth");
    demand(!(z == z) || (z > 0 && z < 1e9F && out.patch.sigma_mm[i] >= 0), "a depth is one");
  }
  return 0;
}
