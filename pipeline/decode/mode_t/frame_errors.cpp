#include "pipeline/decode/mode_t/frame_errors.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pipeline/decode/mode_t/chosen.hpp"
#include "pipeline/decode/mode_t/fringe_means.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

/// Half the length of a fringe along rows, px; 0 where no span is a whole cell.
int half_fringe_px(std::span<const CellSpan> spans) {
  std::vector<int> lengths;
  for (const CellSpan& s : spans)
    if (s.whole) lengths.push_back(s.end - s.begin);
  if (lengths.empty()) return 0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

template <int N>
using Coefficients = Eigen::Matrix<double, N, 1>;
template <int N>
struct Fit {
  Coefficients<N> theta = Coefficients<N>::Zero();
  double pixels = 0;
};

/// Normal equations of N unknowns.
template <int N>
struct Equations {
  Eigen::Matrix<double, N, N> xx = Eigen::Matrix<double, N, N>::Zero();
  Coefficients<N> xy = Coefficients<N>::Zero();
  double squares = 0, pixels = 0;
};

class Estimator {
 public:
  Estimator(std::span<const CellSpan> spans, const PolarityMaps& polarity, double black_dn)
      : spans_(spans), polarity_(polarity), black_dn_(black_dn), reach_px_(half_fringe_px(spans)) {}

  /// How much of C and of S is in the measured A.
  void find_ripple_of_mean(const PhaseMaps& m) {
    FringeMeans<1> means(m.phase_rad.width(), reach_px_);
    std::vector<double> around(m.phase_rad.size());
    each_row([&](std::span<const CellSpan> row) {
      means.clear();
      each_pixel(m, row, [&](std::size_t i, int u) { means.add(u, FringeMeans<1>::Values(measured_mean(m, i))); });
      means.close();
      each_pixel(m, row, [&](std::size_t i, int u) { around[i] = std::max(means.at(u)[0], 1.0); });
    });
    const auto say = [&](std::size_t i) {
      const double scale = 1 / around[i];
      return Coefficients<3>(scale * static_cast<double>(m.cosine_dn[i]), scale * static_cast<double>(m.sine_dn[i]),
                             scale * measured_mean(m, i));
    };
    ripple_ = fit<2>(m, say).theta;
  }

  /// a, b, k, l.
  [[nodiscard]] Fit<4> solve(const PhaseMaps& m) const {
    return fit<4>(m, [&](std::size_t i) {
      const auto b = static_cast<double>(m.modulation_dn[i]);
      const double c = static_cast<double>(m.cosine_dn[i]) / b, s = static_cast<double>(m.sine_dn[i]) / b;
      const double y = b / mean_of(m, i);
      Coefficients<5> said;
      said << c, s, y * (c * c - s * s), y * 2 * c * s, y;
      return said;
    });
  }

  void remove(const Coefficients<4>& t, PhaseMaps& m) const {
    each_pixel(m, spans_, [&](std::size_t i, int) {
      const double a = mean_of(m, i);
      const double c = static_cast<double>(m.cosine_dn[i]) - t[0] * a, s = static_cast<double>(m.sine_dn[i]) - t[1] * a;
      const auto cosine = static_cast<float>(c - t[2] * c - t[3] * s);
      const auto sine = static_cast<float>(s - t[3] * c + t[2] * s);
      m.cosine_dn[i] = cosine;
      m.sine_dn[i] = sine;
      m.modulation_dn[i] = root(cosine * cosine + sine * sine + 1e-6F);
      m.phase_rad[i] += wrap_once(atan2_poly(sine, cosine) - m.phase_rad[i]);
    });
  }

 private:
  /// A above black: code_dn is I0+I2-I1-I3, mean_dn the mean of frames 0 and 2.
  [[nodiscard]] double measured_mean(const PhaseMaps& m, std::size_t i) const {
    return static_cast<double>(m.mean_dn[i]) - 0.25 * static_cast<double>(m.code_dn[i]) - black_dn_;
  }

  /// The same less its ripple.
  [[nodiscard]] double mean_of(const PhaseMaps& m, std::size_t i) const {
    return measured_mean(m, i) - ripple_[0] * static_cast<double>(m.cosine_dn[i]) -
           ripple_[1] * static_cast<double>(m.sine_dn[i]);
  }

  template <class Visit>
  void each_row(Visit visit) const {
    for (std::size_t begin = 0; begin < spans_.size();) {
      std::size_t end = begin;
      while (end < spans_.size() && spans_[end].row == spans_[begin].row) ++end;
      visit(spans_.subspan(begin, end - begin));
      begin = end;
    }
  }

  template <class Visit>
  void each_pixel(const PhaseMaps& m, std::span<const CellSpan> spans, Visit visit) const {
    for (const CellSpan& s : spans) {
      for (int u = s.begin; u < s.end; ++u) {
        const std::size_t i = m.phase_rad.index(u, s.row);
        if (polarity_.weight[i] < 0.999F || m.reject[i] != PixelReject::kNone || std::isnan(m.code_dn[i])) continue;
        if (mean_of(m, i) > 1) visit(i, u);
      }
    }
  }

  /// Least squares of what `say` tells of each pixel, N columns and what they explain, against the means of the fringe
  /// around it; what texture and edges say is left out.
  template <int N, class Say>
  [[nodiscard]] Fit<N> fit(const PhaseMaps& m, const Say& say) const {
    if (reach_px_ == 0) return {};
    Fit<N> out;
    double limit = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kRobustRounds; ++round) {
      const Equations<N> e = add<N>(m, say, out.theta, limit);
      const auto factors = e.xx.ldlt();
      if (factors.info() != Eigen::Success || !factors.isPositive()) return {};
      out = {factors.solve(e.xy), e.pixels};
      if (!out.theta.allFinite()) return {};
      limit = kOutlierSigmas * std::sqrt(e.squares / e.pixels);
    }
    return out;
  }

  /// Of the pixels that theta explains to within the limit.
  template <int N, class Say>
  [[nodiscard]] Equations<N> add(const PhaseMaps& m, const Say& say, const Coefficients<N>& theta, double limit) const {
    Equations<N> e;
    FringeMeans<N + 1> means(m.phase_rad.width(), reach_px_);
    std::vector<Coefficients<N + 1>> said(static_cast<std::size_t>(m.phase_rad.width()));
    each_row([&](std::span<const CellSpan> row) {
      means.clear();
      each_pixel(m, row, [&](std::size_t i, int u) {
        said[static_cast<std::size_t>(u)] = say(i);
        means.add(u, said[static_cast<std::size_t>(u)]);
      });
      means.close();
      each_pixel(m, row, [&](std::size_t, int u) {
        if (means.filled(u) < kLeastFilled) return;
        const Coefficients<N + 1> own = said[static_cast<std::size_t>(u)] - means.at(u);
        const Coefficients<N> x = own.template head<N>();
        const double rest = own[N] - x.dot(theta);
        if (!(std::abs(rest) <= limit)) return;
        e.xx += x * x.transpose();
        e.xy += x * own[N];
        e.squares += rest * rest;
        e.pixels += 1;
      });
    });
    return e;
  }

  std::span<const CellSpan> spans_;
  const PolarityMaps& polarity_;
  double black_dn_;
  int reach_px_;
  Coefficients<2> ripple_ = Coefficients<2>::Zero();
};

}  // namespace

FrameErrors correct_frame_errors(std::span<const CellSpan> spans, const PolarityMaps& polarity, double black_dn,
                                 const FrameErrorConfig& config, PhaseMaps& maps) {
  Estimator estimator(spans, polarity, black_dn);
  FrameErrors found;
  for (int round = 0; round < config.rounds; ++round) {
    estimator.find_ripple_of_mean(maps);
    const Fit<4> step = estimator.solve(maps);
    if (step.pixels < config.min_pixels) return found;
    estimator.remove(step.theta, maps);
    found.offset_cos += step.theta[0];
    found.offset_sin += step.theta[1];
    found.squeeze += step.theta[2];
    found.shear += step.theta[3];
    found.pixels = step.pixels;
  }
  return found;
}

}  // namespace enamel::pipeline
