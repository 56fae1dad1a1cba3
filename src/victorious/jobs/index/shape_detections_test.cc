#include "victorious/jobs/index/shape_detections.h"

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

TEST(ShapeSearchInterval, IsThatOfTheOptionsWhereTracksLast) {
  ShapeSearchOptions options;
  options.interval_s = 0.5;
  FollowOptions follow;
  EXPECT_EQ(ShapeSearchInterval(options, follow, 10, 1), 0.5);
  EXPECT_EQ(ShapeSearchInterval(options, follow, 10, 2.5), 1.25) << "large frames";
  EXPECT_EQ(ShapeSearchInterval(options, follow, 0, 1), 0.5);
}

TEST(ShapeSearchInterval, EndsBeforeATrackDoes) {
  FollowOptions follow;
  follow.track.unconfirmed_frames = 30;
  ShapeSearchOptions options;
  options.interval_s = 2;
  EXPECT_NEAR(ShapeSearchInterval(options, follow, 60, 1), 0.4, 1e-9);
  follow.enabled = false;
  EXPECT_EQ(ShapeSearchInterval(options, follow, 60, 1), 2);
}

Detection DetectionAt(std::size_t model, double x_px, double decades) {
  Detection detection{.model_index = model, .view = 0};
  detection.box = {x_px, 0, 100, 50};
  detection.neg_log10_nfa = decades;
  detection.score = ComputeScore(decades);
  return detection;
}

TEST(JoinDetections, OfOneModelTheOneWithMoreEvidenceStays) {
  std::vector<Detection> detections = {DetectionAt(0, 0, 2), DetectionAt(0, 500, 20)};
  JoinDetections({{DetectionAt(0, 10, 5), true, {}}, {DetectionAt(0, 490, 5), true, {}}}, detections);
  ASSERT_EQ(detections.size(), 2U);
  EXPECT_EQ(detections[0].neg_log10_nfa, 20) << "by keypoints";
  EXPECT_EQ(detections[1].box.x, 10) << "by shape";
}

TEST(JoinDetections, AShapeThatWasNotExaminedReplacesNothing) {
  std::vector<Detection> detections = {DetectionAt(0, 0, 2)};
  JoinDetections({{DetectionAt(0, 10, 5), false, {}}}, detections);
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].box.x, 0);
}

TEST(JoinDetections, AnotherModelIsAnotherHypothesis) {
  std::vector<Detection> detections = {DetectionAt(0, 0, 2)};
  JoinDetections({{DetectionAt(1, 10, 5), true, {}}, {DetectionAt(2, 0, 1), true, {}}}, detections);
  ASSERT_EQ(detections.size(), 2U) << "the one with less evidence is explained";
  EXPECT_EQ(detections[0].model_index, 1U);
  EXPECT_EQ(detections[1].model_index, 0U);
}

std::vector<double> Significant(double decades, const LooksBefore& before) {
  std::vector<ShapeDetection> by_shape = {{DetectionAt(0, 0, decades), true, before}};
  (void)KeepSignificant({}, by_shape);
  std::vector<double> kept;
  for (const ShapeDetection& one : by_shape) {
    EXPECT_EQ(one.detection.score, ComputeScore(one.detection.neg_log10_nfa));
    kept.push_back(one.detection.neg_log10_nfa);
  }
  return kept;
}

constexpr LooksBefore kSeenBefore{.looks = 4, .sum = 4 * 9.0};
constexpr LooksBefore kMissedBefore{.looks = 4, .sum = 4 * kDecadesWhereMissed};

TEST(KeepSignificant, AWeakMatchCountsWhereItWasSeenBefore) {
  const std::vector<double> kept = Significant(1.5, kSeenBefore);
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_DOUBLE_EQ(kept[0], (1.5 + kDecadesOfOnePlace + 36) / 5);
  EXPECT_TRUE(Significant(1.5, {}).empty());
  EXPECT_TRUE(Significant(1.5, kMissedBefore).empty());
}

