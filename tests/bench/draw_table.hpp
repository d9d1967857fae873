// What became of many drawn bursts, by class of their conditions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/support/draw/faults.hpp"
#include "tests/support/draw/judge.hpp"
#include "tests/support/draw/ready.hpp"
#include "tests/support/plain_floor.hpp"

namespace enamel::bench {

struct FaultRow {
  test::FrameFault fault = test::FrameFault::kStale;
  std::string what;
  pipeline::BurstVerdict verdict = pipeline::BurstVerdict::kAccepted;
  double misled_share = 0;
};

struct DrawRow {
  test::Drawn drawn;
  std::vector<std::string> refused;  ///< why draws before it were
  bool decoded = false;              ///< false: no decoder took the rig, and nothing below is filled
  test::Judged judged;
  test::BesidePlain beside;      ///< beside a plain decoder's depths
  std::vector<FaultRow> faults;  ///< of true bursts that were accepted as they are
  double render_ms = 0, decode_ms = 0;
};

/// Tables by response, scene, motion, albedo and view, and what became of faults where there are any. Every burst
/// counts in one row of each; those that no decoder has to take, in the last row alone.
[[nodiscard]] std::string draw_tables(const std::vector<DrawRow>& rows);
/// The worst of each kind with their conditions: true bursts rejected, large wrong regions, gaps, sigmas too small.
[[nodiscard]] std::string worst_draws(const std::vector<DrawRow>& rows, std::size_t how_many);
[[nodiscard]] std::string draws_json(const std::vector<DrawRow>& rows);

}  // namespace enamel::bench
