#include "calib/model/rig_reader.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "calib/model/json_object.hpp"
#include "calib/model/json_section.hpp"
#include "calib/model/lens.hpp"

namespace enamel::calib {
namespace {

constexpr int kMaxSide_px = 16384;
constexpr double kMinAmplitude = 0.01, kMaxLevel = 65535;  // of a projector, levels
constexpr double kMaxPlace_px = 1e5;  // of a principal point: a crop or a shifted lens may have it far outside
constexpr double kMaxFocal_px = 1e6;
constexpr double kMaxAspect = 5;          // of a pixel's sides; projectors with diamond pixels have 2
constexpr double kMaxMagnification = 2;   // by distortion; narrow lenses stay below 1.2
constexpr double kRigidTolerance = 1e-4;  // six written decimals of a rotation matrix pass, a scaled one does not
constexpr int kMostTileBursts = 1'000'000;

/// Whether the distortion can be undone all over the picture, and moves no point beside what a lens does.
bool is_invertible(const LensValues& lens) {
  for (const double y : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    for (const double x : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const PlanePoint pixel{x * (lens.width - 1), y * (lens.height - 1)}, ideal = undistort(lens, pixel);
      const PlanePoint back = project(lens, ideal);
      if (!(std::hypot(back.x - pixel.x, back.y - pixel.y) < 1e-3)) return false;  // NaN, too
      const double seen = std::hypot((pixel.x - lens.cx) / lens.fx, (pixel.y - lens.cy) / lens.fy);
      const double was = std::hypot(ideal.x, ideal.y), slack = 1e-3;
      if (was > kMaxMagnification * seen + slack || seen > kMaxMagnification * was + slack) return false;
    }
  }
  return true;
}

LensValues read_lens(JsonSection s, std::vector<std::string>& unknown) {
  LensValues lens;
  lens.width = s.integer("width", 1, kMaxSide_px);
  lens.height = s.integer("height", 1, kMaxSide_px);
  lens.fx = s.number("fx");
  lens.fy = s.number("fy");
  lens.cx = s.number_within("cx", -kMaxPlace_px, kMaxPlace_px);
  lens.cy = s.number_within("cy", -kMaxPlace_px, kMaxPlace_px);
  const auto dist = s.numbers("dist", 5);
  for (std::size_t i = 0; i < 5; ++i) lens.dist[i] = dist[i];
  if (!(lens.fx > 0)) s.refuse("fx", "must be positive: this lens is not calibrated");
  if (!(lens.fy > 0)) s.refuse("fy", "must be positive: this lens is not calibrated");
  if (!(lens.fx <= kMaxFocal_px)) s.refuse("fx", "is no focal length in pixels");
  if (!(lens.fy <= kMaxAspect * lens.fx && lens.fx <= kMaxAspect * lens.fy)) {
    s.refuse("fy", "differs from fx by more than any pixel's shape explains");
  } else if (!is_invertible(lens)) {
    s.refuse("dist", "cannot be undone all over the picture: these are no lens's coefficients");
  }
  s.append_unknown(unknown);
  return lens;
}

void check_rigid(const std::array<std::array<double, 4>, 4>& t, JsonSection& s) {
  for (std::size_t c = 0; c < 4; ++c)
    if (t[3][c] != (c == 3 ? 1.0 : 0.0)) s.refuse("T_proj_cam", "must end with the row 0 0 0 1");
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = a; b < 3; ++b) {
      const double dot = t[0][a] * t[0][b] + t[1][a] * t[1][b] + t[2][a] * t[2][b];
      if (!(std::abs(dot - (a == b ? 1.0 : 0.0)) < kRigidTolerance)) s.refuse("T_proj_cam", "is not a rigid motion");
    }
  }
  const double det = t[0][0] * (t[1][1] * t[2][2] - t[1][2] * t[2][1]) -
                     t[0][1] * (t[1][0] * t[2][2] - t[1][2] * t[2][0]) +
                     t[0][2] * (t[1][0] * t[2][1] - t[1][1] * t[2][0]);
  if (!(det > 0)) s.refuse("T_proj_cam", "mirrors space");
}

void read_polarity(JsonSection& s, PatternValues& p) {
  for (const char c : s.string("polarity_code")) {
    if (c != '+' && c != '-') return s.refuse("polarity_code", "may hold only + and -");
    p.polarity_code.push_back(c == '+' ? 1 : -1);
  }
  if (p.polarity_code.empty()) s.refuse("polarity_code", "is empty");
  if (s.has("first_cell")) p.first_cell = s.integer("first_cell", -1'000'000, 1'000'000);
}

