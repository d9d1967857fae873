#include "pipeline/register/map/edge_memo.hpp"

namespace enamel::pipeline {

void EdgeMemo::measured_with(std::uint8_t soft_below) {
  if (soft_below_ != soft_below) entries_.clear();
  soft_below_ = soft_below;
}

std::optional<EdgeMemo::Measured> EdgeMemo::find(Bursts of, const Pose& start) const {
  const auto found = entries_.find({of.i.value, of.j.value});
  if (found == entries_.end() || found->second.start.matrix() != start.matrix()) return std::nullopt;
  return found->second.measured;
}

void EdgeMemo::keep(Bursts of, const Pose& start, const Measured& measured) {
  entries_.insert_or_assign({of.i.value, of.j.value}, Entry{start, measured});
}

}  // namespace enamel::pipeline
