#include "victorious/category/network/box_suppression.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

NetworkBox Scored(const Box& box, double score, std::size_t category = 0) {
  return {.box = box, .category = category, .score = score};
}

TEST(SuppressOverlaps, KeepsTheMostLikelyOfAClass) {
  const auto kept = SuppressOverlaps({Scored({0, 0, 10, 10}, 0.5), Scored({1, 0, 10, 10}, 0.9),
                                      Scored({20, 0, 10, 10}, 0.4), Scored({1, 0, 10, 10}, 0.3, 1)},
                                     0.5);
  ASSERT_EQ(kept.size(), 3);
  EXPECT_EQ(kept[0].score, 0.9);
  EXPECT_EQ(kept[1].score, 0.4);
  EXPECT_EQ(kept[2].category, 1);  // another class overlaps freely
}

// The second overlaps the first, the third only the second: greedy suppression keeps it.
TEST(SuppressOverlaps, IsGreedy) {
  const auto kept =
      SuppressOverlaps({Scored({0, 0, 10, 10}, 0.9), Scored({3, 0, 10, 10}, 0.8), Scored({6, 0, 10, 10}, 0.7)}, 0.5);
  ASSERT_EQ(kept.size(), 2);
  EXPECT_EQ(kept[1].box.x, 6);
}

TEST(MergeTiles, PrefersTheWholeObjectToALikelierPartOfIt) {
  const TiledBox part{.found = Scored({40, 10, 15, 20}, 0.95), .is_cut = true};
  const TiledBox whole{.found = Scored({40, 10, 60, 20}, 0.6), .is_cut = false};
  for (const auto& order : {std::vector{part, whole}, std::vector{whole, part}}) {
    const auto kept = MergeTiles(order, 0.45);
    ASSERT_EQ(kept.size(), 1);
    EXPECT_EQ(kept[0].box.width, 60);
  }
}

TEST(MergeTiles, KeepsAPartOfWhichNoTileHasTheWhole) {
  const TiledBox part{.found = Scored({40, 10, 15, 20}, 0.95), .is_cut = true};
  const TiledBox other{.found = Scored({200, 10, 60, 20}, 0.6), .is_cut = false};
  EXPECT_EQ(MergeTiles({part, other}, 0.45).size(), 2);
  // A small whole object in front of a large one is no part.
  const TiledBox small{.found = Scored({210, 12, 15, 15}, 0.5), .is_cut = false};
  EXPECT_EQ(MergeTiles({small, other}, 0.45).size(), 2);
}

}  // namespace
}  // namespace victorious
