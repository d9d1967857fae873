#include "host/mesh_files/poses_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "host/mesh_files/text_scan.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/plain_text.hpp"

namespace enamel::host {
namespace {

constexpr std::string_view kHeader = "burst_id,t_ns,tx,ty,tz,qx,qy,qz,qw";

tl::unexpected<Error> bad_poses(std::size_t line, const char* reason) {
  return fail(ErrorCode::kExchangeInvalid, "poses.csv line " + std::to_string(line) + ": " + reason);
}

Result<PoseRow> row_of(std::string_view line, std::size_t number) {
  if (std::count(line.begin(), line.end(), ',') != 8) {
    return bad_poses(number, "not nine fields");
  }
  const auto id = to_number<std::uint64_t>(cut(line, ','));
  const auto t_ns = to_number<std::int64_t>(cut(line, ','));
  if (!id || !t_ns) {
    return bad_poses(number, "burst_id or t_ns is not a whole number");
  }
  std::array<double, 7> value{};
  for (double& v : value) {
    const auto field = to_number<double>(cut(line, ','));
    if (!field || !std::isfinite(*field)) {
      return bad_poses(number, "not a finite number");
    }
    v = *field;
  }
  const Eigen::Quaterniond q(value[6], value[3], value[4], value[5]);
  if (std::abs(q.norm() - 1.0) > 1e-3) {
    return bad_poses(number, "the quaternion is not of unit length");
  }
  PoseRow row{*id, *t_ns, Pose::Identity()};
  row.T_model_cam.linear() = q.normalized().toRotationMatrix();
  row.T_model_cam.translation() = Vec3d(value[0], value[1], value[2]);
  return row;
}

}  // namespace

Result<std::vector<PoseRow>> parse_poses_csv(std::string_view bytes) {
  const std::string table = plain_table(bytes);
  std::string_view text = table, line;
  if (!next_line(text, line) || line != kHeader) {
    return bad_poses(1, "the header is not burst_id,t_ns,tx,ty,tz,qx,qy,qz,qw");
  }
  std::vector<PoseRow> rows;
  for (std::size_t number = 2; next_line(text, line); ++number) {
    if (!line.empty()) {
      ENAMEL_TRY_ASSIGN(PoseRow row, row_of(line, number));
      rows.push_back(row);
    }
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const PoseRow& a, const PoseRow& b) { return a.burst_id < b.burst_id; });
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i].burst_id == rows[i - 1].burst_id) {
      return fail(ErrorCode::kExchangeInvalid, "poses.csv: burst " + std::to_string(rows[i].burst_id) + " twice");
    }
  }
  return rows;
}

Result<std::vector<PoseRow>> read_poses_csv(const std::string& path) {
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(path));
  auto rows = parse_poses_csv(text);
  if (!rows) {
    rows.error().detail = path + ": " + rows.error().detail;
  }
  return rows;
}

std::string poses_csv_text(const std::vector<PoseRow>& rows) {
  std::string text(kHeader);
  text += '\n';
  for (const PoseRow& row : rows) {
    Eigen::Quaterniond q(row.T_model_cam.linear());
    q.normalize();
    const double sign = q.w() < 0.0 ? -1.0 : 1.0;
    const Vec3d t = row.T_model_cam.translation();
    fmt::format_to(std::back_inserter(text), "{},{},{:.9f},{:.9f},{:.9f},{:.12f},{:.12f},{:.12f},{:.12f}\n",
                   row.burst_id, row.t_ns, t.x(), t.y(), t.z(), sign * q.x(), sign * q.y(), sign * q.z(), sign * q.w());
  }
  return text;
}

Result<void> write_poses_csv(const std::string& path, const std::vector<PoseRow>& rows) {
  return write_file(path, poses_csv_text(rows));
}

}  // namespace enamel::host
