#include "experiments/steady_lock.h"

#include <gtest/gtest.h>

#include "testing/drawn_flight.h"

namespace victorious {
namespace {

using testing::PhotoOf;
using testing::ShortFlight;
using testing::WriteVideo;

double OverlapWithTruth(const testing::SyntheticFlight& flight, const TrackingComparisonStep& step,
                        const Polygon& outline) {
  for (const testing::TruthRow& row : flight.Truth(static_cast<int>(step.frame))) {
    if (row.object_index == 0) return IntersectionOverUnion(outline, ConvexHull(row.outline));
  }
  return 0;
}

TEST(CompareTracking, RecognizerKeepsTheLock) {
  const testing::SyntheticFlight flight(ShortFlight(40));
  const testing::ScratchFolder folder;
  WriteVideo(flight, folder / "flight.mkv");
  const Photo photos[] = {PhotoOf(flight, 0)};
  const ObjectModel model = MakePhotoModel("crate", photos, std::nullopt, {}).value();
  const Recognizer recognizer = Recognizer::Create({model}, FeatureOptions().engine, {}).value();
  const auto extractor = MakeFeatureExtractor({}).value();
  const auto reader = VideoReader::Open((folder / "flight.mkv").string(), {}).value();
  const std::vector<TrackingComparisonStep> steps = CompareTracking(*reader, recognizer, *extractor, {}, {}).value();
  ASSERT_GT(steps.size(), 30U);
  int in_view = 0;
  int together = 0;
  int alone = 0;
  for (const TrackingComparisonStep& step : steps) {
    for (const testing::TruthRow& row : flight.Truth(static_cast<int>(step.frame))) {
      if (row.object_index == 0 && row.visible > 0.7) ++in_view;
    }
    constexpr double kLocked = 0.7;
    if (step.together && OverlapWithTruth(flight, step, *step.together) > kLocked) ++together;
    if (step.alone && OverlapWithTruth(flight, step, *step.alone) > kLocked) ++alone;
  }
  EXPECT_GE(together, 0.9 * in_view);
  EXPECT_LT(alone, together) << "alone, it does not come back after the object left the frame";
}

TEST(CompareTracking, WithoutTrackGivesNoSteps) {
  const testing::SyntheticFlight flight(ShortFlight(3));
  const testing::ScratchFolder folder;
  WriteVideo(flight, folder / "flight.mkv");
  testing::FlightOptions other = ShortFlight();
  other.seed = 99;
  const Photo photos[] = {PhotoOf(testing::SyntheticFlight(other), 0)};
  const ObjectModel model = MakePhotoModel("other", photos, std::nullopt, {}).value();
  const Recognizer recognizer = Recognizer::Create({model}, FeatureOptions().engine, {}).value();
  const auto reader = VideoReader::Open((folder / "flight.mkv").string(), {}).value();
  EXPECT_TRUE(CompareTracking(*reader, recognizer, *MakeFeatureExtractor({}).value(), {}, {})->empty());
}

}  // namespace
}  // namespace victorious
