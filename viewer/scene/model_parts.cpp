#include "viewer/scene/model_parts.hpp"

#include <algorithm>
#include <limits>

namespace enamel::view {
namespace {

/// Share of the triangles that a level is guessed to have before it is made.
constexpr std::array<double, kLevels> kGuess{1, 0.35, 0.11, 0.04, 0.015};  // chosen: a plane of voxels of 0.1 mm

Ball ball_around(const std::vector<const BlockMesh*>& meshes) {
  Vec3f lowest = Vec3f::Constant(std::numeric_limits<float>::max()), highest = -lowest;
  for (const BlockMesh* mesh : meshes) {
    for (const Vec3f& p : mesh->vertices) {
      lowest = lowest.cwiseMin(p);
      highest = highest.cwiseMax(p);
    }
  }
  return {(0.5F * (lowest + highest)).cast<double>(), static_cast<double>(0.5F * (highest - lowest).norm())};
}

}  // namespace

BlockIndex ModelParts::part_of(const BlockIndex& block) {
  BlockIndex out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int32_t down = block[k] >= 0 ? 0 : kPartBlocks - 1;
    out[k] = (block[k] - down) / kPartBlocks;
  }
  return out;
}

void ModelParts::changed(Part& part) {
  part.ball.reset();
  part.coarse = {};
}

void ModelParts::put(std::shared_ptr<const BlockMesh> block, std::uint32_t base) {
  Part& part = parts_[part_of(block->block)];
  Member& member = part.members[block->block];
  const std::size_t before = member.mesh ? member.mesh->triangles.size() : 0;
  part.triangles += block->triangles.size() - before;
  triangles_ += block->triangles.size() - before;
  member = {std::move(block), base};
  changed(part);
  ++revision_;
}

void ModelParts::remove(const BlockIndex& index) {
  const auto part = parts_.find(part_of(index));
  if (part == parts_.end()) return;
  const auto member = part->second.members.find(index);
  if (member == part->second.members.end()) return;
  part->second.triangles -= member->second.mesh->triangles.size();
  triangles_ -= member->second.mesh->triangles.size();
  part->second.members.erase(member);
  changed(part->second);
  if (part->second.members.empty()) parts_.erase(part);
  ++revision_;
}

void ModelParts::list_parts() {
  listed_.clear();
  seen_.clear();
  for (auto& [index, part] : parts_) {
    if (!part.ball) {
      std::vector<const BlockMesh*> meshes;
      for (const auto& [block, member] : part.members) meshes.push_back(member.mesh.get());
      part.ball = ball_around(meshes);
    }
    DetailPart detail{*part.ball, {part.triangles}, part.last};
    for (std::size_t level = 1; level < kLevels; ++level) {
      detail.triangles[level] = part.coarse[level]
                                    ? part.coarse[level]->size()
                                    : static_cast<std::size_t>(kGuess[level] * static_cast<double>(part.triangles));
    }
    listed_.push_back(&part);
    seen_.push_back(detail);
  }
}

const std::vector<IndexTriangle>& ModelParts::level_of(Part& part, std::size_t level) {
  if (!part.coarse[level]) {
    std::vector<MeshPart> meshes;
    for (const auto& [block, member] : part.members) meshes.push_back({member.mesh.get(), member.base});
    part.coarse[level] = mesher_.coarser(meshes, kCoarseCellMm[level - 1]);
  }
  return *part.coarse[level];
}

void ModelParts::append_exact(const Part& part) {
  for (const auto& [block, member] : part.members) {
    for (const IndexTriangle& t : member.mesh->triangles)
      out_.push_back({member.base + t[0], member.base + t[1], member.base + t[2]});
  }
}

/// Makes levels that are not there yet as long as there is time; those that must wait become level 0.
bool ModelParts::make_levels(std::vector<DetailChoice>& chosen, std::size_t& work) {
  bool made = false;
  for (DetailChoice& choice : chosen) {
    Part& part = *listed_[choice.part];
    if (choice.level == 0 || part.coarse[choice.level]) continue;
    if (work > 0 && work + part.triangles > kWorkTriangles) {
      choice.level = 0;
      continue;
    }
    work += part.triangles;
    seen_[choice.part].triangles[choice.level] = level_of(part, choice.level).size();
    made = true;
  }
  return made;
}

const std::vector<IndexTriangle>& ModelParts::select(const DetailView& view, std::size_t budget) {
  constexpr int kRounds = 4;  // chosen: of what levels will have the guesses are good
  list_parts();
  std::vector<DetailChoice> chosen;
  std::size_t work = 0;
  for (int n = 0; n < kRounds; ++n) {
    chosen = choose_detail(seen_, view, budget);
    if (!make_levels(chosen, work)) break;
  }
  out_.clear();
  coarse_ = false;
  for (const DetailChoice& choice : chosen) {
    Part& part = *listed_[choice.part];
    part.last = choice.level;
    coarse_ = coarse_ || choice.level > 0;
    if (choice.level == 0) {
      append_exact(part);
    } else {
      const std::vector<IndexTriangle>& made = level_of(part, choice.level);
      out_.insert(out_.end(), made.begin(), made.end());
    }
  }
  return out_;
}

const std::vector<IndexTriangle>& ModelParts::exact(const DetailView& view, std::optional<std::size_t>& next,
                                                    std::size_t budget) {
  list_parts();
  out_.clear();
  const auto seen = choose_detail(seen_, view, std::numeric_limits<std::size_t>::max());
  std::size_t at = next.value_or(0);
  for (; at < seen.size(); ++at) {
    const Part& part = *listed_[seen[at].part];
    if (!out_.empty() && out_.size() + part.triangles > budget) break;
    append_exact(part);
  }
  next = at < seen.size() ? std::optional(at) : std::nullopt;
  return out_;
}

}  // namespace enamel::view