PatternMode read_mode(JsonSection& s) {
  const std::string mode = s.string("mode");
  if (mode == "plain4") return PatternMode::kPlain4;
  if (mode == "T") return PatternMode::kPolarity;
  if (mode == "single") return PatternMode::kSingle;
  if (mode == "M") return PatternMode::kMicro;
  if (mode != "multi") s.refuse("mode", "'" + mode + "' is none of plain4, T, single, M, multi");
  return PatternMode::kMulti;
}

PatternValues read_patterns(JsonSection s, std::vector<std::string>& unknown) {
  PatternValues p;
  p.mode = read_mode(s);
  const int wanted_steps = p.mode == PatternMode::kMicro ? 3 : 4;
  p.steps = s.has("steps") ? s.integer("steps", wanted_steps, wanted_steps) : wanted_steps;
  if (s.has("axis")) {
    const std::string axis = s.string("axis");
    p.axis_v = axis == "v";
    if (axis != "u" && axis != "v") s.refuse("axis", "must be u or v");
  }
  if (p.mode != PatternMode::kMulti) {
    p.period_px = s.number("period_px");
    if (!(p.period_px > 2)) s.refuse("period_px", "must be above two projector pixels");
  } else {
    static_cast<void>(s.has("cycles"));  // belongs to the calibration folder's reader, no cause for a notice
  }
  if (p.mode == PatternMode::kPolarity) read_polarity(s, p);
  if (p.mode == PatternMode::kSingle) p.marker_fringe = s.integer("marker_fringe", 0, kMaxSide_px);
  if (p.mode == PatternMode::kMicro) {
    p.code_ratio = s.number("code_ratio");
    if (!(p.code_ratio > 1)) s.refuse("code_ratio", "must be above 1");
  }
  if (s.has("mean")) p.mean = s.number_within("mean", 0, kMaxLevel);
  if (s.has("amplitude")) p.amplitude = s.number_within("amplitude", kMinAmplitude, kMaxLevel);
  s.append_unknown(unknown);
  return p;
}

NoiseValues read_noise(JsonSection s, std::vector<std::string>& unknown) {
  NoiseValues n;
  n.full_well_e = s.number_within("full_well_e", 1, 1e9);
  n.read_noise_e = s.number_within("read_noise_e", 0, 1e5);
  n.bits = s.integer("bits", 8, 16);
  n.gain_e_per_dn = s.number_within("gain_e_per_dn", 1e-4, 1e5);
  n.black_dn = s.number_within("black_dn", 0, std::ldexp(1.0, n.bits) - 1);
  s.append_unknown(unknown);
  return n;
}

ProjectorResponse read_projector_response(JsonSection s, std::vector<std::string>& unknown) {
  ProjectorResponse r;
  for (const double level : s.list("level"))
    r.level.push_back(static_cast<int>(std::lround(std::clamp(level, -1.0, 256.0))));
  r.emission = s.list("emission");
  r.residual = s.number_or("residual", 0);
  if (!is_rising(r)) s.refuse("emission", "must rise from 0 to 1 over three or more levels rising within 0 to 255");
  s.append_unknown(unknown);
  return r;
}

std::array<double, 2> read_interval(JsonSection& s, const char* key) {
  const auto ends = s.numbers(key, 2);
  if (!(ends[1] > ends[0])) s.refuse(key, "must be low < high");
  return {ends[0], ends[1]};
}

CorrectionField read_correction(JsonSection s, std::vector<std::string>& unknown) {
  CorrectionField f;
  f.u_px = read_interval(s, "u_px");
  f.v_px = read_interval(s, "v_px");
  f.inverse_mm = read_interval(s, "inverse_mm");
  const auto terms = s.numbers("terms", 3);
  std::size_t count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(terms[axis] >= 1 && terms[axis] <= kMaxCorrectionTerms[axis]) || terms[axis] != std::floor(terms[axis])) {
      s.refuse("terms", "must be whole numbers from 1 to 5, 5, 4");
      return f;
    }
    f.terms[axis] = static_cast<int>(terms[axis]);
    count *= static_cast<std::size_t>(f.terms[axis]);
  }
  f.coefficients = s.numbers("coefficients", count);
  s.append_unknown(unknown);
  return f;
}

