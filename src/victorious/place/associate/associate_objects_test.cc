#include "victorious/place/associate/associate_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"
#include "victorious/place/associate/simulated_tracklet_test.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// So many searches in each of the videos.
SearchCounts SearchesOf(std::int64_t count) {
  SearchCounts counts;
  for (std::int64_t video = 0; video < 20; ++video) counts.Add(video, count, {});
  return counts;
}

std::vector<ObjectRecord> ObjectsFrom(const std::vector<SimulatedTracklet>& simulated,
                                      const ObjectOptions& options = {}, std::int64_t frames_searched = 100) {
  std::vector<ObservedTracklet> tracklets;
  for (const SimulatedTracklet& one : simulated) tracklets.push_back(SimulateTracklet(one));
  return AssociateTracklets(std::move(tracklets), SearchesOf(frames_searched), options);
}

std::vector<std::vector<std::int64_t>> TrackletsOf(const std::vector<ObjectRecord>& objects) {
  std::vector<std::vector<std::int64_t>> tracklets;
  for (const ObjectRecord& object : objects) tracklets.push_back(object.tracklets);
  return tracklets;
}

Eigen::Vector3d EstimatePlace(const ObjectRecord& object) {
  return TangentPlane(kOrigin).EnuFromGeodetic(object.place->point);
}

TEST(AssociateTracklets, OneTrackletIsOneObjectAtItsPlace) {
  const auto objects = ObjectsFrom({{.id = 5, .place_enu = {3, 4, 1}}});
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects[0].id, 5);
  ASSERT_TRUE(objects[0].place);
  EXPECT_LT((EstimatePlace(objects[0]) - Eigen::Vector3d(3, 4, 1)).norm(), 0.3);
  EXPECT_EQ(objects[0].place->velocity_enu->norm(), 0) << "it is static";
  EXPECT_NEAR(*objects[0].heading_rad, 1.0, 0.05) << "a quarter of the views is wrong";
  EXPECT_EQ(objects[0].rejected, "");
}

TEST(AssociateTracklets, WithoutTelemetryEachTrackletIsAnObjectWithoutPlace) {
  ObservedTracklet a{.record = {.id = 1, .video = 1, .model = 1}, .frames = {0, 1}};
  ObservedTracklet b{.record = {.id = 2, .video = 1, .model = 1}, .frames = {50, 51}};
  const auto objects = AssociateTracklets({a, b}, SearchesOf(0), {});
  EXPECT_THAT(TrackletsOf(objects), ElementsAre(ElementsAre(1), ElementsAre(2)));
  EXPECT_FALSE(objects[0].place);
  EXPECT_FALSE(objects[0].heading_rad);
  EXPECT_EQ(objects[0].rejected, "");
}

// In a folder of photos the time between two frames is invented.
TEST(AssociateTracklets, PhotosShowNoMotion) {
  ObservedTracklet tracklet = SimulateTracklet({.id = 1, .velocity_enu = {0, 9, 0}});
  ASSERT_TRUE(AssociateTracklets({tracklet}, SearchesOf(100), {})[0].place->IsMoving());
  tracklet.is_of_photos = true;
  const auto objects = AssociateTracklets({tracklet}, SearchesOf(100), {});
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_FALSE(objects[0].place && objects[0].place->IsMoving());
}

// All places of the flight shift alike: their errors grow, what is one object stays so, and two stay two.
TEST(AssociateTracklets, AnErrorOfTheClockWidensErrorsOnly) {
  const std::vector<SimulatedTracklet> seen = {
      {.id = 1}, {.id = 2, .first_frame = 50}, {.id = 3, .place_enu = {6, 0, 1}, .first_frame = 100}};
  std::vector<ObservedTracklet> tracklets;
  for (const SimulatedTracklet& one : seen) tracklets.push_back(SimulateTracklet(one));
  const auto exact = AssociateTracklets(tracklets, SearchesOf(100), {});
  for (ObservedTracklet& tracklet : tracklets) {
    for (BearingObservation& observation : tracklet.observations)
      observation.line.clock_shift = ClockShift{.camera_enu_m = {24, 0, 0}};
  }
  const auto wide = AssociateTracklets(tracklets, SearchesOf(100), {});
  EXPECT_EQ(TrackletsOf(wide), TrackletsOf(exact));
  ASSERT_EQ(wide.size(), exact.size());
  for (std::size_t i = 0; i < wide.size(); ++i) {
    EXPECT_EQ(EstimatePlace(wide[i]), EstimatePlace(exact[i])) << "places stay";
    EXPECT_NEAR(wide[i].place->covariance_enu_m2(0, 0), exact[i].place->covariance_enu_m2(0, 0) + 576, 1);
    EXPECT_GT(wide[i].place->ce90_m, 1.6 * 24);
  }
}

