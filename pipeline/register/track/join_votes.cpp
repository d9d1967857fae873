#include "pipeline/register/track/join_votes.hpp"

#include <algorithm>
#include <numbers>

#include "pipeline/register/icp/normal_system.hpp"

namespace enamel::pipeline {
namespace {

bool same_pair(const SegmentJoin& a, const SegmentJoin& b) { return a.segment == b.segment && a.into == b.into; }

}  // namespace

std::vector<SegmentId> segments_to_ask(const std::vector<SegmentId>& older, std::uint64_t turn, std::size_t most) {
  if (older.size() <= most) return older;
  std::vector<SegmentId> out{older.front()};
  const std::size_t others = older.size() - 1, asked = most - 1;
  for (std::size_t k = 0; k < asked; ++k) out.push_back(older[1 + (turn * asked + k) % others]);
  return out;
}

std::optional<SegmentJoin> JoinVotes::add(const JoinVote& vote) {
  std::vector<const JoinVote*> agreeing{&vote};
  std::size_t of_pair = 0;
  for (const JoinVote& other : votes_) {
    if (!same_pair(other.join, vote.join)) continue;
    if (other.burst == vote.burst) return std::nullopt;
    ++of_pair;
    if (agree(other, vote)) agreeing.push_back(&other);
  }
  std::optional<SegmentJoin> out;
  if (agreeing.size() >= config_.votes) {
    const Pose& T = vote.join.T_into_segment;
    const Vec3d centre = T * vote.looked_at;
    Vector6 mean = Vector6::Zero();
    for (const JoinVote* one : agreeing) mean += motion_between(T, one->join.T_into_segment, centre, 1.0);
    out = vote.join;
    out->T_into_segment = apply_motion(mean / static_cast<double>(agreeing.size()), centre, 1.0, T);
  }
  if (of_pair >= config_.kept) {
    votes_.erase(std::ranges::find_if(votes_, [&](const JoinVote& v) { return same_pair(v.join, vote.join); }));
  }
  votes_.push_back(vote);
  return out;
}

void JoinVotes::forget(SegmentId segment) {
  std::erase_if(votes_, [&](const JoinVote& v) { return v.join.segment == segment || v.join.into == segment; });
}

bool JoinVotes::agree(const JoinVote& a, const JoinVote& b) const {
  const Pose &A = a.join.T_into_segment, &B = b.join.T_into_segment;
  const Eigen::AngleAxisd turn(A.linear().transpose() * B.linear());
  return std::max((A * a.looked_at - B * a.looked_at).norm(), (A * b.looked_at - B * b.looked_at).norm()) <=
             config_.agree_mm &&
         turn.angle() <= config_.agree_deg * std::numbers::pi / 180;
}

}  // namespace enamel::pipeline
