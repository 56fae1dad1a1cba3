#include "victorious/place/associate/flight_evidence.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

using enum PlaceFinding;

TEST(WeighFindingsTest, AnObjectAloneSaysLittle) {
  EXPECT_TRUE(WeighFindings({}).empty());
  const std::vector<FindingOfObject> silent = {{.model = 1}};
  EXPECT_EQ(WeighFindings(silent), std::vector<double>{0});
  const std::vector<FindingOfObject> alone = {{.model = 1, .probability = 0.9, .finding = kImpossible}};
  const double weight = WeighFindings(alone)[0];
  EXPECT_LT(weight, -1);
  EXPECT_GT(weight, -2.3) << "telemetry or the model's length may be wrong";
}

TEST(WeighFindingsTest, ConfirmedTelemetryMakesAContradictedPlaceSpeakAgainstTheObject) {
  std::vector<FindingOfObject> objects = {{.model = 1, .probability = 0.9, .finding = kImpossible}};
  double before = WeighFindings(objects)[0];
  for (std::int64_t model = 2; model < 5; ++model) {
    objects.push_back({.model = model, .probability = 0.95, .finding = kAgrees});
    const double weight = WeighFindings(objects)[0];
    EXPECT_LT(weight, before);
    before = weight;
  }
  EXPECT_LT(before, -3);
  EXPECT_GT(before, -4) << "a weight, no switch: the model's length may be wrong";
  EXPECT_GT(WeighFindings(objects)[1], 1) << "that a place agrees speaks for its object";
}

TEST(WeighFindingsTest, TelemetryIsAtFaultIfAllObjectsAreContradicted) {
  std::vector<FindingOfObject> objects;
  for (std::int64_t model = 1; model < 5; ++model)
    objects.push_back({.model = model, .probability = 0.95, .finding = kImpossible});
  for (const double weight : WeighFindings(objects)) EXPECT_NEAR(weight, 0, 0.25);
}

TEST(WeighFindingsTest, LengthIsAtFaultIfAllObjectsOfAModelAreContradicted) {
  std::vector<FindingOfObject> objects;
  for (std::int64_t model = 2; model < 6; ++model)
    objects.push_back({.model = model, .probability = 0.95, .finding = kAgrees});
  for (int i = 0; i < 3; ++i) objects.push_back({.model = 1, .probability = 0.95, .finding = kImpossible});
  for (std::size_t i = 4; i < 7; ++i) EXPECT_GT(WeighFindings(objects)[i], -1);
}

TEST(WeighFindingsTest, OneOfTheModelThatAgreesShowsThatItsLengthIsRight) {
  std::vector<FindingOfObject> objects = {{.model = 1, .probability = 0.9, .finding = kImpossible}};
  for (std::int64_t model = 2; model < 6; ++model)
    objects.push_back({.model = model, .probability = 0.95, .finding = kAgrees});
  const double before = WeighFindings(objects)[0];
  objects.push_back({.model = 1, .probability = 0.95, .finding = kAgrees});
  EXPECT_LT(WeighFindings(objects)[0], before - 0.5);
}

// It may be false, which says nothing of the flight.
TEST(WeighFindingsTest, CertainFalseFindsAreWeighedAndWeighNothing) {
  std::vector<FindingOfObject> objects = {{.model = 1, .probability = 0.9, .finding = kImpossible}};
  const double before = WeighFindings(objects)[0];
  objects.push_back({.model = 2, .probability = 0, .finding = kImpossible});
  EXPECT_DOUBLE_EQ(WeighFindings(objects)[0], before);
  EXPECT_LT(WeighFindings(objects)[1], -0.4);
}

TEST(WeighFindingsTest, WeakFindsConfirmLittle) {
  const auto weigh = [](double probability) {
    std::vector<FindingOfObject> objects = {{.model = 1, .probability = 0.9, .finding = kImpossible}};
    for (std::int64_t model = 2; model < 4; ++model)
      objects.push_back({.model = model, .probability = probability, .finding = kAgrees});
    return WeighFindings(objects)[0];
  };
  EXPECT_GT(weigh(0.05), -2.3);
  EXPECT_LT(weigh(0.95), -3);
}

// What flies or moves otherwise than modelled is no false find for that.
TEST(WeighFindingsTest, FlyingAndUnusualMotionWeighLess) {
  for (const PlaceFinding finding : {kAbove, kNoIntersection}) {
    std::vector<FindingOfObject> objects = {{.model = 1, .probability = 0.9, .finding = finding}};
    for (std::int64_t model = 2; model < 6; ++model)
      objects.push_back({.model = model, .probability = 0.95, .finding = kAgrees});
    EXPECT_LT(WeighFindings(objects)[0], -0.5);
    EXPECT_GT(WeighFindings(objects)[0], -1.5);
  }
}

// Thousands of objects neither overflow nor vanish.
TEST(WeighFindingsTest, ManyObjectsHaveFiniteWeights) {
  Random random(5);
  std::vector<FindingOfObject> objects;
  for (int i = 0; i < 5000; ++i) {
    objects.push_back({.model = i % 25,
                       .probability = random.Uniform(0, 1),
                       .finding = i % 3 == 0   ? kImpossible
                                  : i % 3 == 1 ? kAgrees
                                               : kNoIntersection});
  }
  for (const double weight : WeighFindings(objects)) EXPECT_TRUE(std::isfinite(weight));
}

}  // namespace
}  // namespace victorious
