#include "pipeline/decode/unwrap/cut_flow.hpp"

#include <algorithm>
#include <functional>

#include "pipeline/decode/unwrap/byte_runs.hpp"
#include "pipeline/decode/unwrap/cut_rows.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);  ///< layout: the carrier is not finite round about

}  // namespace

std::size_t CutFlow::node_of(std::size_t quad) const noexcept {
  return holes_.torn(quad) ? quads_ + static_cast<std::size_t>(holes_.of(quad)) : quad;
}

int CutFlow::charge_of(std::size_t node) const noexcept {
  return node < quads_ ? nodes_[node].charge : hole_charges_[node - quads_];
}

void CutFlow::add_charge(std::size_t node, int wrap_counts) noexcept {
  if (node < quads_) {
    nodes_[node].charge = static_cast<std::int8_t>(nodes_[node].charge + wrap_counts);
  } else {
    hole_charges_[node - quads_] += wrap_counts;
  }
}

/// The outside takes and gives without end: the image does not show what goes on there.
bool CutFlow::takes(std::size_t node, int sign) const noexcept {
  return node == quads_ + CutHoles::kOutside || charge_of(node) * sign < 0;
}

void CutFlow::prepare(const CutCosts& costs) {
  costs_ = &costs;
  holes_.find(costs);
  const std::size_t n = costs.stride * costs.rows;
  const auto s = static_cast<std::ptrdiff_t>(costs.stride);
  if (quads_ != n) nodes_.clear();
  quads_ = n;
  nodes_.resize(std::max(nodes_.size(), n + static_cast<std::size_t>(holes_.count())));
  hole_charges_.assign(static_cast<std::size_t>(holes_.count()), 0);
  east_.assign(n, 0), south_.assign(n, 0);
  steps_ = {Step{-s, 0, true, -1}, Step{s, s, true, 1}, Step{-1, 0, false, 1}, Step{1, 1, false, -1}};
  residues_ = visited_ = 0;
}

void CutFlow::find_residues() {
  constexpr std::uint8_t kSentinel = 255;  // layout: ends every run
  const std::size_t stride = costs_->stride, count = stride - 1;
  row_.assign(count + kRunPadding, kSentinel);
  sources_.clear();
  for (std::size_t at = 0; at + stride < quads_; at += stride) {
    residue_row(&costs_->east_turn[at], &costs_->east_turn[at + stride], &costs_->south_turn[at], count, row_.data());
    for (std::size_t u = end_of_run(row_.data(), 0, 0); u < count; u = end_of_run(row_.data(), u + 1, 0)) {
      const std::size_t node = node_of(at + u);
      add_charge(node, static_cast<std::int8_t>(row_[u]));
      if (node < quads_) sources_.push_back(node);
    }
  }
  residues_ = sources_.size();
  hole_charges_[CutHoles::kOutside] = 0;
  for (std::size_t h = 1; h < hole_charges_.size(); ++h)
    if (hole_charges_[h] != 0) sources_.push_back(quads_ + h);
}

void CutFlow::reach(std::size_t node, std::int32_t distance, std::size_t from, std::size_t direction) {
  Node& n = nodes_[node];
  const bool known = n.search == search_;
  if (known && (n.settled || n.distance <= distance)) return;
  if (!known) reached_.push_back(static_cast<std::int32_t>(node));
  n.search = search_;
  n.settled = false;
  n.distance = distance;
  n.from = static_cast<std::int32_t>(from);
  n.direction = static_cast<std::uint8_t>(direction);
  queue_.emplace_back(distance, static_cast<std::int32_t>(node));
  std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
}

void CutFlow::leave_quad(std::size_t quad, std::size_t node, int sign) {
  const std::int32_t distance = nodes_[node].distance, potential = nodes_[node].potential;
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    const Step& step = steps_[k];
    const std::size_t link = quad + static_cast<std::size_t>(step.link);
    const int cost = step.east ? costs_->east_cost[link] : costs_->south_cost[link];
    if (cost == 0) continue;
    const int cut = step.east ? east_[link] : south_[link];
    const int paid = cut * step.sign * sign >= 0 ? cost : -cost;  // moving a turn back undoes a cut
    const std::size_t next = node_of(quad + static_cast<std::size_t>(step.quad));
    reach(next, distance + paid + sign * (potential - nodes_[next].potential), quad, k);
  }
}

void CutFlow::leave(std::size_t node, int sign) {
  if (node < quads_) return leave_quad(node, node, sign);
  for (const std::int32_t quad : holes_.quads(static_cast<std::int32_t>(node - quads_)))
    leave_quad(static_cast<std::size_t>(quad), node, sign);
}

/// Dijkstra from the source to the nearest node that takes its turn, over reduced costs, none of them negative.
std::size_t CutFlow::search(std::size_t source, int sign) {
  ++search_;
  queue_.clear();
  reached_.clear();
  reach(source, 0, 0, 0);
  while (!queue_.empty()) {
    const auto node = static_cast<std::size_t>(queue_.front().second);
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
    queue_.pop_back();
    if (nodes_[node].settled) continue;
    nodes_[node].settled = true;
    ++visited_;
    if (takes(node, sign)) return node;
    leave(node, sign);
  }
  return kNowhere;
}

/// Keeps reduced costs from being negative once the path is used. Nodes at `distance` or beyond stay as they are.
void CutFlow::raise_potentials(std::int32_t distance, int sign) {
  for (const std::int32_t k : reached_) {
    Node& n = nodes_[static_cast<std::size_t>(k)];
    if (n.distance >= distance) continue;
    if (n.potential == 0) raised_.push_back(k);
    n.potential += sign * (n.distance - distance);
  }
}

void CutFlow::move_turn(std::size_t source, std::size_t target, int sign) {
  for (std::size_t node = target; node != source;) {
    const auto from = static_cast<std::size_t>(nodes_[node].from);
    const Step& step = steps_[nodes_[node].direction];
    const std::size_t link = from + static_cast<std::size_t>(step.link);
    auto& cut = step.east ? east_[link] : south_[link];
    cut = static_cast<std::int16_t>(cut + sign * step.sign);
    node = node_of(from);
  }
  add_charge(source, -sign);
  add_charge(target, sign);
}

void CutFlow::cancel(std::size_t source, int sign) {
  while (charge_of(source) * sign > 0) {
    const std::size_t target = search(source, sign);
    if (target == kNowhere) return add_charge(source, -charge_of(source));
    raise_potentials(nodes_[target].distance, sign);
    move_turn(source, target, sign);
  }
}

void CutFlow::settle(const CutCosts& costs) {
  prepare(costs);
  find_residues();
  for (const int sign : {1, -1})  // what is left of the second kind comes from outside
    for (const std::size_t source : sources_) cancel(source, sign);
  for (const std::int32_t k : raised_) nodes_[static_cast<std::size_t>(k)].potential = 0;
  raised_.clear();
}

}  // namespace enamel::pipeline
