#include "victorious/search/pose/pooled_template.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/search/pose/vote_poses.h"

namespace victorious {
namespace {

// A view's keypoints and their matches.
struct DrawnView {
  std::vector<Keypoint> keypoints;
  std::vector<Point3> points_in_model;
  std::vector<RankedMatch> matches;

  [[nodiscard]] ComparedTemplate Compared() const { return {keypoints, points_in_model, matches}; }
};

Point3 RandomPlace(Random& random) {
  const auto along = [&](double most) { return static_cast<float>(most * (2 * random.Uniform() - 1)); };
  return {along(4), along(2), along(1)};
}

// Orthographic projection of a point: view direction rotated by side_rad, image by turn_rad; 40 px per metre.
Eigen::Vector2d Shown(const Point3& place, double side_rad, double turn_rad, double pixels_per_m = 40) {
  const Eigen::Vector2d flat(place.x * std::cos(side_rad) - place.z * std::sin(side_rad), place.y);
  return Eigen::Vector2d(200, 150) + pixels_per_m * (Eigen::Rotation2Dd(turn_rad) * flat);
}

DrawnView Draw(const std::vector<Point3>& places, double side_rad, double turn_rad = 0, double pixels_per_m = 40) {
  DrawnView view{.keypoints = {}, .points_in_model = places, .matches = {}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector2d pixel = Shown(places[i], side_rad, turn_rad, pixels_per_m);
    const double own_turn_rad = WrapAngle(0.7 * static_cast<double>(i) + turn_rad);
    view.keypoints.push_back({static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                              static_cast<float>(pixels_per_m / 10), static_cast<float>(own_turn_rad)});
  }
  return view;
}

std::vector<Point3> Places(std::uint64_t seed, int count) {
  Random random(seed);
  std::vector<Point3> places;
  for (int i = 0; i < count; ++i) places.push_back(RandomPlace(random));
  return places;
}

TEST(PooledTemplate, NeighbourKeypointsAreTransferredIntoTheView) {
  constexpr double kSide_rad = 0.17;
  DrawnView view = Draw(Places(1, 20), 0);
  DrawnView neighbour = Draw(Places(2, 30), kSide_rad, 0.6, 60);
  view.matches = {{7, 3, 2}};
  neighbour.matches = {{11, 5, 1}, {12, 29, 4}};
  const PooledTemplate pooled = PoolTemplates(view.Compared(), std::vector{neighbour.Compared()});
  ASSERT_EQ(pooled.keypoints.size(), 50U);
  ASSERT_EQ(pooled.points_in_model.size(), 50U);
  EXPECT_TRUE(std::ranges::equal(std::span(pooled.keypoints).first(20), view.keypoints));
  const DrawnView truth = Draw(neighbour.points_in_model, 0);
  for (std::size_t i = 0; i < 30; ++i) {
    const Keypoint& transferred = pooled.keypoints[20 + i];
    EXPECT_NEAR(transferred.x, truth.keypoints[i].x, 0.1) << i;
    EXPECT_NEAR(transferred.y, truth.keypoints[i].y, 0.1) << i;
    EXPECT_NEAR(transferred.scale_px, 4, 0.2) << i;
    EXPECT_NEAR(WrapAngle(transferred.orientation_rad - truth.keypoints[i].orientation_rad), 0, 0.1) << i;
    EXPECT_EQ(pooled.points_in_model[20 + i], neighbour.points_in_model[i]);
  }
  EXPECT_EQ(pooled.matches, (std::vector<RankedMatch>{{7, 3, 2}, {11, 25, 1}, {12, 49, 4}}));
}

TEST(PooledTemplate, SharedKeypointsAreMergedAndRanksScaled) {
  DrawnView view = Draw(Places(1, 20), 0);
  DrawnView neighbour = Draw(Places(1, 20), 0.1);
  view.matches = {{7, 3, 2}};
  neighbour.matches = {{11, 3, 1}};
  const PooledTemplate pooled = PoolTemplates(view.Compared(), std::vector{neighbour.Compared(), neighbour.Compared()});
  ASSERT_EQ(pooled.keypoints.size(), 20U);
  EXPECT_EQ(pooled.matches, (std::vector<RankedMatch>{{7, 3, 6}, {11, 3, 3}, {11, 3, 3}}));
}

TEST(PooledTemplate, ViewWithTooFewKeypointsIsNotPooled) {
  DrawnView view = Draw(Places(1, 7), 0);
  view.matches = {{7, 3, 2}};
  const PooledTemplate pooled = PoolTemplates(view.Compared(), std::vector{Draw(Places(2, 30), 0.17).Compared()});
  EXPECT_EQ(pooled.keypoints, view.keypoints);
  EXPECT_EQ(pooled.matches, view.matches);
}

TEST(PooledTemplate, PlanarPointsDoNotDetermineTheTransfer) {
  std::vector<Point3> places = Places(1, 20);
  for (Point3& place : places) place.z = 1;
  const DrawnView view = Draw(places, 0);
  EXPECT_EQ(PoolTemplates(view.Compared(), std::vector{Draw(Places(2, 30), 0.17).Compared()}).keypoints,
            view.keypoints);
}

// Each of two views has 40 keypoints with seven true matches; pooled, the significance is higher than of either view.
TEST(PooledTemplate, PoolingRaisesNegLog10Nfa) {
  Random random(3);
  FeatureSet scene;
  scene.image_width = 640;
  scene.image_height = 480;
  for (int i = 0; i < 2000; ++i) {
    scene.keypoints.push_back({static_cast<float>(640 * random.Uniform()), static_cast<float>(480 * random.Uniform()),
                               static_cast<float>(1.5 * std::exp2(2 * random.Uniform())),
                               static_cast<float>(2 * kPi * random.Uniform() - kPi)});
  }
  const Similarity2 fit{0.8, 0.4, {180, 40}};
  std::uint32_t in_scene = 0;
  const auto match = [&](DrawnView& view) {
    const DrawnView as_shown = Draw(view.points_in_model, 0);  // the scene shows both from the first view's direction
    for (std::uint32_t i = 0; i < view.keypoints.size(); ++i) {
      for (std::uint32_t rank = 1; rank <= 4; ++rank) view.matches.push_back({1000 + random.Below(1000), i, rank});
      if (i >= 7) continue;
      const Keypoint& shown = as_shown.keypoints[i];
      const Eigen::Vector2d place = fit.Apply({shown.x, shown.y});
      view.matches[4 * i].scene_keypoint = in_scene;
      scene.keypoints[in_scene++] = {static_cast<float>(place.x()), static_cast<float>(place.y()),
                                     static_cast<float>(shown.scale_px * fit.scale),
                                     static_cast<float>(WrapAngle(shown.orientation_rad + fit.rotation_rad))};
    }
  };
  DrawnView view = Draw(Places(4, 40), 0);
  DrawnView neighbour = Draw(Places(5, 40), 0.17);
  match(view);
  match(neighbour);
  const Polygon outline = BoxCorners({40, 70, 320, 160});
  const auto neg_log10_nfa = [&](std::span<const Keypoint> keypoints, std::span<const RankedMatch> matches) {
    const std::vector<PlanarFit> fits = VotePoses(scene, keypoints, matches, outline, {}, {});
    return fits.empty() ? -100.0 : *fits.front().neg_log10_nfa;
  };
  const PooledTemplate pooled = PoolTemplates(view.Compared(), std::vector{neighbour.Compared()});
  const double together = neg_log10_nfa(pooled.keypoints, pooled.matches);
  EXPECT_GT(together, neg_log10_nfa(view.keypoints, view.matches) + 3);
  EXPECT_GT(together, neg_log10_nfa(neighbour.keypoints, neighbour.matches) + 3);
}

}  // namespace
}  // namespace victorious