TEST(AssociateTracklets, ADrivingObjectHasTheErrorOfTheClock) {
  ObservedTracklet tracklet = SimulateTracklet({.id = 1, .velocity_enu = {0, 9, 0}, .frames = 60});
  const auto exact = AssociateTracklets({tracklet}, SearchesOf(100), {});
  ASSERT_TRUE(exact[0].place && exact[0].place->IsMoving());
  for (BearingObservation& observation : tracklet.observations)
    observation.line.clock_shift = ClockShift{.camera_enu_m = {24, 0, 0}};
  const auto wide = AssociateTracklets({tracklet}, SearchesOf(100), {});
  EXPECT_EQ(EstimatePlace(wide[0]), EstimatePlace(exact[0]));
  EXPECT_NEAR(wide[0].place->covariance_enu_m2(0, 0), exact[0].place->covariance_enu_m2(0, 0) + 576, 2);
}

TEST(AssociateTracklets, ReappearanceAtSamePlaceIsSameObject) {
  EXPECT_THAT(
      TrackletsOf(ObjectsFrom({{.id = 1, .first_frame = 0, .frames = 20}, {.id = 2, .first_frame = 70, .frames = 20}})),
      ElementsAre(ElementsAre(1, 2)));
}

TEST(AssociateTracklets, InstancesTenMetresApartAreNotMerged) {
  // Observed at different times, never in one frame.
  EXPECT_THAT(TrackletsOf(ObjectsFrom({{.id = 1, .place_enu = {-5, 0, 1}, .frames = 20},
                                       {.id = 2, .place_enu = {5, 0, 1}, .first_frame = 30, .frames = 20}})),
              ElementsAre(ElementsAre(1), ElementsAre(2)));
}

TEST(AssociateTracklets, TrackletsWithCommonFramesAreNotMerged) {
  EXPECT_THAT(TrackletsOf(ObjectsFrom({{.id = 1, .place_enu = {0, 0, 1}}, {.id = 2, .place_enu = {2, 0, 1}}})),
              ElementsAre(ElementsAre(1), ElementsAre(2)));
}

TEST(AssociateTracklets, TrackletsOfDifferentModelsAreNotMerged) {
  EXPECT_THAT(
      TrackletsOf(ObjectsFrom({{.id = 1, .frames = 20}, {.id = 2, .model = 2, .first_frame = 30, .frames = 10}})),
      ElementsAre(ElementsAre(1), ElementsAre(2)));
}

TEST(AssociateTracklets, MovingObjectIsMergedAtItsPredictedPlace) {
  const Eigen::Vector3d velocity(-4, 3, 0);
  const auto objects = ObjectsFrom({{.id = 1, .velocity_enu = velocity, .frames = 30},
                                    {.id = 2, .velocity_enu = velocity, .first_frame = 45, .frames = 30}});
  ASSERT_THAT(TrackletsOf(objects), ElementsAre(ElementsAre(1, 2)));
  EXPECT_LT((*objects[0].place->velocity_enu - velocity).norm(), 0.3);
  EXPECT_NEAR(objects[0].place->time_s, 7.4, 1e-9);
  EXPECT_LT((EstimatePlace(objects[0]) - Eigen::Vector3d(-29.6, 22.2, 1)).norm(), 1.5);
}

TEST(AssociateTracklets, SameObjectInTwoVideosIsMerged) {
  const auto objects = ObjectsFrom({{.id = 1, .place_enu = {-20, 5, 1}},
                                    {.id = 2, .place_enu = {20, 5, 1}},
                                    {.id = 3,
                                     .video = 2,
                                     .place_enu = {20, 5, 1},
                                     .camera_from_m = 60,
                                     .camera_speed_m_s = -9,
                                     .camera_bias_enu = {1.5, -1, 0.5}}});
  EXPECT_THAT(TrackletsOf(objects), ElementsAre(ElementsAre(1), ElementsAre(2, 3)));
}

