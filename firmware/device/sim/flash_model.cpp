#include "firmware/device/sim/flash_model.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "protocol/base/rng.hpp"

namespace enamel::fw {
namespace {

std::uint64_t next_version() noexcept {
  static std::atomic<std::uint64_t> count{0};
  return ++count;
}

void fill_noise(std::span<std::byte> bytes, std::uint64_t seed) {
  Rng rng(seed, 0, 0);
  while (!bytes.empty()) {
    const std::uint64_t word = rng.next_u64();
    const std::size_t n = std::min(bytes.size(), sizeof word);
    std::memcpy(bytes.data(), &word, n);
    bytes = bytes.subspan(n);
  }
}

}  // namespace

FlashModel::FlashModel(std::uint64_t size) {
  const auto erased =
      std::make_shared<Block>(Block{std::vector<std::byte>(kEraseBlock, std::byte{0xFF}), next_version()});
  blocks_.assign((size + kEraseBlock - 1) / kEraseBlock, erased);
}

FlashModel::Block& FlashModel::own(std::uint64_t offset) {
  std::shared_ptr<Block>& block = blocks_[offset / kEraseBlock];
  if (block.use_count() > 1) block = std::make_shared<Block>(*block);
  block->version = next_version();
  return *block;
}

FlashStatus FlashModel::read(std::uint64_t offset, std::span<std::byte> out) const noexcept {
  if (!powered_) return FlashStatus::kFailed;
  if (offset > size() || out.size() > size() - offset) return FlashStatus::kOutside;
  while (!out.empty()) {
    const std::size_t at = offset % kEraseBlock;
    const std::size_t n = std::min(out.size(), kEraseBlock - at);
    std::memcpy(out.data(), blocks_[offset / kEraseBlock]->bytes.data() + at, n);
    out = out.subspan(n);
    offset += n;
  }
  return FlashStatus::kOk;
}

bool FlashModel::begin(const Operation& op) {
  if (watcher_) watcher_(op);
  ++operations_;
  if (!cut_ || cut_->index != op.index) return true;
  tear(op, cut_->whole, cut_->seed);
  powered_ = false;
  return false;
}

FlashStatus FlashModel::erase(std::uint64_t offset) noexcept {
  if (!powered_) return FlashStatus::kFailed;
  if (offset % kEraseBlock != 0) return FlashStatus::kUnaligned;
  if (offset >= size()) return FlashStatus::kOutside;
  if (!begin({operations_, offset, kEraseBlock, {}})) return FlashStatus::kFailed;
  Block& block = own(offset);
  std::fill(block.bytes.begin(), block.bytes.end(), std::byte{0xFF});
  return FlashStatus::kOk;
}

FlashStatus FlashModel::program(std::uint64_t offset, std::span<const std::byte> bytes) noexcept {
  if (offset > size() || bytes.size() > size() - offset) return FlashStatus::kOutside;
  while (!bytes.empty()) {
    if (!powered_) return FlashStatus::kFailed;
    const std::size_t n = std::min<std::size_t>(bytes.size(), kSector - offset % kSector);
    if (!begin({operations_, offset, n, bytes.first(n)})) return FlashStatus::kFailed;
    Block& block = own(offset);
    std::byte* const to = block.bytes.data() + offset % kEraseBlock;
    if (std::any_of(to, to + n, [](std::byte b) { return b != std::byte{0xFF}; })) return FlashStatus::kFailed;
    std::memcpy(to, bytes.data(), n);
    bytes = bytes.subspan(n);
    offset += n;
  }
  return FlashStatus::kOk;
}

void FlashModel::cut_at(std::uint64_t index, std::size_t whole, std::uint64_t seed) { cut_ = Cut{index, whole, seed}; }

void FlashModel::restore_power() noexcept {
  powered_ = true;
  cut_.reset();
}

void FlashModel::tear(const Operation& op, std::size_t whole, std::uint64_t seed) {
  Block& block = own(op.offset);
  const std::span<std::byte> at = std::span(block.bytes).subspan(op.offset % kEraseBlock, op.length);
  whole = std::min(whole, op.bytes.size());
  std::copy_n(op.bytes.begin(), whole, at.begin());
  fill_noise(at.subspan(whole), seed);
}

std::vector<std::uint64_t> FlashModel::versions(std::uint64_t offset, std::uint64_t length) const {
  std::vector<std::uint64_t> out;
  for (std::uint64_t at = offset; at < offset + length; at += kEraseBlock) {
    out.push_back(blocks_[at / kEraseBlock]->version);
  }
  return out;
}

}  // namespace enamel::fw
