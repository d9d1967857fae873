#include "pipeline/model/fuse/block_grid.hpp"

#include <utility>

namespace enamel::pipeline {
namespace {

constexpr std::size_t kFirstSlots = 4096;

std::uint64_t key_of(const BlockIndex& index) noexcept {
  const auto part = [](std::int32_t i) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i + kBlockRange));
  };
  return part(index[0]) | (part(index[1]) << 21U) | (part(index[2]) << 42U);
}

// Finaliser of splitmix64 (Steele, Lea, Flood 2014): neighbouring blocks spread over the table.
std::size_t mix(std::uint64_t k) noexcept {
  k = (k ^ (k >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  k = (k ^ (k >> 27U)) * 0x94d049bb133111ebULL;
  return static_cast<std::size_t>(k ^ (k >> 31U));
}

}  // namespace

BlockGrid::BlockGrid() : slots_(kFirstSlots) {}

bool BlockGrid::in_range(const BlockIndex& index) noexcept {
  bool ok = true;
  for (const std::int32_t i : index) {
    ok = ok && i >= -kBlockRange && i < kBlockRange;
  }
  return ok;
}

std::int32_t BlockGrid::find(const BlockIndex& index) const noexcept {
  const std::uint64_t key = key_of(index);
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t at = mix(key) & mask;; at = (at + 1) & mask) {
    const Slot& slot = slots_[at];
    if (slot.id == kNoBlock || slot.key == key) {
      return slot.id;
    }
  }
}

std::int32_t BlockGrid::allocate(const BlockIndex& index) {
  const std::int32_t found = find(index);
  if (found != kNoBlock) {
    return found;
  }
  if ((size() + 1) * 2 > slots_.size()) {
    grow();
  }
  if (size() == slabs_.size() * kSlab) {
    slabs_.push_back(std::make_unique<Block[]>(kSlab));
  }
  const auto id = static_cast<std::int32_t>(size());
  indices_.push_back(index);
  block(id).index = index;
  insert(key_of(index), id);
  link(id);
  return id;
}

void BlockGrid::insert(std::uint64_t key, std::int32_t id) noexcept {
  const std::size_t mask = slots_.size() - 1;
  std::size_t at = mix(key) & mask;
  while (slots_[at].id != kNoBlock) {
    at = (at + 1) & mask;
  }
  slots_[at] = Slot{key, id};
}

void BlockGrid::grow() {
  std::vector<Slot> old(slots_.size() * 2);
  std::swap(old, slots_);
  for (const Slot& slot : old) {
    if (slot.id != kNoBlock) {
      insert(slot.key, slot.id);
    }
  }
}

void BlockGrid::link(std::int32_t id) {
  Block& self = block(id);
  std::size_t at = 0;
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx, ++at) {
        const BlockIndex other{self.index[0] + dx, self.index[1] + dy, self.index[2] + dz};
        const std::int32_t other_id = in_range(other) ? find(other) : kNoBlock;
        self.neighbour[at] = other_id;
        if (other_id != kNoBlock) {
          block(other_id).neighbour[26 - at] = id;
        }
      }
    }
  }
}

}  // namespace enamel::pipeline
