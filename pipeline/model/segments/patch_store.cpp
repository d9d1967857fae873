#include "pipeline/model/segments/patch_store.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <span>
#include <system_error>
#include <utility>

namespace enamel::pipeline {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

/// Nameless from the beginning, or at once where the file system knows no such files. -1 with errno.
int open_nameless(const std::string& folder) {
  const int fd = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (fd >= 0 || (errno != EOPNOTSUPP && errno != EISDIR)) return fd;
  std::string name = folder + "/enamel-patches-XXXXXX";
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

}  // namespace

class PatchStore::File {
 public:
  explicit File(int fd) noexcept : fd_(fd) {}
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { ::close(fd_); }

  /// All or nothing. 0, or what the system says.
  [[nodiscard]] int append(std::span<const std::span<const std::byte>> parts) {
    std::uint64_t at = end_;
    for (const std::span<const std::byte> part : parts) {
      for (std::size_t done = 0; done < part.size();) {
        const ssize_t n = ::pwrite(fd_, part.data() + done, part.size() - done, static_cast<off_t>(at));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) {
          const int error = n < 0 ? errno : ENOSPC;
          (void)!::ftruncate(fd_, static_cast<off_t>(end_));  // what there is of it is given back
          return error;
        }
        done += static_cast<std::size_t>(n);
        at += static_cast<std::uint64_t>(n);
      }
    }
    end_ = at;
    return 0;
  }
  /// All, or false with errno.
  [[nodiscard]] bool read(std::span<std::byte> into, std::uint64_t at) const {
    while (!into.empty()) {
      const ssize_t n = ::pread(fd_, into.data(), into.size(), static_cast<off_t>(at));
      if (n < 0 && errno == EINTR) continue;
      if (n == 0) errno = EIO;  // shorter than it was
      if (n <= 0) return false;
      into = into.subspan(static_cast<std::size_t>(n));
      at += static_cast<std::uint64_t>(n);
    }
    return true;
  }
  [[nodiscard]] std::uint64_t end() const noexcept { return end_; }
  mutable std::atomic<std::size_t> lost{0};

 private:
  int fd_;
  std::uint64_t end_ = 0;
};

PatchStore::PatchStore(PatchStoreConfig config) : config_(std::move(config)) {}
PatchStore::PatchStore(PatchStore&&) noexcept = default;
PatchStore& PatchStore::operator=(PatchStore&&) noexcept = default;
PatchStore::~PatchStore() = default;

StoredPatch PatchStore::keep(PackedPatch patch) {
  StoredPatch out;
  const std::size_t bytes = patch.bytes();
  const bool full = kept_.memory_bytes + bytes > config_.memory_bytes;
  if (full && !config_.folder.empty()) {
    if (to_file(patch, out)) {
      ++kept_.in_file;
      return out;
    }
    ++kept_.refused;
  }
  ++kept_.in_memory;
  kept_.memory_bytes += bytes;
  patch.runs.shrink_to_fit();
  out.patch_ = std::make_shared<const PackedPatch>(std::move(patch));
  return out;
}

bool PatchStore::to_file(const PackedPatch& patch, StoredPatch& stored) {
  if (disk_refused_) return false;
  int error = 0;
  if (!file_) {
    const int fd = open_nameless(config_.folder);
    if (fd < 0) {
      error = errno;
    } else {
      file_ = std::make_unique<File>(fd);
    }
  }
  const std::uint64_t offset = file_ ? file_->end() : 0;
  if (error == 0) {
    const std::array parts{bytes_of(patch.runs), bytes_of(patch.depth), bytes_of(patch.sigma), bytes_of(patch.texture)};
    error = file_->append(parts);
  }
  if (error != 0) {
    disk_refused_ = true;
    if (config_.on_refused) config_.on_refused(config_.folder + ": " + reason(error));
    return false;
  }
  stored.frame_.width = patch.width;
  stored.frame_.height = patch.height;
  stored.frame_.nearest_mm = patch.nearest_mm;
  stored.frame_.step_mm = patch.step_mm;
  stored.frame_.shade = patch.shade;
  stored.runs_ = patch.runs.size();
  stored.pixels_ = patch.depth.size();
  stored.texture_ = patch.texture.size();
  stored.offset_ = offset;
  return true;
}

PackedPatch PatchStore::load(const StoredPatch& stored, Texture texture) const {
  if (stored.patch_) {
    PackedPatch out = *stored.patch_;
    if (texture == Texture::kDropped) out.texture = {};
    return out;
  }
  PackedPatch out = stored.frame_;
  if (!file_) return out;  // nothing was ever kept under it
  out.runs.resize(stored.runs_);
  out.depth.resize(stored.pixels_);
  out.sigma.resize(stored.pixels_);
  if (texture == Texture::kKept) out.texture.resize(stored.texture_);
  std::uint64_t at = stored.offset_;
  for (const std::span<std::byte> part :
       {std::as_writable_bytes(std::span(out.runs)), std::as_writable_bytes(std::span(out.depth)),
        std::as_writable_bytes(std::span(out.sigma)), std::as_writable_bytes(std::span(out.texture))}) {
    if (!file_->read(part, at)) {
      if (file_->lost++ == 0 && config_.on_lost) config_.on_lost(config_.folder + ": " + reason(errno));
      return stored.frame_;
    }
    at += part.size();
  }
  return out;
}

PatchStore::Figures PatchStore::figures() const noexcept {
  Figures out = kept_;
  if (file_) {
    out.file_bytes = file_->end();
    out.lost = file_->lost;
  }
  return out;
}

}  // namespace enamel::pipeline
