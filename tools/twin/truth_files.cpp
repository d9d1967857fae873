#include "tools/twin/truth_files.hpp"

#include <spdlog/fmt/fmt.h>

#include <bit>
#include <cstring>

namespace enamel::twin {

static_assert(std::endian::native == std::endian::little, "PFM is written with scale -1: little endian");

std::string poses_header() { return "burst_id,t_ns,tx,ty,tz,qx,qy,qz,qw\n"; }

std::string poses_row(const BurstTruth& truth) {
  const Eigen::Vector3d t = truth.T_model_cam.translation();
  Eigen::Quaterniond q(truth.T_model_cam.linear());
  q.normalize();
  return fmt::format("{},{},{:.9f},{:.9f},{:.9f},{:.12f},{:.12f},{:.12f},{:.12f}\n", truth.burst_index, truth.t_mid_ns,
                     t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

std::string movers_header() { return "burst_id,mover,kind,seen_px,seen_share\n"; }

std::string movers_rows(const BurstTruth& truth, const std::vector<MoverConfig>& movers) {
  std::string out;
  for (const auto& m : truth.movers) {
    const double share = static_cast<double>(m.seen_px) / static_cast<double>(truth.maps.mover.size());
    out += fmt::format("{},{},{},{},{:.5f}\n", truth.burst_index, m.index, name_of(movers[m.index].kind), m.seen_px,
                       share);
  }
  return out;
}

std::string pfm(const std::vector<float>& values, int width, int height) {
  std::string out = fmt::format("Pf\n{} {}\n-1.0\n", width, height);
  const std::size_t header = out.size(), row = static_cast<std::size_t>(width) * sizeof(float);
  out.resize(header + row * static_cast<std::size_t>(height));
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    const std::size_t from = (static_cast<std::size_t>(height) - 1 - y) * static_cast<std::size_t>(width);
    std::memcpy(out.data() + header + y * row, values.data() + from, row);
  }
  return out;
}

}  // namespace enamel::twin
