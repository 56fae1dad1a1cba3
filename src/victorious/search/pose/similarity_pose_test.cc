#include "victorious/search/pose/similarity_pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/homography.h"

namespace victorious {
namespace {

const Polygon kPlanarOutline = BoxCorners({0, 0, 200, 150});

struct PlanarWorld {
  std::vector<Keypoint> scene;
  std::vector<Keypoint> model;
  MatchSet matches;

  void Add(const Eigen::Vector2d& template_place, const Eigen::Vector2d& scene_place) {
    matches.push_back({static_cast<std::uint32_t>(scene.size()), static_cast<std::uint32_t>(model.size()), 0.5F});
    model.push_back({static_cast<float>(template_place.x()), static_cast<float>(template_place.y()), 2, 0});
    scene.push_back({static_cast<float>(scene_place.x()), static_cast<float>(scene_place.y()), 2, 0});
  }
  [[nodiscard]] std::vector<PlanarFit> Poses(const PoseOptions& options = {}) const {
    return EstimatePoses(scene, model, matches, kPlanarOutline, 640.0 * 480.0, options);
  }
};

PlanarWorld Planar(const Eigen::Matrix3d& map, int count, double noise_px, std::uint64_t seed) {
  Random random(seed);
  PlanarWorld world;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d place(random.Uniform(0, 200), random.Uniform(0, 150));
    world.Add(place, ApplyHomography(map, place) + noise_px * Eigen::Vector2d(random.Normal(), random.Normal()));
  }
  return world;
}

double OutlineAgreement(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  Polygon pa;
  Polygon pb;
  for (const Eigen::Vector2d& corner : kPlanarOutline) {
    pa.push_back(ApplyHomography(a, corner));
    pb.push_back(ApplyHomography(b, corner));
  }
  return IntersectionOverUnion(pa, pb);
}

TEST(SimilarityPose, FindsEveryInstance) {
  PlanarWorld world = Planar(Similarity2{0.6, 0.4, {60, 50}}.Matrix(), 30, 0.7, 1);
  const PlanarWorld second = Planar(Similarity2{0.8, -2.0, {420, 300}}.Matrix(), 20, 0.7, 2);
  for (std::size_t i = 0; i < second.scene.size(); ++i) {
    world.Add({second.model[i].x, second.model[i].y}, {second.scene[i].x, second.scene[i].y});
  }
  const std::vector<PlanarFit> fits = world.Poses();
  ASSERT_EQ(fits.size(), 2U);
  EXPECT_NEAR(fits[0].scene_from_template.scale, 0.6, 0.02);
  EXPECT_NEAR(fits[0].scene_from_template.rotation_rad, 0.4, 0.02);
  EXPECT_NEAR(fits[1].scene_from_template.scale, 0.8, 0.02);
  EXPECT_GE(fits[0].inliers.size(), 28U);
  EXPECT_GE(fits[1].inliers.size(), 18U);
}

TEST(SimilarityPose, OutlineFollowsPerspectiveIfSupported) {
  Eigen::Matrix3d tilted;
  tilted << 1.0, 0.1, 100, 0.05, 0.7, 80, 6e-4, 2e-4, 1;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<PlanarFit> fits = Planar(tilted, 80, 0.7, seed).Poses();
    ASSERT_GE(fits.size(), 1U) << seed;
    EXPECT_GT(OutlineAgreement(fits[0].scene_from_template_plane, tilted), 0.95) << seed;
    EXPECT_GT(OutlineAgreement(fits[0].scene_from_template_plane, tilted),
              OutlineAgreement(fits[0].scene_from_template.Matrix(), tilted))
        << seed;
  }
}

TEST(SimilarityPose, FewMatchesKeepTheSimilarity) {
  const Similarity2 truth{1.1, 0.2, {100, 100}};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<PlanarFit> fits = Planar(truth.Matrix(), 5, 1.0, seed).Poses();
    ASSERT_EQ(fits.size(), 1U) << seed;
    EXPECT_GT(OutlineAgreement(fits[0].scene_from_template_plane, truth.Matrix()), 0.85) << seed;
  }
}

