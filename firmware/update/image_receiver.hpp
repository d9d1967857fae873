// Takes a firmware image byte by byte into the slot that is not running: nothing is erased before the manifest has been
// verified in memory, no chunk programmed before its digest was right (docs/firmware-image.md §1, §5).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/boot/control_block.hpp"
#include "firmware/boot/slot_image.hpp"
#include "protocol/image/trust.hpp"

namespace enamel::fw {

struct UpdateIdentity {
  image::Hardware hardware;
  image::Trust trust;            ///< `revoked` is taken from the control block
  std::size_t running_slot = 0;  ///< never written; in recovery, where none runs, slot_to_keep() of policy.hpp
  std::optional<image::ImageVersion> running_version;  ///< absent in recovery
  [[nodiscard]] constexpr bool recovery() const noexcept { return !running_version; }
};

/// About 200 KiB of buffers, no heap. Not thread-safe.
class ImageReceiver {
 public:
  ImageReceiver(const BootRegions& regions, const UpdateIdentity& identity) noexcept;

  /// Forgets what came; what is right on the flash stays there and will not be written again.
  void restart(bool allow_older) noexcept;
  /// The next bytes of the image. After a refusal everything is refused until restart().
  [[nodiscard]] image::Checked<void> take(std::span<const std::byte> bytes) noexcept;
  /// All bytes came: reads the slot back, the manifest or one chunk a call, then makes it VERIFIED and PENDING in two
  /// commits. Nothing: not done, call again. kTruncated when bytes are missing.
  [[nodiscard]] std::optional<image::Checked<void>> finish_some() noexcept;
  /// finish_some() until it is done.
  [[nodiscard]] image::Checked<void> finish() noexcept;

  [[nodiscard]] bool complete() const noexcept { return manifest_ && received_ == manifest_->image_len(); }
  [[nodiscard]] std::uint32_t chunks_done() const noexcept { return chunks_done_; }
  [[nodiscard]] std::uint32_t chunks_total() const noexcept { return manifest_ ? manifest_->chunk_count : 0; }
  [[nodiscard]] std::uint32_t chunks_written() const noexcept {
    return chunks_written_;
  }  ///< the rest was right already

 private:
  [[nodiscard]] image::Checked<void> take_some(std::span<const std::byte>& bytes) noexcept;
  [[nodiscard]] image::Checked<void> accept_manifest() noexcept;
  [[nodiscard]] image::Checked<void> store_manifest() noexcept;
  [[nodiscard]] image::Checked<void> store_chunk() noexcept;
  [[nodiscard]] image::Checked<void> make_pending() noexcept;
  [[nodiscard]] image::Checked<void> write(std::uint64_t offset, std::span<const std::byte> bytes) noexcept;
  [[nodiscard]] std::size_t target() const noexcept { return 1 - identity_.running_slot; }

  BootRegions regions_;
  UpdateIdentity identity_;
  ControlStore control_;
  SlotWorkspace workspace_{};
  std::array<std::byte, image::kMaxManifest> manifest_bytes_{};
  std::array<std::byte, image::kChunkSize> chunk_{};
  std::optional<image::Manifest> manifest_;
  std::optional<image::Manifest> read_back_;  ///< while finishing: as it lies in the slot, views into workspace_
  std::optional<image::Refusal> refused_;
  std::uint64_t received_ = 0;
  std::size_t gathered_ = 0;      ///< of the manifest, then of the chunk in hand
  std::size_t manifest_len_ = 0;  ///< 0 until the header is here
  std::uint32_t chunks_done_ = 0;
  std::uint32_t chunks_written_ = 0;
  std::uint32_t chunks_read_back_ = 0;
  bool allow_older_ = false;
};

}  // namespace enamel::fw