TEST(AssociateTracklets, ResultDoesNotDependOnTrackletOrder) {
  std::vector<SimulatedTracklet> simulated;
  for (int i = 0; i < 6; ++i) {
    simulated.push_back({.id = i + 1, .place_enu = {6.0 * (i % 3), 8, 1}, .first_frame = 40 * (i / 3), .frames = 25});
  }
  const auto objects = ObjectsFrom(simulated);
  EXPECT_THAT(TrackletsOf(objects), ElementsAre(ElementsAre(1, 4), ElementsAre(2, 5), ElementsAre(3, 6)));
  std::ranges::reverse(simulated);
  const auto again = ObjectsFrom(simulated);
  ASSERT_EQ(TrackletsOf(again), TrackletsOf(objects));
  for (std::size_t i = 0; i < objects.size(); ++i) EXPECT_EQ(again[i].place->point, objects[i].place->point);
}

// The object is found without a place: it has no heading either, because that is from the same telemetry.
void ExpectPlaceRejected(const ObjectRecord& object, const std::string& reason) {
  EXPECT_EQ(object.rejected, "");
  EXPECT_THAT(object.place_rejected, HasSubstr(reason));
  EXPECT_FALSE(object.place);
  EXPECT_FALSE(object.heading_rad);
}

void ExpectPlaced(const ObjectRecord& object) {
  EXPECT_EQ(object.rejected, "");
  EXPECT_EQ(object.place_rejected, "");
  EXPECT_TRUE(object.place);
}

// From a straight flight, an object five times too large for where its lines meet is one that drives along, five times
// nearer. The object beside it shows that nothing drives at that height.
const SimulatedTracklet kParked{.id = 1};
const SimulatedTracklet kTooLarge{
    .id = 2, .model = 2, .place_enu = {4, 6, 1}, .heading_rad = RadiansFromDegrees(90), .too_large = 5};

TEST(AssociateTracklets, SizeOfADrivingObjectIsRejectedOnlyByItsHeight) {
  ExpectPlaceRejected(ObjectsFrom({kParked, kTooLarge})[1], "5.0 times too large");
  ExpectPlaced(ObjectsFrom({kParked, kTooLarge}, {.max_height_deviation_m = 1000})[1]);
  const ObjectRecord alone = ObjectsFrom({kTooLarge})[0];
  ExpectPlaced(alone);
  EXPECT_NEAR(alone.place->velocity_enu->norm(), 0.8 * 12, 0.3) << "as fast as the camera, but for a fifth";
}

TEST(AssociateTracklets, NothingMovesAcrossItsHeading) {
  SimulatedTracklet across = kTooLarge;
  across.heading_rad = RadiansFromDegrees(10);
  ExpectPlaceRejected(ObjectsFrom({across})[0], "10 m/s, 80 degrees off its heading");
  across.heading_rad = RadiansFromDegrees(115);
  ExpectPlaced(ObjectsFrom({across})[0]);
  across.heading_rad = RadiansFromDegrees(275);
  ExpectPlaced(ObjectsFrom({across})[0]);
}

// The camera turns about the object: its lines meet at one place only, and the size contradicts it.
TEST(AssociateTracklets, ApparentSizeAboveMaxRatioCostsThePlace) {
  const auto seen = [](double max_size_ratio) {
    ObservedTracklet tracklet = SimulateTracklet(kParked);
    const TangentPlane plane(kOrigin);
    for (BearingObservation& observation : tracklet.observations) {
      const double angle_rad = 0.02 * observation.line.time_s / kFrameS;
      const Eigen::Vector3d camera(70 * std::sin(angle_rad), -70 * std::cos(angle_rad), 100);
      const Eigen::Vector3d line = kParked.place_enu - camera;
      observation.line.camera = plane.GeodeticFromEnu(camera);
      observation.line.azimuth_rad = std::atan2(line.x(), line.y());
      observation.line.elevation_rad = std::asin(line.z() / line.norm());
      observation.line.range_m = line.norm() / 1.9;
      observation.line.sigma_range_m = 0.2 * *observation.line.range_m;  // too inaccurate for a path
    }
    return AssociateTracklets({tracklet}, SearchesOf(100), {.max_size_ratio = max_size_ratio})[0];
  };
  ExpectPlaceRejected(seen(1.6), "1.9 times too large");
  ExpectPlaced(seen(3));
}

