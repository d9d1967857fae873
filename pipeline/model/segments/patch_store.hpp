// Where packed patches wait until the scan is over: so many in memory, the others in a file that has no name and goes
// with the program. A disk that refuses costs memory, never a patch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "pipeline/model/segments/packed_patch.hpp"

namespace enamel::pipeline {

struct PatchStoreConfig {
  std::string folder;                                 ///< of the file, on a disk; empty: everything stays in memory
  std::size_t memory_bytes = std::size_t{128} << 20;  ///< chosen: 200 bursts; a quadrant never touches the disk
  /// Told once each, with folder and reason: that the disk takes no more, that it does not give back what it took.
  std::function<void(const std::string&)> on_refused{}, on_lost{};
};

/// A patch that a store keeps: itself, or where it stands in the store's file. Copies are of the same patch.
class StoredPatch {
 public:
  [[nodiscard]] bool in_memory() const noexcept { return patch_ != nullptr; }

 private:
  friend class PatchStore;
  std::shared_ptr<const PackedPatch> patch_;
  PackedPatch frame_;  ///< size, steps, shade; its other arrays are in the file, in their order …
  std::size_t runs_ = 0, pixels_ = 0, texture_ = 0;
  std::uint64_t offset_ = 0;  ///< … from here on
};

/// keep() from one thread at a time, load() from any number, of what was kept before.
class PatchStore {
 public:
  explicit PatchStore(PatchStoreConfig config);
  PatchStore(PatchStore&&) noexcept;
  PatchStore& operator=(PatchStore&&) noexcept;
  ~PatchStore();

  [[nodiscard]] StoredPatch keep(PackedPatch patch);
  /// The patch as it was kept, with its texture or without. What cannot be read back has no surface; figures().lost
  /// counts it.
  [[nodiscard]] PackedPatch load(const StoredPatch& stored, Texture texture) const;

  struct Figures {
    std::size_t in_memory = 0, in_file = 0;  ///< patches
    std::size_t memory_bytes = 0, file_bytes = 0;
    std::size_t refused = 0;  ///< of those in memory: the file would not take them
    std::size_t lost = 0;     ///< could not be read back
  };
  [[nodiscard]] Figures figures() const noexcept;

 private:
  class File;
  /// False: the patch is not in the file.
  [[nodiscard]] bool to_file(const PackedPatch& patch, StoredPatch& stored);

  PatchStoreConfig config_;
  std::unique_ptr<File> file_;  ///< from the first patch that did not fit in memory
  bool disk_refused_ = false;
  Figures kept_;
};

}  // namespace enamel::pipeline
