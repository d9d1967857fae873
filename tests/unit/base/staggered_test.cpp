#include "protocol/base/staggered.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <vector>

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

}  // namespace
}  // namespace enamel
