#include "victorious/place/associate/object_score.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "victorious/geometry/angles.h"
#include "victorious/place/associate/associate_objects.h"
#include "victorious/place/associate/object_rejection.h"

namespace victorious {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// A strong object seen from several sides, that nothing contradicts.
ObjectEvidence Good() {
  return {.strength = 15,
          .typical_log_odds = 12,
          .recognitions = 20,
          .frames = 60,
          .size_ratio = 1.01,
          .lines = 60,
          .headings = 20,
          .view_steps = 19,
          .view_spread_rad = RadiansFromDegrees(30)};
}

TEST(ObjectScoreTest, NothingSpeaksAgainstAGoodObject) {
  EXPECT_GT(ScoreObject(Good()), 0.95);
  EXPECT_THAT(SpeaksAgainst(Good()), IsEmpty());
}

TEST(ObjectScoreTest, EveryContradictionLowersTheScoreAndIsSaid) {
  const double good = ScoreObject(Good());
  const auto expect_lower = [&](const ObjectEvidence& evidence, const char* said) {
    EXPECT_LT(ScoreObject(evidence), good) << said;
    EXPECT_THAT(SpeaksAgainst(evidence), ElementsAre(said));
  };
  ObjectEvidence evidence = Good();
  evidence.size_ratio = 0.88;
  expect_lower(evidence, "size 12 % off");
  evidence = Good();
  evidence.missing_lines = 15;
  expect_lower(evidence, "15 of 60 lines of sight miss its place");
  evidence = Good();
  evidence.contradicting_headings = 3;
  expect_lower(evidence, "heading contradicts in 3 of 20 frames");
  evidence = Good();
  evidence.view_jumps = 4;
  expect_lower(evidence, "view jumps in 4 of 19 steps");
}

// A vehicle that looks like the model and is half as long again is another one, however often it is recognised.
TEST(ObjectScoreTest, AnotherModelsSizeOutweighsAnOrdinaryFind) {
  ObjectEvidence evidence = Good();
  evidence.strength = 8;
  EXPECT_GT(ScoreObject(evidence), 0.95);
  evidence.size_ratio = 1.5;
  EXPECT_LT(ScoreObject(evidence), 0.1);
  evidence.size_ratio = 1.03;
  EXPECT_GT(ScoreObject(evidence), 0.95) << "the usual error of ranges";
}

TEST(ObjectScoreTest, SaysWhatIsFewWeakAndOneSided) {
  ObjectEvidence evidence = Good();
  evidence.recognitions = 1;
  evidence.typical_log_odds = std::log(9.0);
  EXPECT_THAT(SpeaksAgainst(evidence), ElementsAre("recognised in 1 frame only", "weak: a typical frame scores 0.90"));
  evidence = Good();
  evidence.view_spread_rad = RadiansFromDegrees(3);
  EXPECT_THAT(SpeaksAgainst(evidence), ElementsAre("seen from one side only"));
}

TEST(ObjectScoreTest, ARejectedPlaceCostsTheScoreButNotTheFind) {
  ObservedTracklet tracklet;
  tracklet.record = {.id = 1, .video = 1, .frames = 60};
  tracklet.scores.assign(20, 1 - 1e-5);
  tracklet.summary = Summarise(tracklet);
  const ObjectHypothesis hypothesis{.tracklets = {&tracklet},
                                    .estimate = {.place = Geolocation{}, .inlier_fraction = 0.2, .size_ratio = 1.9}};
  const ObjectRecord rejected{.place_rejected = "1.9 times too large for its distance"};
  ObjectEvidence evidence = CollectEvidence(hypothesis, rejected, 1000, {});
  EXPECT_EQ(evidence.size_ratio, std::nullopt);
  EXPECT_EQ(evidence.missing_lines, 0);
  EXPECT_THAT(SpeaksAgainst(evidence), ElementsAre("1.9 times too large for its distance"));
  const double before = ScoreObject(evidence);
  evidence.place_weight = -2;
  EXPECT_LT(ScoreObject(evidence), before);
  EXPECT_GT(ScoreObject(evidence), 0.9);
  EXPECT_EQ(nlohmann::json::parse(ToJsonText(evidence))["place_weight"], -2);
}

// Another make that looks like the model has not its length; the more exactly the size is seen, the more that says.
TEST(ObjectScoreTest, TheSizeOfWhatIsFoundByShapeCounts) {
  ObservedTracklet tracklet;
  tracklet.summary = {.recognitions = 20, .by_shape = 20, .size_px = 100};
  ObjectHypothesis hypothesis{.tracklets = {&tracklet}, .estimate = {.place = Geolocation{}, .size_ratio = 1.002}};
  const double exact = SizeLogOdds(hypothesis);
  EXPECT_GT(exact, 0.5);
  hypothesis.estimate.size_ratio = 0.96;
  EXPECT_LT(SizeLogOdds(hypothesis), -2);
  hypothesis.estimate.size_sigma = 0.1;
  EXPECT_NEAR(SizeLogOdds(hypothesis), 0, 0.1) << "the lines of sight do not determine the distance";
  hypothesis.estimate = {.place = Geolocation{}, .size_ratio = 1.002};
  tracklet.summary.size_px = 20;
  EXPECT_LT(SizeLogOdds(hypothesis), exact);
  ObservedTracklet near;
  near.summary = {.recognitions = 20, .by_shape = 20, .size_px = 200};
  const double of_small = SizeLogOdds(hypothesis);
  hypothesis.tracklets = {&tracklet, &near};
  EXPECT_EQ(SizeLogOdds(hypothesis), of_small) << "no more exact than where it is small";
  near.length_factor = 1.1;
  EXPECT_EQ(SizeLogOdds(hypothesis), 0) << "it agrees because it was corrected";
  hypothesis.tracklets = {&tracklet};
  tracklet.summary.by_shape = 5;
  EXPECT_EQ(SizeLogOdds(hypothesis), 0) << "found by keypoints";
}

TEST(ObjectScoreTest, ShapesFoundAgainCount) {
  ObservedTracklet tracklet;
  const ObjectHypothesis hypothesis{.tracklets = {&tracklet}, .estimate = {}};
  const auto log_odds = [&](std::int64_t by_shape, std::int64_t missed, std::int64_t by_keypoints = 0) {
    tracklet.summary = {.recognitions = by_shape + by_keypoints, .by_shape = by_shape, .missed = missed};
    return FoundAgainLogOdds(hypothesis);
  };
  EXPECT_EQ(log_odds(1, 0), 0) << "not searched for again";
  EXPECT_GT(log_odds(14, 0), 1);
  EXPECT_EQ(log_odds(1000, 0), log_odds(100, 0)) << "bounded";
  EXPECT_LT(log_odds(7, 7), -2);
  EXPECT_LT(log_odds(20, 20), log_odds(20, 2));
  EXPECT_GE(log_odds(1, 1000), -4);
  EXPECT_EQ(log_odds(5, 20, 5), 0) << "most was found by keypoints";

  ObjectEvidence evidence = CollectEvidence(hypothesis, {}, 1000, {});
  evidence.typical_log_odds = 5;
  EXPECT_THAT(SpeaksAgainst(evidence), ElementsAre("its shape was missed in 20 of 25 frames"));
  EXPECT_EQ(nlohmann::json::parse(ToJsonText(evidence))["missed"], 20);
}

TEST(ObjectScoreTest, SightingsAreCountedByHowTheyWereFound) {
  ObservedTracklet tracklet{.is_cad_model = true};
  AddSighting({.frame = 1, .score = 0.9, .matches = 8}, tracklet);
  AddSighting({.frame = 2, .score = 0.9, .matches = 0}, tracklet);
  AddSighting({.frame = 3, .score = 0.8, .source = SightingSource::kTracked}, tracklet);
  AddSighting({.frame = 4, .score = 0.8, .source = SightingSource::kTracked, .is_missed = true}, tracklet);
  const TrackletSummary summary = Summarise(tracklet);
  EXPECT_EQ(tracklet.frames.size(), 4U);
  EXPECT_EQ(summary.recognitions, 2);
  EXPECT_EQ(summary.by_shape, 1);
  EXPECT_EQ(summary.missed, 1);
}

TEST(ObjectScoreTest, RisesWithStrengthAndStaysBelowOne) {
  ObjectEvidence evidence = Good();
  double before = 0;
  for (const double strength : {-5.0, 0.0, 2.3, 5.0, 10.0, 15.0}) {
    evidence.strength = strength;
    const double score = ScoreObject(evidence);
    EXPECT_GT(score, before);
    before = score;
  }
  evidence.strength = 1e6;
  EXPECT_LT(ScoreObject(evidence), 1);
}

TEST(ObjectScoreTest, ViewsOfATracklet) {
  ObservedTracklet tracklet;
  const auto add = [&](double time_s, double azimuth_deg) {
    SightingRecord sighting{.time_s = time_s, .score = 0.9};
    sighting.view = ViewDirection{RadiansFromDegrees(azimuth_deg), RadiansFromDegrees(60)};
    AddSighting(sighting, tracklet);
  };
  add(0, 10);
  add(1, 15);
  add(2, 190);  // turned round
  add(3, 185);
  add(9, 20);  // long after
  const TrackletSummary summary = Summarise(tracklet);
  EXPECT_EQ(summary.views, 5);
  EXPECT_EQ(summary.view_steps, 3);
  EXPECT_EQ(summary.view_jumps, 1);
  ObservedTracklet photos = tracklet;
  photos.is_of_photos = true;  // their times are invented
  EXPECT_EQ(Summarise(photos).view_steps, 0);
}

TEST(ObjectScoreTest, CollectsFromAllTracklets) {
  ObservedTracklet first;
  first.record = {.id = 1, .video = 1, .frames = 10};
  first.scores = {0.9, 0.99};
  first.summary = Summarise(first);
  ObservedTracklet second;
  second.record = {.id = 2, .video = 1, .frames = 5};
  second.scores = {0.999};
  second.summary = Summarise(second);
  const ObjectHypothesis hypothesis{.tracklets = {&first, &second}};
  const ObjectEvidence evidence = CollectEvidence(hypothesis, {}, 1000, {});
  EXPECT_EQ(evidence.recognitions, 3);
  EXPECT_EQ(evidence.frames, 15);
  EXPECT_NEAR(evidence.typical_log_odds, (std::log(9.0) + std::log(99.0) + std::log(999.0)) / 3, 1e-9);
  EXPECT_NEAR(evidence.strength, evidence.typical_log_odds + std::log(12.0) - std::log(0.016 * 1000), 1e-9)
      << "four frames count for each recognition";
  const auto json = nlohmann::json::parse(ToJsonText(evidence));
  EXPECT_EQ(json["recognitions"], 3);
  EXPECT_TRUE(json["size_ratio"].is_null());
}

}  // namespace
}  // namespace victorious