// Cameras that fly straight see three vehicles: what the size says of their distance places them.
TEST(AssociateTracklets, DrivingObjectsArePlacedFromAStraightFlight) {
  const std::array<Eigen::Vector3d, 3> velocities = {Eigen::Vector3d(7, 0, 0), {-6, 1, 0}, {3, 5, 0}};
  std::vector<SimulatedTracklet> simulated = {{.id = 9, .model = 9, .place_enu = {20, 3, 1}, .frames = 40}};
  for (std::int64_t i = 0; i < 3; ++i) {
    simulated.push_back({.id = i + 1,
                         .model = i + 1,
                         .place_enu = {-10, 4.0 * static_cast<double>(i), 1},
                         .velocity_enu = velocities.at(static_cast<std::size_t>(i)),
                         .frames = 40});
  }
  const auto objects = ObjectsFrom(simulated);
  ASSERT_EQ(objects.size(), 4U);
  for (std::size_t i = 0; i < 3; ++i) {
    ExpectPlaced(objects[i]);
    const Eigen::Vector3d velocity = velocities.at(i);
    EXPECT_LT((*objects[i].place->velocity_enu - velocity).norm(), 0.4) << i;
    const Eigen::Vector3d truth = simulated[i + 1].place_enu + 3.9 * velocity;
    EXPECT_LT((EstimatePlace(objects[i]) - truth).norm(), 1.5) << i;
    EXPECT_LT((EstimatePlace(objects[i]) - truth).head<2>().norm(), objects[i].place->ce90_m) << i;
  }
  EXPECT_EQ(objects[3].place->velocity_enu->norm(), 0);
}

// A common error of the ranges puts a vehicle above or below the road; the parked ones show where that is.
TEST(AssociateTracklets, OtherObjectsShowTheGroundUnderADrivingOne) {
  const SimulatedTracklet driving{.id = 1, .velocity_enu = {6, 2, 0}, .frames = 40, .too_large = 1.04};
  const Eigen::Vector3d truth = driving.place_enu + 3.9 * driving.velocity_enu;
  const auto error_m = [&](const std::vector<SimulatedTracklet>& seen) {
    return (EstimatePlace(ObjectsFrom(seen)[0]) - truth).norm();
  };
  const SimulatedTracklet parked{.id = 2, .model = 2, .place_enu = {10, 3, 1}};
  const SimulatedTracklet other{.id = 3, .model = 3, .place_enu = {-10, -3, 1}};
  const double alone_m = error_m({driving});
  EXPECT_GT(alone_m, 3);
  EXPECT_LT(error_m({driving, parked, other}), alone_m / 2);
}

// Hidden for two seconds, in which it turns.
TEST(AssociateTracklets, DrivingObjectKeepsItsIdentityThroughALoss) {
  const Eigen::Vector3d before(5, 0, 0);
  const Eigen::Vector3d after(3.5, 3.5, 0);
  const Eigen::Vector3d corner(-5, 2, 1);  // at 2.95 s
  const SimulatedTracklet first{.id = 1, .place_enu = corner - 2.95 * before, .velocity_enu = before, .frames = 20};
  const SimulatedTracklet second{
      .id = 2, .place_enu = corner - 2.95 * after, .velocity_enu = after, .first_frame = 40, .frames = 25};
  const auto objects = ObjectsFrom({first, second});
  EXPECT_THAT(TrackletsOf(objects), ElementsAre(ElementsAre(1, 2)));
  EXPECT_LT((*objects[0].place->velocity_enu - after).norm(), 0.5);
  const SimulatedTracklet elsewhere{
      .id = 2, .place_enu = {0, 14, 1}, .velocity_enu = after, .first_frame = 40, .frames = 25};
  EXPECT_EQ(ObjectsFrom({first, elsewhere}).size(), 2U) << "another one, 20 m beside it";
}

// Without its place, the object is as significant as without telemetry, 30 frames and not those that agree in place,
// less what the place says against it.
TEST(AssociateTracklets, WithoutAPlaceTheObjectIsJudgedByRecognition) {
  SimulatedTracklet seen = kTooLarge;
  seen.score = 0.997;
  ExpectPlaceRejected(ObjectsFrom({kParked, seen}, {}, 1000)[1], "too large");
  seen.score = 0.9;
  EXPECT_EQ(ObjectsFrom({kParked, seen}, {}, 1000)[1].rejected,
            "weak, and 5.0 times too large for its distance, with telemetry that 1 object of other models confirms");
  seen.score = 0.5;
  EXPECT_THAT(ObjectsFrom({kParked, seen}, {}, 1000)[1].rejected, HasSubstr("not significant"));
}

