#include "pipeline/decode/phase/row_memory.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace enamel::pipeline {
namespace {

/// layout: twice what the steps hold at a time, five grids of three rows the most.
constexpr std::size_t kMostSpare = 32;

struct Spare {
  std::array<std::vector<float>, kMostSpare> rows;
  std::size_t count = 0;
};

thread_local Spare spare;

/// The smallest that has room.
std::vector<float> take(std::size_t floats) {
  const auto begin = spare.rows.begin(), end = begin + static_cast<std::ptrdiff_t>(spare.count);
  auto best = end;
  for (auto row = begin; row != end; ++row) {
    const bool fits = row->capacity() >= floats;
    if (fits && (best == end || row->capacity() < best->capacity())) best = row;
  }
  if (best == end) return {};
  std::swap(*best, *(end - 1));
  --spare.count;
  return std::exchange(spare.rows[spare.count], {});
}

}  // namespace

RowMemory::RowMemory(std::size_t floats) : floats_(take(floats)) { floats_.resize(floats); }

RowMemory::RowMemory(std::size_t floats, float value) : floats_(take(floats)) { floats_.assign(floats, value); }

RowMemory& RowMemory::operator=(RowMemory&& other) noexcept {
  std::swap(floats_, other.floats_);
  return *this;
}

RowMemory::~RowMemory() { give_back(); }

/// With no place left, in place of the smallest.
void RowMemory::give_back() noexcept {
  if (floats_.capacity() == 0) return;
  if (spare.count < kMostSpare) {
    spare.rows[spare.count++] = std::move(floats_);
    return;
  }
  const auto smallest = std::min_element(spare.rows.begin(), spare.rows.end(),
                                         [](const auto& a, const auto& b) { return a.capacity() < b.capacity(); });
  if (smallest->capacity() < floats_.capacity()) std::swap(*smallest, floats_);
}

}  // namespace enamel::pipeline
