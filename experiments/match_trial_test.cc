#include "experiments/match_trial.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "experiments/match_filters.h"
#include "experiments/true_matches.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// A scene 10 m in front of a camera with a focal length of 100 px: 1 m is 10 px.
AnnotatedImage SceneWith(const std::vector<Rigid3>& fits) {
  AnnotatedImage scene;
  scene.pinhole = {100, 100, 50, 50, 100, 100};
  for (const Rigid3& fit : fits)
    scene.objects.push_back({.model = "object", .camera_from_model = fit, .view = {}, .box = {}, .visible = 1});
  return scene;
}

Rigid3 At(double x_m, double y_m) { return {Eigen::Quaterniond::Identity(), {x_m, y_m, 10}}; }

Keypoint KeypointAt(float x, float y, float scale_px = 1) {
  return {.x = x, .y = y, .scale_px = scale_px, .orientation_rad = 0};
}

TEST(MatchTruth, IsTheProjectionByTheTruePose) {
  const std::vector<Point3> points = {{0, 0, 0}, {2, 0, 0}};
  const MatchTruth truth(SceneWith({At(0, 0)}), "object", points, 8);
  EXPECT_EQ(truth.Label(KeypointAt(50, 50), 0), MatchLabel::kTrue);
  EXPECT_EQ(truth.Label(KeypointAt(70, 52.9F), 1), MatchLabel::kTrue);
  EXPECT_EQ(truth.Label(KeypointAt(70, 53.1F), 1), MatchLabel::kNear);
  EXPECT_EQ(truth.Label(KeypointAt(70, 55, 6), 1), MatchLabel::kTrue) << "a large keypoint is placed less exactly";
  EXPECT_EQ(truth.Label(KeypointAt(70, 61), 1), MatchLabel::kFalse);
  EXPECT_EQ(truth.Label(KeypointAt(50, 50), 1), MatchLabel::kFalse) << "another point of the object";
  const std::vector<Keypoint> scene = {KeypointAt(50, 50), KeypointAt(70, 55), KeypointAt(10, 10)};
  const MatchCount count = truth.Count(scene, {{0, 0, 0.5F}, {1, 1, 0.5F}, {2, 1, 0.5F}});
  EXPECT_EQ(count.correct, 1);
  EXPECT_EQ(count.near, 1);
  EXPECT_EQ(count.FalseMatches(), 1);
}

TEST(MatchTruth, AcceptsAnyObjectOfTheModelOnly) {
  AnnotatedImage scene = SceneWith({At(-3, 0), At(3, 0)});
  const std::vector<Point3> points = {{0, 0, 0}};
  EXPECT_EQ(MatchTruth(scene, "object", points, 8).Label(KeypointAt(20, 50), 0), MatchLabel::kTrue);
  EXPECT_EQ(MatchTruth(scene, "object", points, 8).Label(KeypointAt(80, 50), 0), MatchLabel::kTrue);
  EXPECT_EQ(MatchTruth(scene, "other", points, 8).Label(KeypointAt(80, 50), 0), MatchLabel::kFalse);
}

TEST(MatchTruth, OccludedOrOutsidePointsHaveNoMatch) {
  AnnotatedImage scene = SceneWith({At(0, 0)});
  const std::vector<Point3> points = {{0, 0, 0}, {2, 0, 0}, {8, 0, 0}};
  scene.depth_m = cv::Mat(100, 100, CV_32FC1, cv::Scalar(10));
  scene.depth_m(cv::Rect(0, 0, 60, 100)).setTo(4);  // a wall in front of the first point
  const MatchTruth truth(scene, "object", points, 8);
  EXPECT_EQ(truth.Label(KeypointAt(50, 50), 0), MatchLabel::kFalse);
  EXPECT_EQ(truth.Label(KeypointAt(70, 50), 1), MatchLabel::kTrue);
  EXPECT_EQ(truth.Label(KeypointAt(130, 50), 2), MatchLabel::kFalse);
}

TEST(MatchTruth, OcclusionToleranceScalesWithObjectSize) {
  AnnotatedImage scene = SceneWith({At(0, 0)});
  const std::vector<Point3> points = {{0, 0, 0}};
  scene.depth_m = cv::Mat(100, 100, CV_32FC1, cv::Scalar(9.8));
  EXPECT_EQ(MatchTruth(scene, "object", points, 4).Label(KeypointAt(50, 50), 0), MatchLabel::kFalse)
      << "a shelf before a toy";
  EXPECT_EQ(MatchTruth(scene, "object", points, 30).Label(KeypointAt(50, 50), 0), MatchLabel::kTrue)
      << "an aircraft's own skin";
}

