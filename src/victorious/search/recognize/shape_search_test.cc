// The search by shape (search/recognize/shape_search.h) on scenes with a rendered object of one grey: recognize/ does
// not render.
#include "victorious/search/recognize/shape_search.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>
#include <opencv2/imgproc.hpp>

#include "testing/data.h"
#include "testing/plain_scene.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/box.h"
#include "victorious/object/model/relit_template_folder.h"
#include "victorious/object/model/relit_views.h"
#include "victorious/search/recognize/model_shape_search.h"
#include "victorious/search/recognize/shape_templates.h"
#include "victorious/search/recognize/upright_part.h"

namespace victorious {
namespace {

using testing::DrawFields;
using testing::kOffNadirOfScene_deg;
using testing::PlainModel;
using testing::PlainScene;

PlainScene SceneOfShape(std::size_t number) {
  return testing::MakePlainScene(number, DrawFields(number), 60.0 + 30 * static_cast<double>(number));
}

class ShapeSearchTest : public ::testing::Test {
 protected:
  ShapeSearchTest()
      : surfaces_{MakeRelitViews(PlainModel()).value()},
        search_({&PlainModel(), 1}, surfaces_, testing::CellsOfFields()) {}

  std::vector<ShapeMatch> Find(const cv::Mat& grey, const FrameConditions& conditions, double decades = 4) {
    return search_.Find(grey, conditions, decades).value();
  }