// Three that stand where their lines meet show that the telemetry is right: a weak find below any ground is false.
// Where all are there, the telemetry is wrong, and the same finds stay.
TEST(AssociateTracklets, AnImpossiblePlaceIsWeighedByTheWholeFlight) {
  const auto underground = [](std::int64_t model, double score) {
    return SimulatedTracklet{
        .id = model, .model = model, .place_enu = {15.0 * static_cast<double>(model), 900, -1500}, .score = score};
  };
  std::vector<SimulatedTracklet> seen = {underground(1, 0.9)};
  for (std::int64_t model = 2; model < 5; ++model)
    seen.push_back({.id = model, .model = model, .place_enu = {10.0 * static_cast<double>(model), 0, 1}});
  const auto confirmed = ObjectsFrom(seen);
  EXPECT_THAT(confirmed[0].rejected, HasSubstr("weak, and"));
  EXPECT_THAT(confirmed[0].rejected, HasSubstr("below the sea"));
  EXPECT_THAT(confirmed[0].rejected, HasSubstr("that 3 objects of other models confirm"));
  for (std::size_t i = 1; i < 4; ++i) ExpectPlaced(confirmed[i]);

  // The model's length may be wrong: a strong find stays.
  seen[0].score = 0.999;
  ExpectPlaceRejected(ObjectsFrom(seen)[0], "below the sea");

  std::vector<SimulatedTracklet> all;
  for (std::int64_t model = 1; model < 5; ++model) all.push_back(underground(model, 0.9));
  const auto contradicted = ObjectsFrom(all);
  ASSERT_EQ(contradicted.size(), 4U);
  for (const ObjectRecord& object : contradicted) {
    ExpectPlaceRejected(object, "below the sea");
    EXPECT_GT(*object.object_score, *confirmed[0].object_score);
  }
}

TEST(AssociateTracklets, HeightDeviationFromOtherObjectsCostsThePlace) {
  const SimulatedTracklet floating{.id = 2, .model = 2, .first_frame = 10, .frames = 1, .too_large = 3};
  const auto objects = ObjectsFrom({{.id = 1}, floating});
  EXPECT_EQ(objects[0].rejected, "");
  ExpectPlaceRejected(objects[1], "above the other objects");
  ExpectPlaced(ObjectsFrom({{.id = 1}, floating}, {.max_height_deviation_m = 1000})[1]);
  ExpectPlaced(ObjectsFrom({floating})[0]);  // the height of the ground is unknown
}

TEST(AssociateTracklets, PlaceBelowSeaLevelIsRejected) {
  ExpectPlaceRejected(ObjectsFrom({{.id = 1, .place_enu = {0, 900, -1500}}})[0], "below the sea");
}

