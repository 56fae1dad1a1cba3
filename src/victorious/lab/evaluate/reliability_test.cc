#include "victorious/lab/evaluate/reliability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace victorious {
namespace {

using ::testing::DoubleNear;
using ::testing::HasSubstr;
using ::testing::Optional;

constexpr double kExact = 1e-12;

TruthRow RowOf(std::int64_t frame) {
  return {.frame = frame, .object = "jeep-1", .model = "jeep", .box = {100, 100, 40, 40}, .visible = 1};
}

ReportedSighting SightingOf(std::int64_t object, std::int64_t frame, const Box& box) {
  return {.object = object, .frame = frame, .model = "jeep", .box = box, .score = 0.9};
}

TEST(ReliabilityTest, RightIfMostSightingsShowOneTrueObject) {
  const std::vector<TruthRow> truth = {RowOf(0), RowOf(1), RowOf(2), RowOf(3)};
  const Box there{100, 100, 40, 40};
  const Box elsewhere{300, 300, 40, 40};
  const std::vector<ReportedSighting> sightings = {
      SightingOf(1, 0, there), SightingOf(1, 1, there),     SightingOf(1, 2, elsewhere),  // two of three
      SightingOf(2, 2, there), SightingOf(2, 3, elsewhere),                               // one of two
      SightingOf(3, 3, there)};                                                           // the same jeep again
  const std::vector<ReportedObject> objects = {
      {.id = 1, .score = 0.9}, {.id = 2, .score = 0.4}, {.id = 3, .score = 0.8}, {.id = 4, .score = 0.7}};
  const std::vector<JudgedObject> judged = JudgeObjects(truth, objects, sightings);
  ASSERT_EQ(judged.size(), 3U);  // the fourth has no sighting in this video
  EXPECT_TRUE(judged[0].is_right);
  EXPECT_FALSE(judged[1].is_right);
  EXPECT_TRUE(judged[2].is_right);
  EXPECT_EQ(judged[0].model, "jeep");
  EXPECT_EQ(judged[1].score, 0.4);
}

TEST(ReliabilityTest, MeasuresByHand) {
  const std::vector<JudgedObject> objects = {
      {.score = 0.95, .is_right = true}, {.score = 0.95, .is_right = false}, {.score = 0.25, .is_right = false}};
  const Reliability measured = MeasureReliability(objects);
  EXPECT_EQ(measured.right, 1);
  EXPECT_EQ(measured.wrong, 2);
  EXPECT_THAT(measured.mean_score_right, Optional(DoubleNear(0.95, kExact)));
  EXPECT_THAT(measured.mean_score_wrong, Optional(DoubleNear(0.6, kExact)));
  EXPECT_THAT(measured.calibration_error, Optional(DoubleNear((0.9 + 0.25) / 3, kExact)));
  EXPECT_THAT(measured.brier, Optional(DoubleNear((0.05 * 0.05 + 0.95 * 0.95 + 0.25 * 0.25) / 3, kExact)));
  EXPECT_THAT(measured.separation, Optional(DoubleNear(0.75, kExact)));  // a tie, and one higher
  EXPECT_THAT(ToText(measured, objects), HasSubstr("separation                 0.7500\n"));
  EXPECT_EQ(ToJson(measured, objects)["objects"].size(), 3U);
}

TEST(ReliabilityTest, WithoutObjectsNothingIsKnown) {
  const Reliability measured = MeasureReliability({});
  EXPECT_EQ(measured.calibration_error, std::nullopt);
  EXPECT_EQ(measured.separation, std::nullopt);
  EXPECT_TRUE(ToJson(measured, {})["brier"].is_null());
}

}  // namespace
}  // namespace victorious