LensDrift read_drift(JsonSection s, std::vector<std::string>& unknown) {
  const LensDrift drift{s.number_or("fx", 0), s.number_or("fy", 0), s.number_or("cx", 0), s.number_or("cy", 0)};
  s.append_unknown(unknown);
  return drift;
}

TemperatureTerms read_temperature(JsonSection s, std::vector<std::string>& unknown) {
  TemperatureTerms t;
  t.reference_c = s.number("reference_c");
  t.range_c = read_interval(s, "range_c");
  JsonSection per_k = s.section("per_kelvin");
  if (per_k.has("camera")) t.camera = read_drift(per_k.section("camera"), unknown);
  if (per_k.has("projector")) t.projector = read_drift(per_k.section("projector"), unknown);
  const auto vector = [&](const char* key, std::array<double, 3>& out) {
    if (!per_k.has(key)) return;
    const auto values = per_k.numbers(key, 3);
    std::copy(values.begin(), values.end(), out.begin());
  };
  vector("rotation_rad", t.rotation_rad);
  vector("translation_mm", t.translation_mm);
  per_k.append_unknown(unknown);
  s.append_unknown(unknown);
  return t;
}

LightInside read_light_inside(JsonSection s, std::vector<std::string>& unknown) {
  LightInside light;
  const std::vector<double> shares = s.matrix("of_enamel", 3, 3);
  for (std::size_t i = 0; i < shares.size() && i < 9; ++i) {
    light.of_enamel[i / 3][i % 3] = shares[i];
    if (!(shares[i] >= kLeastOfEnamel && shares[i] <= kMostOfEnamel)) s.refuse("of_enamel", "must be from 0.1 to 10");
  }
  light.sigma = s.number_within("sigma", 0, kMostOfEnamel);
  light.bursts = s.integer("bursts", 1, kMostTileBursts);
  s.append_unknown(unknown);
  return light;
}

Rig read_top(JsonSection& s) {
  Rig rig;
  if (s.string("format") != "rig/1") s.refuse("format", "must be rig/1");
  if (s.has("units") && s.string("units") != "mm") s.refuse("units", "must be mm");
  rig.camera = read_lens(s.section("camera"), rig.unknown_keys);
  rig.projector = read_lens(s.section("projector"), rig.unknown_keys);
  const auto t = s.matrix("T_proj_cam", 4, 4);
  for (std::size_t i = 0; i < t.size() && i < 16; ++i) rig.T_proj_cam[i / 4][i % 4] = t[i];
  check_rigid(rig.T_proj_cam, s);
  rig.patterns = read_patterns(s.section("patterns"), rig.unknown_keys);
  if (s.has("depth_range_mm")) {
    const auto range = s.numbers("depth_range_mm", 2);
    rig.depth_range = DepthRange{range[0], range[1]};
    if (!(range[0] > 0 && range[1] > range[0])) s.refuse("depth_range_mm", "must be near < far, both positive");
  }
  if (s.has("noise")) rig.noise = read_noise(s.section("noise"), rig.unknown_keys);
  if (s.has("response")) rig.response = read_projector_response(s.section("response"), rig.unknown_keys);
  if (s.has("serial")) rig.serial = s.string("serial");
  if (s.has("calibrated_at")) rig.calibrated_at = s.string("calibrated_at");
  if (s.has("temp_c")) rig.temp_c = s.number("temp_c");
  if (s.has("correction")) rig.correction = read_correction(s.section("correction"), rig.unknown_keys);
  if (s.has("temperature")) rig.temperature = read_temperature(s.section("temperature"), rig.unknown_keys);
  if (s.has("light_inside")) rig.light_inside = read_light_inside(s.section("light_inside"), rig.unknown_keys);
  // Written by the solver for those who judge a calibration; not part of Rig.
  for (const char* key : {"schema", "sha256", "covariance", "residuals"}) static_cast<void>(s.has(key));
  s.append_unknown(rig.unknown_keys);
  return rig;
}

}  // namespace

Result<Rig> read_rig_json(std::string_view text) {
  ENAMEL_TRY_ASSIGN(const auto json, parse_json_object(text, ErrorCode::kRigInvalid));
  Faults faults;
  JsonSection top(json, "", faults);
  Rig rig = read_top(top);
  if (!faults.first().empty()) return fail(ErrorCode::kRigInvalid, faults.first());
  return rig;
}

}  // namespace enamel::calib
