#include "tests/support/draw/judge.hpp"

#include <algorithm>
#include <cmath>

#include "calib/model/lens.hpp"
#include "tests/support/order_score.hpp"

namespace enamel::test {

void ZScores::add(double z) {
  ++count_;
  const double size = std::abs(z);
  const bool within = size <= kMostZ;
  ++bins_[within ? std::min(static_cast<std::size_t>(size / kMostZ * kBins), bins_.size() - 2) : bins_.size() - 1];
  if (!within) return;
  ++within_;
  sum_ += z, squares_ += z * z;
}

ZScores& ZScores::operator+=(const ZScores& o) {
  count_ += o.count_, within_ += o.within_, sum_ += o.sum_, squares_ += o.squares_;
  for (std::size_t i = 0; i < bins_.size(); ++i) bins_[i] += o.bins_[i];
  return *this;
}

double ZScores::rms() const { return within_ > 0 ? std::sqrt(squares_ / static_cast<double>(within_)) : 0; }

double ZScores::mean() const { return within_ > 0 ? sum_ / static_cast<double>(within_) : 0; }

double ZScores::by_median() const {
  constexpr double kMedianOfGaussian = 0.6744897501960817;
  std::size_t below = 0;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    below += bins_[i];
    if (2 * below >= count_ && count_ > 0) return (static_cast<double>(i) + 0.5) * kMostZ / kBins / kMedianOfGaussian;
  }
  return 0;
}

namespace {

class Judge {
 public:
  Judge(const Drawn& drawn, const DrawnTruth& truth, const pipeline::DecodedBurst& decoded)
      : drawn_(drawn),
        truth_(truth),
        decoded_(decoded),
        wrong_(truth.lit.width(), truth.lit.height()),
        moving_(motion_band(drawn) > 0) {}

  Judged run() {
    out_.verdict = decoded_.verdict;
    out_.fastest_rad_a_frame = truth_.fastest_rad_a_frame;
    for (int v = 0; v < truth_.lit.height(); ++v)
      for (int u = 0; u < truth_.lit.width(); ++u) pixel(u, v);
    out_.largest_wrong = largest_region(wrong_);
    return out_;
  }

 private:
  void pixel(int u, int v) {
    const auto at = truth_.lit.index(u, v);
    const auto true_mm = static_cast<double>(truth_.depth_mm[at]);
    const auto& range = *drawn_.rig.depth_range;
    const double z_mm =
        decoded_.accepted() ? static_cast<double>(decoded_.patch.depth_mm[at]) : static_cast<double>(NAN);
    const bool has = !std::isnan(z_mm), inside = true_mm >= range.near_mm && true_mm <= range.far_mm;
    const auto sigma_phi = static_cast<double>(truth_.sigma_phi_rad[at]);
    if (truth_.lit[at] != 0 && inside) {
      const std::size_t sure = sigma_phi < kSure_rad ? 1 : 0, covered = has ? 1 : 0;
      ++out_.lit, out_.covered += covered, out_.sure += sure, out_.sure_covered += sure * covered;
    }
    if (!has) return;
    if (std::isnan(true_mm)) {
      ++out_.off_object;
      return;
    }
    if (truth_.lit[at] == 0) ++out_.in_shadow;
    if (!inside) return;
    ++out_.placed;
    if (is_wrong(u, v, z_mm)) {
      ++out_.wrong;
      wrong_[at] = 1;
    }
    if (truth_.lit[at] != 0) error(at, z_mm - true_mm);
  }

  bool is_wrong(int u, int v, double z_mm) const {
    const calib::PlanePoint ray = calib::undistort(drawn_.rig.camera, {static_cast<double>(u), static_cast<double>(v)});
    const double column = calib::project_to_projector(drawn_.rig, ray, z_mm).x;
    return std::abs(column - truth_.column_px(u, v)) > 0.5 * drawn_.rig.patterns.period_px;
  }

  void error(std::size_t at, double error_mm) {
    constexpr double kMisled_mm = 0.05, kMisledSigmas = 3;
    const auto sigma_mm = static_cast<double>(decoded_.patch.sigma_mm[at]);
    const bool edge = truth_.near_edge[at] != 0;
    if (!edge) {
      ++out_.smooth;
      out_.misled += std::abs(error_mm) > kMisled_mm + kMisledSigmas * sigma_mm ? 1U : 0U;
    }
    if (wrong_[at] != 0) return;
    const double z = error_mm / sigma_mm;
    const auto add = [&](PixelKind kind) { out_.z[static_cast<std::size_t>(kind)].add(z); };
    add(edge ? PixelKind::kNearEdge : PixelKind::kSmooth);
    if (edge) return;
    if (moving_) add(PixelKind::kMoving);
    if (static_cast<double>(truth_.sigma_phi_rad[at]) > kWeak_rad) add(PixelKind::kWeak);
  }

  const Drawn& drawn_;
  const DrawnTruth& truth_;
  const pipeline::DecodedBurst& decoded_;
  Map<std::uint8_t> wrong_;
  bool moving_;
  Judged out_;
};

}  // namespace

Judged judge(const Drawn& drawn, const DrawnTruth& truth, const pipeline::DecodedBurst& decoded) {
  return Judge(drawn, truth, decoded).run();
}

}  // namespace enamel::test