TEST(KeepSignificant, AStrongMatchGoesWhereNothingWasSeenBefore) {
  EXPECT_TRUE(Significant(6, kMissedBefore).empty());
  EXPECT_EQ(Significant(6, {}), std::vector<double>{6});
  EXPECT_EQ(Significant(30, kMissedBefore), std::vector<double>{30}) << "a tree may have hidden it";
}

TEST(KeepSignificant, FewLooksDecideNothing) {
  LooksBefore few = kSeenBefore;
  few.looks = kMinLooksBefore - 1;
  EXPECT_TRUE(Significant(1.5, few).empty());
  EXPECT_EQ(Significant(6, {.looks = kMinLooksBefore - 1, .sum = 0}), std::vector<double>{6});
}

TEST(KeepSignificant, OfTwoModelsInOnePlaceTheOneStaysThatAllFramesShowBetter) {
  std::vector<ShapeDetection> by_shape = {{DetectionAt(0, 0, 3), true, {.looks = 4, .sum = 4 * 5.0}},
                                          {DetectionAt(1, 10, 1.5), true, kSeenBefore},
                                          {DetectionAt(0, 300, 5), true, {}}};
  EXPECT_TRUE(KeepSignificant({}, by_shape).empty());
  ASSERT_EQ(by_shape.size(), 2U);
  EXPECT_EQ(by_shape[0].detection.model_index, 1U);
  EXPECT_EQ(by_shape[1].detection.box.x, 300);
}

TEST(KeepSignificant, LaterFramesDecideWhatIsWeakAndNewWhereNothingStands) {
  const auto undecided = [](const ShapeDetection& weak) {
    std::vector<ShapeDetection> by_shape = {weak, {DetectionAt(1, 500, 9), true, {}}};
    const std::size_t count = KeepSignificant({}, by_shape).size();
    EXPECT_EQ(by_shape.size(), 1U);
    return count;
  };
  EXPECT_EQ(undecided({DetectionAt(0, 0, 2), true, {}}), 1U);
  EXPECT_EQ(undecided({DetectionAt(0, 510, 2), true, {}}), 0U) << "another model stands there";
  EXPECT_EQ(undecided({DetectionAt(0, 0, 2), true, {.is_explained = true}}), 0U);
  EXPECT_EQ(undecided({DetectionAt(0, 0, 2), true, kMissedBefore}), 0U) << "decided";
  EXPECT_EQ(undecided({DetectionAt(0, 0, 2), false, {}}), 0U);
  EXPECT_EQ(undecided({DetectionAt(0, 0, 0.5), true, {}}), 0U) << "too weak to be followed";
}

TEST(SetShapeErrors, RaisesWhatIsTooSmall) {
  ShapeSearchOptions options;
  ObjectPose exact{.sigma_rad = 1e-6, .range_m = 100, .sigma_range_m = 0.1};
  exact.focal_px = 1000;
  exact.view.emplace();
  SetShapeErrors(exact, options);
  EXPECT_NEAR(exact.sigma_rad, options.centre_sigma_px / 1000, 1e-12);
  EXPECT_NEAR(exact.sigma_range_m, 100 * options.range_sigma_fraction, 1e-9);
  EXPECT_NEAR(exact.view->sigma_rad, RadiansFromDegrees(options.view_sigma_deg), 1e-12);
  ObjectPose rough{.sigma_rad = 0.1, .range_m = 100, .sigma_range_m = 50};
  rough.focal_px = 1000;
  SetShapeErrors(rough, options);
  EXPECT_EQ(rough.sigma_rad, 0.1);
  EXPECT_EQ(rough.sigma_range_m, 50);
}

TEST(ShapeSearchOptions, AreReadFromParameters) {
  IndexOptions options;
  ASSERT_TRUE(SetFromJsonText(R"({"shape.enabled": false, "shape.interval_s": 3})", CollectFields(options)));
  EXPECT_FALSE(options.shape.enabled);
  EXPECT_EQ(options.shape.interval_s, 3);
}

}  // namespace
}  // namespace victorious