TEST(SimilarityPose, CoincidentTemplateKeypointsGiveNoSupport) {
  PlanarWorld world;
  for (int i = 0; i < 8; ++i) world.Add({10, 10}, {100.0 + 30 * i, 90});
  EXPECT_TRUE(world.Poses().empty());
  EXPECT_TRUE(PlanarWorld().Poses().empty());
}

// Three template keypoints match many scene keypoints (windows of a house). Their consensus exceeds that of the
// object's ten keypoints; they are no instance and must not hide the object.
TEST(SimilarityPose, RepeatedPatternHidesNoInstance) {
  PlanarWorld world = Planar(Similarity2{1.0, 0.3, {60, 50}}.Matrix(), 10, 0.7, 4);
  const std::vector<Keypoint> object = world.model;
  for (const Eigen::Vector2d& window : {Eigen::Vector2d(20, 20), Eigen::Vector2d(60, 20), Eigen::Vector2d(20, 70)}) {
    const auto keypoint = static_cast<std::uint32_t>(world.model.size());
    world.Add(window, window + Eigen::Vector2d(350, 250));
    for (int copy = 1; copy < 5; ++copy) {
      world.matches.push_back({static_cast<std::uint32_t>(world.scene.size()), keypoint, 0.5F});
      world.scene.push_back(
          {static_cast<float>(window.x() + 350 + 0.4 * copy), static_cast<float>(window.y() + 250), 2, 0});
    }
  }
  const std::vector<PlanarFit> fits = world.Poses();
  ASSERT_EQ(fits.size(), 1U);
  EXPECT_EQ(fits[0].distinct_inliers, 10U);
  for (const FitInlier& inlier : fits[0].inliers) EXPECT_THAT(object, ::testing::Contains(inlier.keypoint_in_template));
}

// Matches at the right position with another orientation or scale are inliers, but not listed in agreeing_residuals_px.
TEST(SimilarityPose, AgreeingResidualsAreOfConsistentRotationAndScale) {
  PlanarWorld world = Planar(Similarity2{1, 0, {60, 50}}.Matrix(), 18, 0.7, 4);
  for (std::size_t i = 0; i < 6; ++i) world.scene[i].orientation_rad = 2;
  for (std::size_t i = 6; i < 12; ++i) world.scene[i].scale_px = 8;
  const std::vector<PlanarFit> fits = world.Poses();
  ASSERT_EQ(fits.size(), 1U);
  EXPECT_EQ(fits[0].distinct_inliers, 18U);
  ASSERT_EQ(fits[0].agreeing_residuals_px.size(), 6U);
  EXPECT_TRUE(std::ranges::is_sorted(fits[0].agreeing_residuals_px));
  EXPECT_LT(fits[0].agreeing_residuals_px.back(), 6);
}

TEST(SimilarityPose, IsDeterministicBySeed) {
  const PlanarWorld world = Planar(Similarity2{0.9, 1.0, {200, 100}}.Matrix(), 60, 2.0, 3);
  EXPECT_EQ(world.Poses()[0].scene_from_template_plane, world.Poses()[0].scene_from_template_plane);
}

TEST(SimilarityPose, MinInliersIsTheNumberOfDistinctTemplateKeypointsThatAPoseNeeds) {
  const PlanarWorld world = Planar(Similarity2{0.8, 0.4, {60, 50}}.Matrix(), 6, 0, 3);
  EXPECT_EQ(world.Poses({.min_inliers = 6}).size(), 1U);
  EXPECT_TRUE(world.Poses({.min_inliers = 7}).empty());
}

TEST(SimilarityPose, MaxInstancesEndsTheSearchForMore) {
  PlanarWorld world = Planar(Similarity2{0.6, 0.4, {60, 50}}.Matrix(), 30, 0.7, 1);
  const PlanarWorld second = Planar(Similarity2{0.8, -2.0, {420, 300}}.Matrix(), 20, 0.7, 2);
  for (std::size_t i = 0; i < second.scene.size(); ++i) {
    world.Add({second.model[i].x, second.model[i].y}, {second.scene[i].x, second.scene[i].y});
  }
  EXPECT_EQ(world.Poses({.max_instances = 2}).size(), 2U);
  const std::vector<PlanarFit> one = world.Poses({.max_instances = 1});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_NEAR(one[0].scene_from_template.scale, 0.6, 0.02) << "the instance with more matches";
}

}  // namespace
}  // namespace victorious
