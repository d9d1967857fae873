#include "protocol/base/staggered.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <thread>
#include <vector>

#include "protocol/base/image_blocks.hpp"

namespace enamel {
namespace {

constexpr std::size_t kPage = 4096;

std::size_t place_in_page(const StaggeredVector<float>& v) {
  return reinterpret_cast<std::uintptr_t>(v.data()) % kPage;
}

TEST(Staggered, images_of_whole_pages_begin_at_different_places_within_a_page) {
  // 20 KiB stay on the heap and 1.2 MiB get pages of their own: neither may decide where an image begins.
  for (const std::size_t pages : {std::size_t{5}, std::size_t{300}}) {
    std::vector<StaggeredVector<float>> images;
    for (int k = 0; k < 16; ++k) images.emplace_back(pages * kPage / sizeof(float), 1.5F);
    std::set<std::size_t> places;
    for (const auto& image : images) {
      places.insert(place_in_page(image));
      EXPECT_EQ(place_in_page(image) % 64, 0U) << "whole cache lines";
      EXPECT_TRUE(std::all_of(image.begin(), image.end(), [](float x) { return x == 1.5F; }));
    }
    EXPECT_EQ(places.size(), images.size()) << pages << " pages";
  }
}

TEST(Staggered, vectors_grow_move_and_swap_like_any_other) {
  StaggeredVector<std::uint8_t> grown;
  for (int k = 0; k < 20000; ++k) grown.push_back(static_cast<std::uint8_t>(k));
  StaggeredVector<std::uint8_t> copy = grown, moved = std::move(grown), few{1, 2};
  EXPECT_EQ(copy, moved);
  std::swap(moved, few);
  EXPECT_EQ(moved.size(), 2U);
  EXPECT_EQ(few, copy);
  EXPECT_EQ(few[19999], static_cast<std::uint8_t>(19999));
}

TEST(Staggered, a_size_beyond_the_address_space_is_refused) {
  Staggered<double> memory;
  EXPECT_THROW(static_cast<void>(memory.allocate(static_cast<std::size_t>(-1) / 4)), std::bad_array_new_length);
}

TEST(Staggered, elements_without_a_value_are_cleared_only_on_demand) {
  StaggeredVector<float> image(300 * kPage / sizeof(float), 1.5F);
  image = StaggeredVector<float>(image.size(), float{});
  EXPECT_TRUE(std::all_of(image.begin(), image.end(), [](float x) { return x == 0; }));
}

TEST(ImageBlocks, what_was_given_back_is_taken_again_and_no_more_than_the_limit_is_kept) {
  constexpr std::size_t kBytes = 777 * kPage;
  std::byte *first = take_image_block(kBytes), *second = take_image_block(kBytes);
  EXPECT_NE(first, second);
  first[kBytes - 1] = second[kBytes - 1] = std::byte{1};
  give_image_block(first, kBytes);
  if (kImageBlocksReused) {
    std::byte* other = take_image_block(kBytes + kPage);
    EXPECT_NE(other, first) << "another size";
    give_image_block(other, kBytes + kPage);
    EXPECT_EQ(take_image_block(kBytes), first);
    give_image_block(first, kBytes);
  }
  give_image_block(second, kBytes);
  // As many as there is room for push the others out; one beyond the room is freed at once.
  std::byte* all = take_image_block(kImageBlocksKept_bytes);
  give_image_block(all, kImageBlocksKept_bytes);
  std::byte* beyond = take_image_block(kImageBlocksKept_bytes + kPage);
  give_image_block(beyond, kImageBlocksKept_bytes + kPage);
}

TEST(ImageBlocks, threads_that_take_and_give_never_share_a_block) {
  const auto work = [](std::uint8_t own) {
    for (int round = 0; round < 500; ++round) {
      StaggeredVector<std::uint8_t> image(40 * kPage, own);
      if (!std::all_of(image.begin(), image.end(), [own](std::uint8_t x) { return x == own; })) return false;
    }
    return true;
  };
  bool a = false, b = false;
  std::jthread one([&] { a = work(1); }), two([&] { b = work(2); });
  one.join();
  two.join();
  EXPECT_TRUE(a && b);
}

}  // namespace
}  // namespace enamel
