#include "firmware/update/image_receiver.hpp"

#include <algorithm>
#include <cstring>

#include "firmware/boot/transitions.hpp"

namespace enamel::fw {
namespace {

using image::Checked;
using image::Refusal;
using image::refuse;

ControlBlock load_or_factory(const ControlStore& control) noexcept {
  const std::optional<ControlBlock> block = control.load();
  return block ? *block : ControlBlock{};
}

/// Takes the front of `bytes` into `buffer` from `filled` up to `wanted`.
std::size_t gather(std::span<const std::byte>& bytes, std::span<std::byte> buffer, std::size_t filled,
                   std::size_t wanted) noexcept {
  const std::size_t n = std::min(bytes.size(), wanted - filled);
  std::memcpy(buffer.data() + filled, bytes.data(), n);
  bytes = bytes.subspan(n);
  return n;
}

}  // namespace

ImageReceiver::ImageReceiver(const BootRegions& regions, const UpdateIdentity& identity) noexcept
    : regions_(regions), identity_(identity), control_(regions.control) {}

void ImageReceiver::restart(bool allow_older) noexcept {
  manifest_.reset();
  read_back_.reset();
  refused_.reset();
  received_ = 0;
  gathered_ = 0;
  manifest_len_ = 0;
  chunks_done_ = 0;
  chunks_written_ = 0;
  allow_older_ = allow_older;
}

Checked<void> ImageReceiver::take(std::span<const std::byte> bytes) noexcept {
  while (!refused_ && !bytes.empty()) {
    if (const Checked<void> taken = take_some(bytes); !taken) refused_ = taken.error();
  }
  if (refused_) return refuse(*refused_);
  return {};
}

Checked<void> ImageReceiver::take_some(std::span<const std::byte>& bytes) noexcept {
  if (complete()) return refuse(Refusal::kTruncated);
  if (!manifest_) {
    const std::size_t wanted = manifest_len_ == 0 ? image::kHeaderSize : manifest_len_;
    const std::size_t n = gather(bytes, manifest_bytes_, gathered_, wanted);
    gathered_ += n;
    received_ += n;
    if (gathered_ < wanted) return {};
    if (manifest_len_ != 0) return accept_manifest();
    const Checked<std::uint32_t> length = image::manifest_length(std::span(manifest_bytes_).first(image::kHeaderSize));
    if (!length) return refuse(length.error());
    manifest_len_ = *length;
    return {};
  }
  const std::size_t wanted = manifest_->chunk_length(chunks_done_);
  const std::size_t n = gather(bytes, chunk_, gathered_, wanted);
  gathered_ += n;
  received_ += n;
  return gathered_ == wanted ? store_chunk() : Checked<void>{};
}

Checked<void> ImageReceiver::accept_manifest() noexcept {
  const Checked<image::Manifest> manifest = image::parse_manifest(std::span(manifest_bytes_).first(manifest_len_));
  if (!manifest) return refuse(manifest.error());
  const ControlBlock block = load_or_factory(control_);
  image::Trust trust = identity_.trust;
  trust.revoked = block.revoked;
  ENAMEL_CHECK_THAT(image::check_manifest(*manifest, identity_.hardware, trust,
                                          {block.min_security_counter, identity_.running_version, allow_older_}));
  if (!identity_.recovery()) ENAMEL_CHECK_THAT(may_overwrite_other(block, identity_.running_slot));
  const ControlBlock writing = begin_writing(block, target(), sha256(manifest->bytes));
  if (writing.slot != block.slot && !control_.store(writing)) return refuse(Refusal::kFlashWrite);
  manifest_ = *manifest;
  gathered_ = 0;
  return store_manifest();
}

Checked<void> ImageReceiver::store_manifest() noexcept {
  const Sha256Digest wanted = sha256(manifest_->bytes);
  if (hash_region(regions_.slot[target()], 0, manifest_len_, workspace_.piece) == wanted) return {};
  return write(0, manifest_->bytes);
}

Checked<void> ImageReceiver::store_chunk() noexcept {
  const std::span<const std::byte> bytes = std::span<const std::byte>(chunk_).first(gathered_);
  const Sha256Digest wanted = manifest_->chunk_digest(chunks_done_);
  if (sha256(bytes) != wanted) return refuse(Refusal::kChunkHash);
  const std::uint64_t at = flash_map::kManifestArea + std::uint64_t{chunks_done_} * image::kChunkSize;
  if (hash_region(regions_.slot[target()], at, gathered_, workspace_.piece) != wanted) {
    ENAMEL_CHECK_THAT(write(at, bytes));
    ++chunks_written_;
  }
  ++chunks_done_;
  gathered_ = 0;
  return {};
}

Checked<void> ImageReceiver::write(std::uint64_t offset, std::span<const std::byte> bytes) noexcept {
  FlashRegion& slot = regions_.slot[target()];
  if (slot.erase(offset) != FlashStatus::kOk || slot.program(offset, bytes) != FlashStatus::kOk ||
      hash_region(slot, offset, bytes.size(), workspace_.piece) != sha256(bytes)) {
    return refuse(Refusal::kFlashWrite);
  }
  return {};
}

std::optional<Checked<void>> ImageReceiver::finish_some() noexcept {
  if (refused_) return refuse(*refused_);
  if (!complete()) return refuse(Refusal::kTruncated);
  const FlashRegion& slot = regions_.slot[target()];
  if (!read_back_) {
    const Checked<image::Manifest> manifest = read_slot_manifest(slot, identity_.hardware, identity_.trust, workspace_);
    if (!manifest) return refuse(Refusal::kIncomplete);
    read_back_ = *manifest;
    chunks_read_back_ = 0;
    return std::nullopt;
  }
  if (chunks_read_back_ < read_back_->chunk_count) {
    if (!chunk_verifies(slot, *read_back_, chunks_read_back_, workspace_)) return refuse(Refusal::kIncomplete);
    ++chunks_read_back_;
    return std::nullopt;
  }
  return make_pending();
}

Checked<void> ImageReceiver::finish() noexcept {
  for (;;) {
    if (const std::optional<Checked<void>> done = finish_some()) return *done;
  }
}

Checked<void> ImageReceiver::make_pending() noexcept {
  const ControlBlock verified = mark_verified(load_or_factory(control_), target(), *read_back_);
  if (!control_.store(verified)) return refuse(Refusal::kFlashWrite);
  if (!control_.store(mark_pending(verified, target()))) return refuse(Refusal::kFlashWrite);
  return {};
}

}  // namespace enamel::fw
