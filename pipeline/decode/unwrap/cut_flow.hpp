// The cuts of least cost that leave the phase without a residue. Going round a quad of pixels, the turns must add
// up to none; where they do not, a jump of more than half a fringe ends. Turns are moved over the quads as a flow from
// surplus to want; moving one over a link cuts it, at the link's cost. The least sum of |turns| x cost is a flow
// of minimum cost (Costantini, IEEE Trans. Geosci. Remote Sens. 36 (1998) 813), found exactly by successive shortest
// paths.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "pipeline/decode/unwrap/cut_costs.hpp"
#include "pipeline/decode/unwrap/cut_holes.hpp"

namespace enamel::pipeline {

class CutFlow {
 public:
  /// Afterwards turns + cuts add up to none on every way round, be it a quad or a hole. Work grows with the
  /// number of residues and with the area within their cuts' cost, not with the image. Deterministic.
  void settle(const CutCosts& costs);

  [[nodiscard]] std::size_t residues() const noexcept { return residues_; }
  [[nodiscard]] std::size_t nodes_visited() const noexcept { return visited_; }
  /// Cuts: turns to add to those of a pixel's right / lower link; 0 where it is whole. Margins as in CutCosts.
  [[nodiscard]] const std::vector<std::int16_t>& east() const noexcept { return east_; }
  [[nodiscard]] const std::vector<std::int16_t>& south() const noexcept { return south_; }

 private:
  struct Node {
    std::int32_t potential = 0, distance = 0;
    std::int32_t from = -1;      ///< quad that it was reached from
    std::uint32_t search = 0;    ///< that reached it last
    std::int8_t charge = 0;      ///< turns too many, of a quad; holes' are kept apart
    std::uint8_t direction = 0;  ///< of the step from there
    bool settled = false;
  };
  struct Step {
    std::ptrdiff_t quad = 0, link = 0;  ///< to the next quad; to the pixel whose link is crossed
    bool east = false;
    int sign = 0;  ///< change of the link's turns when a turn too many goes this way
  };

  void prepare(const CutCosts& costs);
  void find_residues();
  void cancel(std::size_t source, int sign);
  [[nodiscard]] std::size_t search(std::size_t source, int sign);
  void leave(std::size_t node, int sign);
  void leave_quad(std::size_t quad, std::size_t node, int sign);
  void reach(std::size_t node, std::int32_t distance, std::size_t from, std::size_t direction);
  void raise_potentials(std::int32_t distance, int sign);
  void move_turn(std::size_t source, std::size_t target, int sign);
  [[nodiscard]] std::size_t node_of(std::size_t quad) const noexcept;
  [[nodiscard]] int charge_of(std::size_t node) const noexcept;
  void add_charge(std::size_t node, int wrap_counts) noexcept;
  [[nodiscard]] bool takes(std::size_t node, int sign) const noexcept;

  const CutCosts* costs_ = nullptr;
  CutHoles holes_;
  std::vector<Node> nodes_;  ///< quads, then holes; all potentials and charges are 0 between calls
  std::vector<int> hole_charges_;
  std::vector<std::int16_t> east_, south_;
  std::vector<std::pair<std::int32_t, std::int32_t>> queue_;  ///< heap of (distance, node), least first
  std::vector<std::int32_t> reached_, raised_;                ///< nodes: by this search; by any
  std::vector<std::size_t> sources_;
  std::vector<std::uint8_t> row_;
  std::array<Step, 4> steps_{};
  std::size_t quads_ = 0, residues_ = 0, visited_ = 0;
  std::uint32_t search_ = 0;
};

}  // namespace enamel::pipeline