// In 100,000 searched frames 1600 false detections of even odds are expected, so that odds of 16,000 to 1 are required.
// Odds of 9 to 1 are insufficient, also over 30 frames; odds of 1000 to 1 over 30 frames suffice. In 50 searched
// frames, odds of 9 to 1 in one frame suffice.
TEST(AssociateTracklets, SignificanceThresholdGrowsWithFramesSearched) {
  const SimulatedTracklet faint{.id = 1, .frames = 1, .score = 0.9};
  const SimulatedTracklet longer{.id = 1, .frames = 30, .score = 0.9};
  const SimulatedTracklet clear{.id = 1, .frames = 30, .score = 0.999};
  EXPECT_EQ(ObjectsFrom({faint}, {}, 50)[0].rejected, "");
  EXPECT_THAT(ObjectsFrom({faint}, {}, 100)[0].rejected, HasSubstr("not significant"));
  EXPECT_EQ(ObjectsFrom({longer}, {}, 1000)[0].rejected, "");
  EXPECT_THAT(ObjectsFrom({longer}, {}, 100'000)[0].rejected, HasSubstr("100000 frames"));
  EXPECT_EQ(ObjectsFrom({clear}, {}, 100'000)[0].rejected, "");
  EXPECT_EQ(ObjectsFrom({faint}, {.false_alarm_rate = 0}, 100'000)[0].rejected, "");
}

// One clear frame among faint ones is as frequent among false detections.
TEST(AssociateTracklets, SingleHighScoreDoesNotRaiseSignificance) {
  const SimulatedTracklet faint{.id = 1, .score = 0.8};
  const SimulatedTracklet once{.id = 1, .score = 0.8, .first_score = 0.99};
  EXPECT_THAT(ObjectsFrom({faint}, {}, 1000)[0].rejected, HasSubstr("not significant"));
  EXPECT_THAT(ObjectsFrom({once}, {}, 1000)[0].rejected, HasSubstr("not significant"));
}

// The same 30 frames with different headings: most of them are inconsistent.
TEST(AssociateTracklets, InconsistentHeadingsDoNotRaiseSignificance) {
  const SimulatedTracklet alike{.id = 1, .score = 0.9};
  const SimulatedTracklet turned{.id = 1, .score = 0.9, .heading_noise_rad = 3};
  EXPECT_EQ(ObjectsFrom({alike}, {}, 1000)[0].rejected, "");
  EXPECT_THAT(ObjectsFrom({turned}, {}, 1000)[0].rejected, HasSubstr("not significant"));
}

// Two observations always fit a moving object: they count as one.
TEST(AssociateTracklets, TwoObservationsOfMovingObjectCountAsOne) {
  const SimulatedTracklet parked{.id = 1, .first_frame = 1, .frames = 2, .score = 0.9};
  const SimulatedTracklet moving{.id = 1, .velocity_enu = {40, 30, 0}, .first_frame = 1, .frames = 2, .score = 0.9};
  const SimulatedTracklet longer{.id = 1, .velocity_enu = {40, 30, 0}, .frames = 30, .score = 0.9};
  EXPECT_EQ(ObjectsFrom({parked}, {}, 100)[0].rejected, "");
  EXPECT_THAT(ObjectsFrom({moving}, {}, 100)[0].rejected, HasSubstr("not significant"));
  EXPECT_EQ(ObjectsFrom({longer}, {}, 100)[0].rejected, "");
}

TEST(AssociateTracklets, GivenGroundConstrainsHeight) {
  // Telemetry is 3 m too high, which the lines of sight alone cannot detect.
  const SimulatedTracklet seen{.id = 1, .place_enu = {0, 0, 1}, .noise_rad = 1e-3, .camera_bias_enu = {0, 0, 3}};
  ObjectOptions options;
  EXPECT_NEAR(EstimatePlace(ObjectsFrom({seen}, options)[0]).z(), 4, 1);
  options.ground = std::make_shared<FlatGround>(kOrigin.altitude_m);
  options.centre_height_m = 1;
  options.centre_height_sigma_m = 0.1;
  options.locate.ground_sigma_m = 0.1;
  const ObjectRecord on_ground = ObjectsFrom({seen}, options)[0];
  EXPECT_NEAR(EstimatePlace(on_ground).z(), 1, 0.3);
  EXPECT_LT(on_ground.place->le90_m, 0.5);
  EXPECT_EQ(on_ground.rejected, "");
  options.ground = std::make_shared<FlatGround>(kOrigin.altitude_m);
  EXPECT_EQ(ObjectsFrom({seen}, options)[0].place->le90_m, on_ground.place->le90_m)
      << "given again, it has the same covariance";
  // A flying object stays at the intersection of its lines of sight.
  const ObjectRecord flying = ObjectsFrom({{.id = 1, .place_enu = {0, 0, 31}}}, options)[0];
  EXPECT_NEAR(EstimatePlace(flying).z(), 31, 1);
  EXPECT_EQ(flying.rejected, "");
}

TEST(AssociateTracklets, NonIntersectingLinesOfSightCostThePlace) {
  ExpectPlaceRejected(ObjectsFrom({{.id = 1, .noise_rad = 0.2}})[0], "do not intersect");
}

TEST(AssociateTracklets, OfCoincidentObjectsTheLessObservedIsRejected) {
  const auto objects =
      ObjectsFrom({{.id = 1, .model = 1, .frames = 20}, {.id = 2, .model = 2, .place_enu = {0.3, 0, 1}, .frames = 30}});
  EXPECT_THAT(objects[0].rejected, HasSubstr("at the same place as object 2"));
  EXPECT_EQ(objects[1].rejected, "");
}

// A tracklet without a place, of a model, in a box that moves to the right.
ObservedTracklet MovingBox(std::int64_t id, int frames, double x) {
  ObservedTracklet tracklet{
      .record = {.id = id, .object = id, .video = 1, .model = id, .score = 0.99, .frames = frames},
      .is_cad_model = true};
  for (int frame = 0; frame < frames; ++frame) {
    tracklet.frames.push_back(frame);
    tracklet.scores.push_back(0.99);
    tracklet.boxes.push_back({x + 20.0 * frame, 100, 80, 60});
  }
  return tracklet;
}

std::vector<std::string> RejectionsOf(std::vector<ObservedTracklet> tracklets) {
  std::vector<std::string> rejections;
  for (const ObjectRecord& object : AssociateTracklets(std::move(tracklets), SearchesOf(100), {}))
    rejections.push_back(object.rejected);
  return rejections;
}

TEST(AssociateTracklets, OfOverlappingCadObjectsTheLessObservedIsRejected) {
  EXPECT_THAT(RejectionsOf({MovingBox(1, 12, 50), MovingBox(2, 30, 58)}),
              ElementsAre("in the same pixels as object 2", ""));
}

TEST(AssociateTracklets, AdjacentOrBrieflyOverlappingObjectsAreNotRejected) {
  EXPECT_THAT(RejectionsOf({MovingBox(1, 12, 50), MovingBox(2, 30, 90)}), ElementsAre("", ""));
  ObservedTracklet passing = MovingBox(1, 12, 50);
  for (std::size_t i = 5; i < passing.boxes.size(); ++i) passing.boxes[i].y = 300;
  EXPECT_THAT(RejectionsOf({passing, MovingBox(2, 30, 50)}), ElementsAre("", ""));
  ObservedTracklet elsewhere = MovingBox(1, 12, 50);
  elsewhere.record.video = 2;
  EXPECT_THAT(RejectionsOf({elsewhere, MovingBox(2, 30, 50)}), ElementsAre("", ""));
}

TEST(AssociateTracklets, OverlappingPhotoModelIsNotRejected) {
  ObservedTracklet photo = MovingBox(1, 12, 50);
  photo.is_cad_model = false;
  EXPECT_THAT(RejectionsOf({photo, MovingBox(2, 30, 50)}), ElementsAre("", ""));
}

// A lorry of 10 m that drives at 6 m/s across the view; and another one beside it, `ahead` and `right` of its centre.
constexpr double kLorryHeading_rad = 2.3;

SimulatedTracklet Lorry(std::int64_t id, double ahead_m = 0, double right_m = 0, double turned_rad = 0) {
  const Eigen::Vector3d front(std::sin(kLorryHeading_rad), std::cos(kLorryHeading_rad), 0);
  const Eigen::Vector3d right(front.y(), -front.x(), 0);
  return {.id = id,
          .place_enu = ahead_m * front + right_m * right + Eigen::Vector3d::UnitZ(),
          .velocity_enu = 6 * front,
          .heading_rad = kLorryHeading_rad + turned_rad,
          .body_m = Eigen::Vector3d(10, 2.5, 3)};
}

std::vector<std::string> RejectionsOf(const std::vector<SimulatedTracklet>& simulated) {
  std::vector<std::string> rejections;
  for (const ObjectRecord& object : ObjectsFrom(simulated)) rejections.push_back(object.rejected);
  return rejections;
}

// Half of a lorry looks like the other half, turned: the same tank, or windows, reported once more.
TEST(AssociateTracklets, OfTwoObjectsInTheSameSpaceTheOneWithLessEvidenceIsRejected) {
  SimulatedTracklet turned = Lorry(2, -6.5, 0.2, kPi);
  turned.score = 0.96;
  turned.first_frame = 5;
  turned.frames = 12;
  EXPECT_THAT(RejectionsOf({Lorry(1), turned}), ElementsAre("", "in the same space as object 1"));
  SimulatedTracklet parked = Lorry(1);
  parked.velocity_enu.setZero();
  turned.velocity_enu.setZero();
  EXPECT_THAT(RejectionsOf({parked, turned}), ElementsAre("", "in the same space as object 1")) << "neither drives";
  SimulatedTracklet brief = parked;
  brief.frames = 10;
  turned.first_frame = 0;
  EXPECT_THAT(RejectionsOf({brief, turned}), ElementsAre("", "in the same space as object 1"))
      << "the weaker one is seen in more frames";
}

TEST(AssociateTracklets, VehiclesSideBySideOrInARowStayTwo) {
  EXPECT_THAT(RejectionsOf({Lorry(1), Lorry(2, 0, 2.8)}), ElementsAre("", "")) << "one partly behind the other";
  EXPECT_THAT(RejectionsOf({Lorry(1), Lorry(2, -4, -2.8, kPi)}), ElementsAre("", "")) << "turned, beside it";
  EXPECT_THAT(RejectionsOf({Lorry(1), Lorry(2, -10.5)}), ElementsAre("", "")) << "close behind";
  SimulatedTracklet oncoming = Lorry(2, 9, 3.2, kPi);
  oncoming.velocity_enu *= -1;
  EXPECT_THAT(RejectionsOf({Lorry(1), oncoming}), ElementsAre("", "")) << "it passes";
}

// Seen from behind, two in a row overlap in the image.
TEST(AssociateTracklets, ARowSeenFromBehindStaysTwo) {
  SimulatedTracklet first = Lorry(1);
  first.heading_rad = 0.5;
  first.velocity_enu.setZero();
  SimulatedTracklet second = first;
  second.id = 2;
  second.place_enu += 11 * Eigen::Vector3d(std::sin(0.5), std::cos(0.5), 0);
  EXPECT_THAT(RejectionsOf({first, second}), ElementsAre("", ""));
}

TEST(AssociateTracklets, OneThatHoversAboveTheOtherStays) {
  SimulatedTracklet below = Lorry(1);
  below.velocity_enu.setZero();
  SimulatedTracklet above = below;
  above.id = 2;
  above.place_enu += 30 * Eigen::Vector3d(-42, -70, 100).normalized();
  EXPECT_THAT(RejectionsOf({below, above}), ElementsAre("", ""));
}

TEST(AssociateTracklets, CategoriesHaveAPlaceAndRejectNoObject) {
  const SimulatedTracklet category{.id = 2, .model = 2, .frames = 40, .is_category = true, .noise_rad = 0.01};
  const auto objects = ObjectsFrom({{.id = 1, .frames = 20}, category});
  for (const ObjectRecord& object : objects) {
    EXPECT_EQ(object.rejected, "");
    ASSERT_TRUE(object.place);
    EXPECT_LT(TangentPlane(kOrigin).EnuFromGeodetic(object.place->point).head<2>().norm(), 5);
  }
}

TEST(AssociateTracklets, CategoryWithNonIntersectingLinesHasNoPlace) {
  SimulatedTracklet seen{.id = 1, .is_category = true, .noise_rad = 0.3};
  ObservedTracklet tracklet = SimulateTracklet(seen);
  for (BearingObservation& observation : tracklet.observations) observation.line.sigma_rad = 1e-4;
  const auto objects = AssociateTracklets({tracklet}, SearchesOf(0), {});
  EXPECT_EQ(objects[0].rejected, "");
  EXPECT_THAT(objects[0].place_rejected, HasSubstr("do not intersect"));
  EXPECT_FALSE(objects[0].place);
}

TEST(ObjectParameter, MergeGateOfZeroMergesNone) {
  const std::vector<SimulatedTracklet> twice = {{.id = 1, .frames = 20}, {.id = 2, .first_frame = 70, .frames = 20}};
  EXPECT_EQ(ObjectsFrom(twice, {.merge_gate_sigma = 3.5}).size(), 1U);
  EXPECT_EQ(ObjectsFrom(twice, {.merge_gate_sigma = 0}).size(), 2U);
}

TEST(ObjectParameter, PlacesFurtherApartThanTheMaxMergeDistanceStayTwo) {
  const std::vector<SimulatedTracklet> apart = {
      {.id = 1, .place_enu = {-5, 0, 1}, .frames = 20},
      {.id = 2, .place_enu = {5, 0, 1}, .first_frame = 30, .frames = 20},
  };
  EXPECT_EQ(ObjectsFrom(apart, {.merge_gate_sigma = 100, .max_merge_distance_m = 9}).size(), 2U);
  EXPECT_EQ(ObjectsFrom(apart, {.merge_gate_sigma = 100, .max_merge_distance_m = 11}).size(), 1U);
}

// Three lines in ten are wrong.
TEST(ObjectParameter, MinInlierFractionIsThatOfTheLines) {
  ObservedTracklet tracklet = SimulateTracklet({.id = 1, .frames = 30});
  for (std::size_t i = 0; i < tracklet.observations.size(); ++i) {
    if (i % 10 < 3) tracklet.observations[i].line.azimuth_rad += i % 2 == 0 ? 0.5 : -0.5;
  }
  const auto rejected = [&](double min_inlier_fraction) {
    return AssociateTracklets({tracklet}, SearchesOf(100), {.min_inlier_fraction = min_inlier_fraction})[0]
        .place_rejected;
  };
  EXPECT_EQ(rejected(0.6), "");
  EXPECT_THAT(rejected(0.8), HasSubstr("do not intersect"));
}

}  // namespace
}  // namespace victorious