TEST(DegradeImage, AppliesTheOrderOfACamera) {
  cv::Mat image(64, 64, CV_8UC3, cv::Scalar(90, 120, 60));
  cv::Mat again = image.clone();
  const ImageDegradation degradation{.degrade = {.noise = 0.2}, .jpeg_quality = 50};
  ASSERT_TRUE(DegradeImage(degradation, 3, image).has_value());
  ASSERT_TRUE(DegradeImage(degradation, 3, again).has_value());
  EXPECT_EQ(cv::norm(image, again), 0) << "by seed";
  cv::Mat clean(64, 64, CV_8UC3, cv::Scalar(90, 120, 60));
  EXPECT_GT(cv::norm(image, clean), 0);
  ASSERT_TRUE(DegradeImage({}, 3, clean).has_value());
  EXPECT_EQ(clean.at<cv::Vec3b>(5, 5), cv::Vec3b(90, 120, 60));
}

// End to end: an image rendered from a scene file shows the object at its true pose.
TEST(SceneRenderer, RendersObjectsAtTheirTruth) {
  const CancelToken cancel;
  Expected<Renderer> renderer = Renderer::Create({.software = true});
  ASSERT_TRUE(renderer.has_value());
  const Expected<SceneRenderer> town =
      SceneRenderer::Load(std::filesystem::path(VICTORIOUS_SCENES) / "chapter3_jeep.json", *renderer, cancel);
  ASSERT_TRUE(town.has_value()) << town.error().message;
  const Expected<AnnotatedImage> scene = town->Draw(0);
  ASSERT_TRUE(scene.has_value());
  const LabelledObject* const jeep = scene->Find("jeep");
  ASSERT_NE(jeep, nullptr);
  EXPECT_EQ(scene->Find("tank"), nullptr);
  EXPECT_NEAR(DegreesFromRadians(jeep->view.off_nadir_rad), 60, 5) << "as in section 3.5.3";
  EXPECT_NEAR(DegreesFromRadians(jeep->view.azimuth_rad), 150, 5);
  // A point in the middle of the object projects into its box.
  const std::optional<Eigen::Vector2d> middle = scene->pinhole.Project(jeep->camera_from_model.Apply({0, 0, 1}));
  ASSERT_TRUE(middle.has_value());
  EXPECT_TRUE(jeep->box.Contains(middle->x(), middle->y()));
}

// Writes an OBJ file of some folded squares, which have features at their corners.
void WriteCad(const std::filesystem::path& path, double side_m) {
  std::ofstream(path) << fmt::format(
      "v 0 0 0\nv {0} 0 0\nv {0} {0} 0\nv 0 {0} 0\nv 0 {0} {0}\nf 1 2 3\nf 1 3 4\nf 3 4 5\nf 1 4 5\n", side_m);
}

TEST(LoadOrBuildModel, RebuildsOnlyForOtherContentOrOptions) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "kept_model_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  int made = 0;
  const ExperimentSettings settings{
      .data = {}, .scenes = {}, .out = folder / "out", .progress = [&](std::string_view) { ++made; }};
  CadModelOptions options;
  options.sphere.step_deg = 45;
  const std::filesystem::path cad = folder / "object.obj";
  WriteCad(cad, 3);
  const auto first = LoadOrBuildModel(settings, cad, options);
  ASSERT_TRUE(first.has_value()) << first.error().message;
  EXPECT_EQ((*first)->name, "object");
  const auto kept = LoadOrBuildModel(settings, cad, options);
  ASSERT_TRUE(kept.has_value());
  EXPECT_EQ(made, 1);
  EXPECT_EQ((*kept)->id, (*first)->id);
  WriteCad(cad, 5);
  const auto changed = LoadOrBuildModel(settings, cad, options);
  ASSERT_TRUE(changed.has_value());
  EXPECT_EQ(made, 2);
  EXPECT_GT((*changed)->box_m->sizes().x(), 4);
  options.sphere.step_deg = 60;
  ASSERT_TRUE(LoadOrBuildModel(settings, cad, options).has_value());
  EXPECT_EQ(made, 3);
}

TEST(MatchSetup, ThesisAndDefaultDiffer) {
  EXPECT_EQ(ThesisSetup().features.impulse_fraction, 1);
  EXPECT_EQ(ThesisSetup().recognize.cascade.radius_px, 75);
  EXPECT_LT(DefaultSetup().features.contrast_threshold, ThesisSetup().features.contrast_threshold);
}

TEST(MakeMatchFilters, HaveTheirNames) {
  std::vector<std::string> names;
  for (const MatchFilter& filter : MakeMatchFilters({})) names.push_back(filter.name);
  EXPECT_THAT(names, ::testing::IsSupersetOf({"none", "neighbours (Video Google)", "cascade", "MLESAC alone",
                                              "OpenCV's homography alone"}));
}

}  // namespace
}  // namespace victorious
