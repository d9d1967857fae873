// The unit of a drawn burst: what manufacture leaves open, and what no calibration states.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/draw/draw_parts.hpp"

namespace enamel::test {
namespace {

constexpr double kDeg = std::numbers::pi / 180;
constexpr int kCodeCells = 16, kOrdersOpen = 6, kLongestRepeat = 2;  ///< half fringes, fringes, half fringes

/// Whether no window of more than two half fringes is repeated within the fringes that a depth range may span.
bool tells_orders(const std::vector<int>& code) {
  const auto n = static_cast<int>(code.size());
  for (int fringes = 1; fringes < kOrdersOpen; ++fringes) {
    int run = 0;
    for (int c = 0; c < 2 * n; ++c) {
      const bool alike = code[static_cast<std::size_t>(c % n)] == code[static_cast<std::size_t>((c + 2 * fringes) % n)];
      run = alike ? run + 1 : 0;
      if (run > kLongestRepeat) return false;
    }
  }
  return true;
}

calib::PatternValues draw_patterns(Random& r, calib::PatternMode mode) {
  calib::PatternValues p;
  p.mode = mode;
  p.period_px = r.chance(0.75) ? r.whole(18, 30) : 0.5 * r.whole(37, 59);
  p.mean = r(120, 128);
  p.amplitude = r(100, std::min(120.0, 254 - p.mean));
  if (mode == calib::PatternMode::kMicro) {
    p.steps = 3;
    p.code_ratio = r.chance(0.8) ? r.whole(6, 8) : r.whole(6, 7) + 0.5;
    return p;
  }
  do {
    p.polarity_code.clear();
    for (int c = 0; c < kCodeCells; ++c) p.polarity_code.push_back(r.chance(0.5) ? 1 : -1);
  } while (!tells_orders(p.polarity_code));
  p.first_cell = r.whole(0, kCodeCells - 1);
  return p;
}

/// `scale`: pixels a pixel of the reference rig's lens. A unit may lie beyond what manufacture allows.
calib::LensValues draw_lens(Random& r, double focal_px, int width, int height, double scale) {
  const double beyond = r.chance(0.2) ? 2 : 1;
  calib::LensValues lens;
  lens.width = width, lens.height = height;
  lens.fx = scale * focal_px * r(1 - 0.03 * beyond, 1 + 0.03 * beyond);
  lens.fy = lens.fx * r(0.998, 1.002);
  lens.cx = 0.5 * (width - 1) + beyond * scale * r(-8, 8);
  lens.cy = 0.5 * (height - 1) + beyond * scale * r(-8, 8);
  lens.dist = {beyond * r(-0.08, 0.03), beyond * r(-0.02, 0.03), r(-5e-4, 5e-4), r(-5e-4, 5e-4), 0};
  return lens;
}

void draw_camera(Random& r, calib::Rig& rig) {
  constexpr std::array<int, 5> kWidths_px = {512, 640, 640, 800, 1280};
  constexpr std::array<std::array<int, 2>, 4> kWindows_px = {{{320, 240}, {240, 180}, {400, 300}, {640, 480}}};
  const int width = kWidths_px[static_cast<std::size_t>(r.whole(0, 4))], height = width * 3 / 4;
  rig.camera = draw_lens(r, 1707, width, height, width / 640.0);
  const double which = r(0, 1);
  const auto& window = kWindows_px[which < 0.7 ? 0U : which < 0.8 ? 1U : which < 0.93 ? 2U : 3U];
  const int w = std::min(width, window[0]), h = std::min(height, window[1]);
  rig.camera.cx -= r.whole(0, width - w), rig.camera.cy -= r.whole(0, height - h);
  rig.camera.width = w, rig.camera.height = h;
}

/// The projector beside the camera, turned so that the axes cross at about 48 mm.
void draw_pose(Random& r, calib::Rig& rig) {
  const Point3 centre{r(8, 14), r(-0.3, 0.3), r(-1, 1)};
  const double verge = std::atan2(centre.x(), r(46.5, 49.5) - centre.z());
  Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(verge, Point3::UnitY()) * Eigen::AngleAxisd(r(-0.5, 0.5) * kDeg, Point3::UnitX()) *
       Eigen::AngleAxisd(r(-0.8, 0.8) * kDeg, Point3::UnitZ()))
          .toRotationMatrix();
  const Point3 t = -turn * centre;
  for (int i = 0; i < 3; ++i) {
    auto& row = rig.T_proj_cam[static_cast<std::size_t>(i)];
    for (int j = 0; j < 3; ++j) row[static_cast<std::size_t>(j)] = turn(i, j);
    row[3] = t(i);
  }
  rig.T_proj_cam[3] = {0, 0, 0, 1};
}

}  // namespace

calib::Rig draw_rig(Random& r, calib::PatternMode mode) {
  calib::Rig rig;
  draw_camera(r, rig);
  rig.projector = draw_lens(r, 1605, 854, 480, 1);
  draw_pose(r, rig);
  rig.patterns = draw_patterns(r, mode);
  rig.depth_range = calib::DepthRange{40, 56};
  calib::NoiseValues n;
  n.full_well_e = r(6000, 15000), n.read_noise_e = r(3, 10), n.black_dn = r.whole(0, 8);
  n.gain_e_per_dn = n.full_well_e / (255 - n.black_dn);
  rig.noise = n;
  return rig;
}

Response draw_response(Random& r) {
  Response out;
  out.dark = r(0.001, 0.01);
  const double which = r(0, 1);
  if (which < 0.25) {
    out.bow = r(-0.02, 0.02), out.skew = r(-0.01, 0.01);
  } else if (which < 0.8) {
    out.kind = ResponseKind::kGamma;
    out.gamma = which < 0.43 ? r(1, 1.4) : which < 0.62 ? r(1.4, 2) : r(2, 2.8);
  } else {
    out.kind = ResponseKind::kS;
    out.gamma = r(0.8, 1.6), out.s_share = r(0.3, 1);
    out.steep = r.chance(0.5) ? 0 : r(4, 9);
  }
  return out;
}

Optics draw_optics(Random& r) {
  Optics o;
  o.blur_px = r(0.5, 1.2), o.blur_px_per_mm = r(0.1, 0.32), o.focus_mm = r(46.5, 50.5);
  o.psf_px = r(0.4, 0.9);
  o.exposure = r(0.5, 1.1);
  o.ambient = r.chance(0.3) ? 0 : r(0, 0.03);
  o.prnu = r.chance(0.3) ? 0 : r(0, 0.01);
  return o;
}

}  // namespace enamel::test
