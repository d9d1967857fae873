// Patches come back as they were kept, from memory and from a file, on any thread; a disk that refuses loses none.
#include "pipeline/model/segments/patch_store.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <thread>
#include <vector>

namespace enamel::pipeline {
namespace {

/// No two alike; 60 kB with its texture.
PackedPatch patch(unsigned n) {
  PackedPatch out;
  out.width = 160;
  out.height = 120;
  out.nearest_mm = 40 + 0.01F * static_cast<float>(n);
  out.step_mm = 1e-4F;
  const std::uint32_t pixels = 10000 + n;
  out.runs = {{n, pixels / 2}, {pixels, pixels - pixels / 2}};
  for (std::uint32_t i = 0; i < pixels; ++i) {
    out.depth.push_back(static_cast<std::uint16_t>(i * 7 + n));
    out.sigma.push_back(static_cast<std::uint8_t>(i + n));
  }
  out.texture.assign(19200, static_cast<std::uint16_t>(n));
  return out;
}

bool same(const PackedPatch& a, const PackedPatch& b) {
  const auto as_numbers = [](const std::vector<PackedPatch::Run>& runs) {
    std::vector<std::uint32_t> out;
    for (const PackedPatch::Run& run : runs) out.insert(out.end(), {run.begin, run.count});
    return out;
  };
  return a.width == b.width && a.height == b.height && a.nearest_mm == b.nearest_mm && a.step_mm == b.step_mm &&
         as_numbers(a.runs) == as_numbers(b.runs) && a.depth == b.depth && a.sigma == b.sigma && a.texture == b.texture;
}

std::vector<StoredPatch> keep(PatchStore& store, unsigned count) {
  std::vector<StoredPatch> out;
  for (unsigned n = 0; n < count; ++n) out.push_back(store.keep(patch(n)));
  return out;
}

void expect_all_there(const PatchStore& store, const std::vector<StoredPatch>& stored) {
  for (unsigned n = 0; n < stored.size(); ++n) {
    EXPECT_TRUE(same(store.load(stored[n], Texture::kKept), patch(n))) << n;
    PackedPatch bare = patch(n);
    bare.texture = {};
    EXPECT_TRUE(same(store.load(stored[n], Texture::kDropped), bare)) << n;
  }
}

/// Files of this process end here: what a full disk looks like.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = SIG_DFL;
};

class PatchStoreTest : public ::testing::Test {
 protected:
  PatchStoreTest() { std::filesystem::create_directories(folder_); }
  ~PatchStoreTest() override { std::filesystem::remove_all(folder_); }
  std::string folder_ = ::testing::TempDir() + "patch_store_" + std::to_string(::getpid());
};

TEST_F(PatchStoreTest, what_does_not_fit_in_memory_goes_to_a_file_without_a_name) {
  PatchStore store({.folder = folder_, .memory_bytes = 200'000});
  const auto stored = keep(store, 10);
  const PatchStore::Figures figures = store.figures();
  EXPECT_EQ(figures.in_memory, 2U);
  EXPECT_EQ(figures.in_file, 8U);
  EXPECT_LE(figures.memory_bytes, 200'000U);
  EXPECT_GT(figures.file_bytes, 8 * 60'000U);
  EXPECT_EQ(figures.refused, 0U);
  EXPECT_TRUE(stored.front().in_memory());
  EXPECT_FALSE(stored.back().in_memory());
  EXPECT_TRUE(std::filesystem::is_empty(folder_)) << "nothing is left behind, even by a program that is killed";
  expect_all_there(store, stored);
  const PatchStore moved = std::move(store);
  expect_all_there(moved, stored);
}

TEST_F(PatchStoreTest, many_threads_read_at_a_time) {
  PatchStore store({.folder = folder_, .memory_bytes = 0});
  const auto stored = keep(store, 24);
  ASSERT_EQ(store.figures().in_file, 24U);
  std::atomic<int> wrong{0};
  std::vector<std::jthread> threads;
  for (unsigned t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (unsigned n = 0; n < 96; ++n) {
        const unsigned k = (n * 7 + t * 5) % 24;
        if (!same(store.load(stored[k], Texture::kKept), patch(k))) ++wrong;
      }
    });
  }
  threads.clear();
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(store.figures().lost, 0U);
}

TEST_F(PatchStoreTest, a_disk_that_fills_up_loses_nothing) {
  int told = 0;
  PatchStore store({.folder = folder_, .memory_bytes = 0, .on_refused = [&](const std::string&) { ++told; }});
  std::vector<StoredPatch> stored;
  {
    const FileLimit full(250'000);  // the fourth patch fits in part
    stored = keep(store, 8);
  }
  const PatchStore::Figures figures = store.figures();
  EXPECT_EQ(figures.in_file, 3U);
  EXPECT_EQ(figures.in_memory, 5U);
  EXPECT_EQ(figures.refused, 5U) << "counted: the same with room has none";
  EXPECT_EQ(told, 1);
  EXPECT_LE(figures.file_bytes, 250'000U);
  expect_all_there(store, stored);
}

TEST_F(PatchStoreTest, what_cannot_be_read_back_has_no_surface_and_is_counted) {
  int told = 0;
  PatchStore store({.folder = folder_, .memory_bytes = 100'000, .on_lost = [&](const std::string&) { ++told; }});
  const auto stored = keep(store, 4);
  for (const auto& fd : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;  // the folder's own descriptor is among them
    if (std::filesystem::read_symlink(fd, gone).string().starts_with(folder_)) std::filesystem::resize_file(fd, 0);
  }
  EXPECT_TRUE(same(store.load(stored[0], Texture::kKept), patch(0))) << "in memory";
  for (unsigned n = 1; n < 4; ++n) {
    const PackedPatch lost = store.load(stored[n], Texture::kKept);
    EXPECT_EQ(lost.width, 160) << "of the camera's size: whoever goes on with it needs no special case";
    EXPECT_TRUE(lost.runs.empty() && lost.depth.empty() && lost.sigma.empty());
  }
  EXPECT_EQ(store.figures().lost, 3U);
  EXPECT_EQ(told, 1);
}

TEST_F(PatchStoreTest, a_folder_that_is_not_there_costs_memory_alone) {
  PatchStore store({.folder = folder_ + "/no/such", .memory_bytes = 100'000});
  const auto stored = keep(store, 5);
  EXPECT_EQ(store.figures().in_memory, 5U);
  EXPECT_EQ(store.figures().refused, 4U);
  expect_all_there(store, stored);
}

TEST_F(PatchStoreTest, without_a_folder_everything_stays_in_memory_and_nothing_is_refused) {
  PatchStore store({.folder = {}, .memory_bytes = 0});
  const auto stored = keep(store, 3);
  EXPECT_EQ(store.figures().in_memory, 3U);
  EXPECT_EQ(store.figures().refused, 0U);
  expect_all_there(store, stored);
}

}  // namespace
}  // namespace enamel::pipeline
