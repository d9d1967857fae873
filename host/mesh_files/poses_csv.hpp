// poses.csv: burst_id,t_ns,tx,ty,tz,qx,qy,qz,qw with T_model_cam at t_ns, mm, unit quaternion, scalar last.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/types/geometry.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

struct PoseRow {
  std::uint64_t burst_id = 0;
  std::int64_t t_ns = 0;
  Pose T_model_cam = Pose::Identity();
};

/// Rows in order of burst_id; a table that a spreadsheet saved will do (protocol/base/plain_text.hpp). Errors:
/// kExchangeInvalid (header, number of fields, not a finite number, no unit quaternion within 1e-3, burst named twice;
/// the detail names the line).
[[nodiscard]] Result<std::vector<PoseRow>> parse_poses_csv(std::string_view bytes);
/// Errors: kFileNotFound, kFileRead and those of parse_poses_csv.
[[nodiscard]] Result<std::vector<PoseRow>> read_poses_csv(const std::string& path);

/// nm and 1e-12; qw >= 0.
[[nodiscard]] std::string poses_csv_text(const std::vector<PoseRow>& rows);
/// Whole or not at all. Errors: kFileWrite.
[[nodiscard]] Result<void> write_poses_csv(const std::string& path, const std::vector<PoseRow>& rows);

}  // namespace enamel::host