  std::vector<std::shared_ptr<const RelitTemplateSource>> surfaces_;
  ShapeSearch search_;
};

TEST_F(ShapeSearchTest, FindsAnObjectOfOneGrey) {
  for (const std::size_t number : {2, 5}) {
    const PlainScene scene = SceneOfShape(number);
    const std::vector<ShapeMatch> found = Find(scene.grey, scene.conditions);
    ASSERT_EQ(found.size(), 1U) << number;
    EXPECT_LT((found[0].centre_px - scene.centre_px).norm(), 1) << number;
    EXPECT_LT(std::abs(WrapAngle(found[0].to_camera.azimuth_rad - scene.azimuth_rad)), RadiansFromDegrees(4)) << number;
  }
}

TEST_F(ShapeSearchTest, FindsNothingWhereThereIsNone) {
  const PlainScene scene = SceneOfShape(2);
  for (const std::uint64_t seed : {11, 12, 13}) {
    EXPECT_TRUE(Find(DrawFields(seed), scene.conditions).empty()) << seed;
  }
}

TEST_F(ShapeSearchTest, NeedsTheHeightAndTheVertical) {
  const PlainScene scene = SceneOfShape(2);
  FrameConditions unknown = scene.conditions;
  unknown.height_above_ground_m.reset();
  EXPECT_TRUE(Find(scene.grey, unknown, -100).empty());
  unknown = scene.conditions;
  unknown.vertical.reset();
  EXPECT_TRUE(Find(scene.grey, unknown, -100).empty());
}

TEST_F(ShapeSearchTest, FindsAnObjectOfAnySizeWithoutACamera) {
  const PlainScene scene = SceneOfShape(5);
  const std::vector<ShapeMatch> known = Find(scene.grey, scene.conditions);
  const std::vector<ShapeMatch> found = search_.FindInAnyView(scene.grey, 0).value();
  ASSERT_EQ(known.size(), 1U);
  ASSERT_FALSE(found.empty());
  EXPECT_LT((found[0].centre_px - scene.centre_px).norm(), 6);
  EXPECT_NEAR(found[0].pixels_per_m / known[0].pixels_per_m, 1, 0.12);
  EXPECT_NEAR(found[0].to_camera.off_nadir_rad, RadiansFromDegrees(kOffNadirOfScene_deg), RadiansFromDegrees(11));
  EXPECT_LT(found[0].neg_log10_nfa, kDecadesPerResponse * (found[0].response - kResponseOfOneFalseAlarm) - 1)
      << "many views were tried";
}

TEST_F(ShapeSearchTest, AnAssumedCameraStandsInForAnUnknownOne) {
  const PlainScene scene = SceneOfShape(5);
  const std::vector<ShapeMatch> known = Find(scene.grey, scene.conditions);
  search_.AssumeCamera(scene.conditions);
  const std::vector<ShapeMatch> found = Find(scene.grey, {}, 2);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_DOUBLE_EQ(found[0].response, known[0].response);
  const double of_paint =
      found[0].paint == TemplatePaint::kPlain ? kResponseOfOneFalseAlarmPlain : kResponseOfOneFalseAlarm;
  EXPECT_DOUBLE_EQ(found[0].neg_log10_nfa,
                   kDecadesPerResponse * (found[0].response - of_paint) - kDecadesOfAssumedCamera);
}

// A height of the camera that is wrong by some per cent costs a part of the evidence, not the object.
TEST_F(ShapeSearchTest, FindsAnObjectWithAHeightThatIsSomewhatWrong) {
  const PlainScene scene = SceneOfShape(5);
  const std::vector<ShapeMatch> right = Find(scene.grey, scene.conditions);
  ASSERT_EQ(right.size(), 1U);
  for (const double factor : {0.95, 1.05}) {
    FrameConditions wrong = scene.conditions;
    *wrong.height_above_ground_m *= factor;
    const std::vector<ShapeMatch> found = Find(scene.grey, wrong);
    ASSERT_EQ(found.size(), 1U) << factor;
    EXPECT_LT((found[0].centre_px - scene.centre_px).norm(), 6) << factor;
    EXPECT_LT(found[0].neg_log10_nfa, right[0].neg_log10_nfa) << factor;
  }
}

// Beyond the border the last pixels are repeated: there stripes as wide as the object are as long as it is.
TEST_F(ShapeSearchTest, StripesThatLeaveTheFrameAreNoStrongPlaces) {
  const PlainScene scene = SceneOfShape(5);
  cv::Mat grey(scene.grey.size(), CV_8U, cv::Scalar(120));
  constexpr int kLength = 20;
  const int side = static_cast<int>(0.6 * scene.box.width);
  for (int x = 15; x < grey.cols; x += 2 * side) {
    for (const int y : {0, grey.rows - kLength}) {
      cv::rectangle(grey, {x, y, side, kLength}, cv::Scalar(220), cv::FILLED);
    }
  }
  const ShapeSearch::Templates templates({&PlainModel(), 1}, surfaces_, testing::CellsOfFields());
  const ModelShapeSearch search(0, PlainModel(), templates);
  const FramePyramid frame(grey);
  for (const FrameTile& tile : DivideFrame(*scene.conditions.vertical, grey.size())) {
    const std::vector<Place> places = search.FindPlaces(frame, scene.conditions, tile).value();
    for (const Place& place : places) {
      EXPECT_LT(place.response, 4.6) << place.at_px.transpose();
    }
  }
}

TEST_F(ShapeSearchTest, FindsAnObjectAgain) {
  const PlainScene scene = SceneOfShape(5);
  const std::vector<ShapeMatch> first = Find(scene.grey, scene.conditions);
  ASSERT_EQ(first.size(), 1U);
  FeatureSet features{.keypoints = {}, .descriptors = {}, .image_width = 640, .image_height = 480};
  const Detection last = search_.MakeDetection(first[0], features).value();
  const auto again = search_.FindAgain(scene.grey, scene.conditions, last, {0, 0}).value();
  ASSERT_TRUE(again.has_value());
  EXPECT_LT((again->centre_px - scene.centre_px).norm(), 5);
  EXPECT_GT(again->neg_log10_nfa, first[0].neg_log10_nfa);
  EXPECT_FALSE(search_.FindAgain(DrawFields(11), scene.conditions, last, {0, 0}).value().has_value());
}

TEST_F(ShapeSearchTest, FindsNoObjectOfAnotherSize) {
  PlainScene scene = SceneOfShape(5);
  *scene.conditions.height_above_ground_m *= 1.6;
  EXPECT_TRUE(Find(scene.grey, scene.conditions).empty());
}

TEST_F(ShapeSearchTest, ADetectionLiesWhereTheObjectIs) {
  const PlainScene scene = SceneOfShape(5);
  const std::vector<ShapeMatch> found = Find(scene.grey, scene.conditions);
  ASSERT_EQ(found.size(), 1U);
  FeatureSet features{.keypoints = {}, .descriptors = {}, .image_width = 640, .image_height = 480};
  features.keypoints.resize(3);
  features.descriptors.resize(3 * kDescriptorSize);
  const Detection detection = search_.MakeDetection(found[0], features).value();
  EXPECT_EQ(detection.cue, DetectionCue::kShape);
  EXPECT_GT(IntersectionOverUnion(detection.box, scene.box), 0.7);
  ASSERT_GT(detection.fit.inliers.size(), 10U);
  EXPECT_EQ(features.size(), 3 + detection.fit.inliers.size());
  EXPECT_EQ(features.descriptors.size(), kDescriptorSize * features.size());
  for (const FitInlier& inlier : detection.fit.inliers) {
    const Keypoint& at = features.keypoints[inlier.scene_keypoint];
    EXPECT_GT(at.x, scene.box.x - 10);
    EXPECT_LT(at.x, scene.box.x + scene.box.width + 10);
    const Eigen::Vector2d by_fit =
        detection.fit.scene_from_template.Apply({inlier.keypoint_in_template.x, inlier.keypoint_in_template.y});
    EXPECT_LT((by_fit - Eigen::Vector2d(at.x, at.y)).norm(), 12);
  }
}

// What is kept on disk is what is drawn: another search draws nothing and finds the same.
TEST_F(ShapeSearchTest, FindsTheSameWithTemplatesFromDisk) {
  const PlainScene scene = SceneOfShape(2);
  const std::vector<ShapeMatch> drawn = Find(scene.grey, scene.conditions, -10);
  ASSERT_FALSE(drawn.empty());
  const testing::ScratchFolder folder;
  const RelitTemplateFolder kept(folder.path(), "build");
  const std::vector<ObjectModel> models = {PlainModel()};
  const auto find = [&] {
    return ShapeSearch(models, MakeRelitViews(models, &kept).value(), testing::CellsOfFields())
        .Find(scene.grey, scene.conditions, -10)
        .value();
  };
  for (const std::vector<ShapeMatch>& found : {find(), find()}) {
    ASSERT_EQ(found.size(), drawn.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].response, drawn[i].response);
      EXPECT_EQ(found[i].centre_px, drawn[i].centre_px);
    }
  }
  const std::filesystem::file_time_type long_ago{};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
    if (!entry.path().filename().string().starts_with("shape-")) continue;
    files.push_back(entry.path());
    std::filesystem::last_write_time(entry.path(), long_ago);
  }
  EXPECT_FALSE(files.empty());
  find();
  for (const std::filesystem::path& file : files) EXPECT_EQ(std::filesystem::last_write_time(file), long_ago) << file;
}

TEST_F(ShapeSearchTest, IsTheSameForAnyNumberOfThreads) {
  const PlainScene scene = SceneOfShape(2);
  const auto find = [&](int threads) {
    oneapi::tbb::task_arena arena(threads);
    return arena.execute([&] { return Find(scene.grey, scene.conditions, -10); });
  };
  const std::vector<ShapeMatch> alone = find(1);
  const std::vector<ShapeMatch> together = find(2);
  ASSERT_EQ(alone.size(), together.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(alone[i].response, together[i].response);
    EXPECT_EQ(alone[i].centre_px, together[i].centre_px);
  }
}

}  // namespace
}  // namespace victorious
