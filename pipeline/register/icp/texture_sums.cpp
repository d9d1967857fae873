#include "pipeline/register/icp/texture_sums.hpp"

#include <algorithm>
#include <cmath>

#include "calib/model/lens.hpp"

namespace enamel::pipeline {
namespace {

/// A camera-frame point in a picture: brightness there, and how it changes with the point.
struct Look {
  float brightness = 0;
  Vec3d gradient = Vec3d::Zero();  ///< a mm, camera frame
};

std::optional<Look> look_at(const Map<float>& picture, int step, const calib::LensValues& lens, const Vec3d& p) {
  if (!(p.z() > 1)) return std::nullopt;
  const calib::PlanePoint px = calib::project(lens, {p.x() / p.z(), p.y() / p.z()});
  const double half = 0.5 * (step - 1);
  const double u = (px.x - half) / step, v = (px.y - half) / step;
  const int u0 = static_cast<int>(std::floor(u)), v0 = static_cast<int>(std::floor(v));
  if (!picture.contains(u0, v0) || !picture.contains(u0 + 1, v0 + 1)) return std::nullopt;
  const auto a = static_cast<float>(u - u0), b = static_cast<float>(v - v0);
  const float p00 = picture(u0, v0), p10 = picture(u0 + 1, v0), p01 = picture(u0, v0 + 1),
              p11 = picture(u0 + 1, v0 + 1);
  Look out;
  // NaN where one of the four is unknown.
  out.brightness = (1 - b) * ((1 - a) * p00 + a * p10) + b * ((1 - a) * p01 + a * p11);
  const double along_u = static_cast<double>((1 - b) * (p10 - p00) + b * (p11 - p01)) * lens.fx / step;
  const double along_v = static_cast<double>((1 - a) * (p01 - p00) + a * (p11 - p10)) * lens.fy / step;
  out.gradient = Vec3d(along_u, along_v, -(along_u * p.x() + along_v * p.y()) / p.z()) / p.z();
  return out;
}

/// What a gradient at p says of small motions about the centre.
Vector6 jacobian(const TextureAlignment& of, const Vec3d& p, const Vec3d& gradient) {
  Vector6 out;
  out << (p - of.centre).cross(gradient) / of.rho_mm, gradient;
  return out;
}

void add_greys(TextureSums& out, float seen_grey, float own_grey) {
  const auto seen = static_cast<double>(seen_grey), had = static_cast<double>(own_grey);
  out.a += seen, out.b += had, out.aa += seen * seen, out.bb += had * had, out.ab += seen * had;
}

}  // namespace

double TextureSums::mean_square() const {
  double sum = 0;
  for (const float e : residuals) sum += static_cast<double>(e) * static_cast<double>(e);
  return sum / static_cast<double>(residuals.size());
}

double TextureSums::correlation() const {
  const auto n = static_cast<double>(residuals.size());
  const double va = aa - a * a / n, vb = bb - b * b / n;
  return va > 0 && vb > 0 ? (ab - a * b / n) / std::sqrt(va * vb) : 0;
}

double TextureSums::correlation_along(const Eigen::VectorXd& direction) const {
  const double own = direction.dot(own_own * direction), ref = direction.dot(ref_ref * direction);
  return own > 0 && ref > 0 ? direction.dot(own_ref * direction) / std::sqrt(own * ref) : 0;
}

double TextureSums::scale() {
  if (residuals.empty()) return 0;
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return 1.4826 * static_cast<double>(*middle);
}

std::size_t Sliding::changing(const Eigen::VectorXd& direction, double min_gradient) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      change, [&](const AlongWeak& along) { return std::abs(along.dot(direction)) >= min_gradient; }));
}

Sliding points_that_slide(const TextureAlignment& of, const Pose& T_model_cam, const WeakDirections& weak,
                          double min_gradient) {
  Sliding out{of, weak, {}, {}};
  for (std::size_t n = 0; n < of.points.p.size(); ++n) {
    const Vec3d gradient = T_model_cam.linear() * of.points.gradient[n].cast<double>();
    const Vector6 J = jacobian(of, T_model_cam * of.points.p[n].cast<double>(), gradient);
    AlongWeak change = AlongWeak::Zero(weak.cols());
    double square = 0;
    for (Eigen::Index k = 0; k < weak.cols(); ++k) {
      change[k] = weak.col(k).dot(J);
      square += change[k] * change[k];
    }
    if (!(square >= min_gradient * min_gradient)) continue;
    out.points.p.push_back(of.points.p[n]);
    out.points.brightness.push_back(of.points.brightness[n]);
    out.change.push_back(change);
  }
  return out;
}

TextureSums sum_up(const Sliding& sliding, const Pose& T_model_cam, std::size_t level, double sigma) {
  const TextureAlignment& of = sliding.of;
  const Eigen::Index k = sliding.weak.cols();
  TextureSums out;
  for (TextureSums::Products* sum : {&out.H, &out.own_own, &out.own_ref, &out.ref_ref}) sum->setZero(k, k);
  out.g.setZero(k);
  const Pose T_ref_model = of.reference.T_model_cam.inverse();
  const Eigen::Matrix3d R_model_ref = of.reference.T_model_cam.linear();
  for (std::size_t n = 0; n < sliding.points.p.size(); ++n) {
    const Vec3d p = T_model_cam * sliding.points.p[n].cast<double>();
    const auto look = look_at(of.reference.brightness[level], of.reference.step, of.lens, T_ref_model * p);
    if (!look || !std::isfinite(look->brightness)) continue;
    const float own = sliding.points.brightness[n][level];
    const auto e = static_cast<double>(look->brightness - own);
    const AlongWeak along = sliding.weak.transpose() * jacobian(of, p, R_model_ref * look->gradient);
    const double r = e / (2 * sigma);
    const double w = 1 / ((1 + r * r) * (1 + r * r));
    out.H += w * along * along.transpose();
    out.g += w * e * along;
    out.own_own += sliding.change[n] * sliding.change[n].transpose();
    out.own_ref += sliding.change[n] * along.transpose();
    out.ref_ref += along * along.transpose();
    out.residuals.push_back(static_cast<float>(std::abs(e)));
    add_greys(out, look->brightness, own);
  }
  return out;
}

double blurred_agreement(const Sliding& sliding, const Pose& T_model_cam, std::size_t stride, std::size_t min_points) {
  const TextureAlignment& of = sliding.of;
  const Pose T_ref_cam = of.reference.T_model_cam.inverse() * T_model_cam;
  TextureSums out;
  for (std::size_t n = 0; n < sliding.points.p.size(); n += stride) {
    const auto look =
        look_at(of.reference.brightness[0], of.reference.step, of.lens, T_ref_cam * sliding.points.p[n].cast<double>());
    if (!look || !std::isfinite(look->brightness)) continue;
    out.residuals.push_back(0);
    add_greys(out, look->brightness, sliding.points.brightness[n][0]);
  }
  return out.residuals.size() < min_points ? 0 : out.correlation();
}

}  // namespace enamel::pipeline
