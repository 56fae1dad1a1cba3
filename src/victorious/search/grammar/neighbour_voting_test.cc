#include "victorious/search/grammar/neighbour_voting.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

Keypoint At(float x, float y) { return {.x = x, .y = y, .scale_px = 2, .orientation_rad = 0}; }

// Figure 3-4 in small: a row of keypoints, 10 px apart, in both images; some of them match.
std::vector<Keypoint> Row(int count) {
  std::vector<Keypoint> row;
  for (int i = 0; i < count; ++i) row.push_back(At(static_cast<float>(10 * i), 0));
  return row;
}

TEST(NeighbourVoting, KeepsMatchesWhoseNeighboursMatchNeighbours) {
  const std::vector<Keypoint> row = Row(100);
  // 10 and 11 support each other; 50 matches a keypoint far from that of its neighbour 51.
  const MatchSet matches = {{10, 40, 0.5F}, {11, 41, 0.5F}, {50, 3, 0.5F}, {51, 90, 0.5F}};
  EXPECT_EQ(FilterByNeighbours(row, row, matches, {.nearest = 4, .min_votes = 1}), (MatchSet{matches[0], matches[1]}));
  EXPECT_TRUE(FilterByNeighbours(row, row, matches, {.nearest = 4, .min_votes = 2}).empty());
  EXPECT_EQ(FilterByNeighbours(row, row, matches, {.nearest = 4, .min_votes = 0}), matches);
}

// The weakness that the thesis describes (section 3.3.1): spurious keypoints saturate the neighbourhood.
TEST(NeighbourVoting, ClutterBetweenNeighboursRemovesSupport) {
  std::vector<Keypoint> scene = Row(20);
  const MatchSet matches = {{10, 10, 0.5F}, {11, 11, 0.5F}};
  EXPECT_EQ(FilterByNeighbours(scene, Row(20), matches, {}).size(), 2U);
  for (int i = 0; i < 20; ++i) {
    scene.push_back(At(100, static_cast<float>(i) * 0.1F));
    scene.push_back(At(110, static_cast<float>(i) * 0.1F));
  }
  EXPECT_TRUE(FilterByNeighbours(scene, Row(20), matches, {}).empty());
}

TEST(NeighbourVoting, MatchAndItsDuplicateGiveNoSupport) {
  const std::vector<Keypoint> row = Row(5);
  EXPECT_TRUE(FilterByNeighbours(row, row, {{2, 2, 0.5F}}, {}).empty());
  EXPECT_TRUE(FilterByNeighbours({}, {}, {}, {}).empty());
  // Two scene keypoints that match one template keypoint do not support each other: none of a keypoint's neighbours is
  // itself.
  EXPECT_TRUE(FilterByNeighbours(row, row, {{1, 2, 0.5F}, {2, 2, 0.5F}}, {}).empty());
}

}  // namespace
}  // namespace victorious
