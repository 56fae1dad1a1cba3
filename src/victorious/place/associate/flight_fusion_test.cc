#include "victorious/place/associate/flight_fusion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/place/associate/associate_objects.h"
#include "victorious/place/associate/simulated_tracklet_test.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;

constexpr double kEpoch_s = 1.78e9;

// A car that is seen at 100 m, from `first_s` to `last_s`, with places each tenth of a second.
ObjectInFlight Flight(const Eigen::Vector3d& start_enu, const Eigen::Vector3d& velocity_enu, double first_s,
                      double last_s, const Eigen::Vector3d& common_sigma_m, double clock_s = 0) {
  const TangentPlane plane(kOrigin);
  ObjectInFlight flight;
  flight.utc_offset_s = kEpoch_s + clock_s;
  flight.first_s = kEpoch_s + first_s;
  flight.last_s = kEpoch_s + last_s;
  flight.observations = 10;
  for (double time_s = first_s; time_s < last_s + 0.05; time_s += 0.1) {
    Geolocation place{.point = plane.GeodeticFromEnu(start_enu + time_s * velocity_enu),
                      .time_s = time_s - clock_s,
                      .covariance_enu_m2 = 0.01 * Eigen::Matrix3d::Identity(),
                      .velocity_enu = velocity_enu,
                      .velocity_covariance_enu = 0.01 * Eigen::Matrix3d::Identity()};
    flight.relative.path.push_back(place);
  }
  flight.relative.place = flight.relative.path.back();
  flight.relative.path_size = flight.relative.path.size();
  flight.relative.inlier_fraction = 1;
  Geolocation absolute = *flight.relative.place;
  absolute.covariance_enu_m2 += common_sigma_m.cwiseAbs2().asDiagonal();
  flight.SetPlaces(flight.relative, absolute);
  return flight;
}

Eigen::Vector3d EnuOf(const ObjectPlace& estimate) {
  return TangentPlane(kOrigin).EnuFromGeodetic(estimate.place->point);
}

const Eigen::Vector3d kNorth(0, 8, 0);
const Eigen::Vector3d kSigma_m(2, 2, 2);

// A car that stands, with errors inside the flight of 0.1 m.
ObjectInFlight Parked(const Eigen::Vector3d& enu, const Eigen::Vector3d& common_sigma_m) {
  ObjectInFlight flight;
  flight.observations = 10;
  flight.relative.place = Geolocation{.point = TangentPlane(kOrigin).GeodeticFromEnu(enu),
                                      .covariance_enu_m2 = 0.01 * Eigen::Matrix3d::Identity()};
  flight.relative.inlier_fraction = 1;
  Geolocation absolute = *flight.relative.place;
  absolute.covariance_enu_m2 += common_sigma_m.cwiseAbs2().asDiagonal();
  flight.SetPlaces(flight.relative, absolute);
  return flight;
}

ObjectPlace Fuse(const std::vector<ObjectInFlight>& flights) {
  std::vector<const ObjectInFlight*> pointers;
  for (const ObjectInFlight& flight : flights) pointers.push_back(&flight);
  return FuseFlights(pointers);
}

TEST(CompareFlights, MeasuresWhereBothSeeTheObject) {
  const ObjectInFlight a = Flight({0, 0, 1}, kNorth, 0, 4, kSigma_m);
  const ObjectInFlight b = Flight({3, 0, 1}, kNorth, 2, 6, kSigma_m, 100);
  const auto difference = CompareFlights(a, b, /*moves=*/true);
  ASSERT_TRUE(difference);
  EXPECT_LT((difference->offset.enu_m - Eigen::Vector3d(3, 0, 0)).norm(), 0.01);
  EXPECT_NEAR(difference->offset.covariance_m2(0, 0), 0.5 + 0.02, 0.1) << "slack and the errors inside the flights";
  EXPECT_NEAR(difference->flights_m2(0, 0), 2 * 4, 0.1);
  EXPECT_LT(difference->change_sigmas, 0.1);
}

TEST(CompareFlights, PathsThatPartAreNotOne) {
  const ObjectInFlight a = Flight({0, 0, 1}, kNorth, 0, 4, kSigma_m);
  const ObjectInFlight b = Flight({0, 4, 1}, 0.5 * kNorth, 0, 4, kSigma_m);
  const auto difference = CompareFlights(a, b, /*moves=*/true);
  ASSERT_TRUE(difference);
  EXPECT_GT(difference->change_sigmas, 8);
}

TEST(CompareFlights, ALongGapSaysNothingOfWhatMoves) {
  const ObjectInFlight a = Flight({0, 0, 1}, kNorth, 0, 4, kSigma_m);
  EXPECT_TRUE(CompareFlights(a, Flight({0, 0, 1}, kNorth, 5, 7, kSigma_m), /*moves=*/true));
  EXPECT_FALSE(CompareFlights(a, Flight({0, 0, 1}, kNorth, 7, 9, kSigma_m), /*moves=*/true));
}

TEST(CompareFlights, StandingObjectsNeedNoUtc) {
  const auto difference = CompareFlights(Parked({0, 0, 1}, kSigma_m), Parked({0, 5, 1}, kSigma_m), /*moves=*/false);
  ASSERT_TRUE(difference);
  EXPECT_NEAR(difference->offset.enu_m.y(), 5, 0.01);
}

TEST(FuseFlights, EachFlightMeasuresTheErrorOfTheOther) {
  const ObjectInFlight a = Flight({0, 0, 1}, kNorth, 0, 4, kSigma_m);
  const ObjectInFlight b = Flight({2, 0, 1}, kNorth, 0, 3.5, kSigma_m, 100);
  const ObjectPlace fused = Fuse({b, a});
  EXPECT_NEAR(fused.place->time_s, 4, 1e-6) << "on the clock of the flight that sees it last";
  EXPECT_LT((EnuOf(fused) - Eigen::Vector3d(1, 32, 1)).norm(), 0.05);
  EXPECT_NEAR(fused.place->covariance_enu_m2(0, 0), 2, 0.1) << "half of 2^2";
  EXPECT_EQ(fused.place->velocity_enu, kNorth);
  EXPECT_FALSE(fused.HasPath());
  EXPECT_LT(fused.place->ce90_m, 0.75 * Fuse({a}).place->ce90_m);
}

TEST(FuseFlights, TheCertainFlightDecides) {
  const ObjectInFlight a = Flight({0, 0, 1}, kNorth, 0, 4, {20, 20, 20});
  const ObjectInFlight b = Flight({9, 0, 1}, kNorth, 0, 4, {1, 1, 1});
  EXPECT_NEAR(EnuOf(Fuse({a, b})).x(), 9, 0.1);
  EXPECT_NEAR(EnuOf(Fuse({Parked({0, 0, 1}, {20, 20, 20}), Parked({9, 0, 1}, {1, 1, 1})})).x(), 9, 0.1);
}

TEST(FuseFlights, PlacesOfWhatStandsAreWeightedByTheirInformation) {
  ObjectInFlight a = Parked({0, 0, 1}, {1, 3, 2});
  ObjectInFlight b = Parked({4, 4, 1}, {3, 1, 2});
  a.relative.size_ratio = 1.2;
  a.relative.heading_rad = 1;
  a.relative.headings = 3;
  b.relative.inlier_fraction = 0.5;
  const ObjectPlace fused = Fuse({a, b});
  EXPECT_LT((EnuOf(fused) - Eigen::Vector3d(0.4, 3.6, 1)).norm(), 0.02);
  EXPECT_NEAR(fused.place->covariance_enu_m2(0, 0), 0.9, 0.02);
  EXPECT_NEAR(fused.place->covariance_enu_m2(2, 2), 2, 0.02);
  EXPECT_DOUBLE_EQ(fused.inlier_fraction, 0.75);
  EXPECT_NEAR(*fused.size_ratio, 1.2, 1e-9);
  EXPECT_EQ(fused.heading_rad, 1);
}

// Cars that two drones see at the same time, the second one on a clock that is 100 s behind.
class TwoDrones {
 public:
  void See(const Eigen::Vector3d& start_enu, const Eigen::Vector3d& velocity_enu, bool has_utc = true,
           double later_s = 0) {
    for (const std::int64_t video : {1, 2}) {
      SimulatedTracklet seen{.id = static_cast<std::int64_t>(tracklets_.size()) + 1,
                             .video = video,
                             .place_enu = start_enu,
                             .velocity_enu = velocity_enu,
                             .frames = 40};
      if (video == 2) {
        seen.camera_from_m = 80;
        seen.camera_speed_m_s = -15;
        seen.camera_bias_enu = {1, -1, 0.5};
      }
      ObservedTracklet tracklet = SimulateTracklet(seen);
      if (has_utc) tracklet.start_utc_us = static_cast<std::int64_t>(1e6 * (kEpoch_s + (video - 1) * later_s));
      tracklets_.push_back(std::move(tracklet));
    }
  }

  [[nodiscard]] std::vector<std::vector<std::int64_t>> Objects() const {
    SearchCounts counts;
    for (const std::int64_t video : {1, 2}) counts.Add(video, 100, {});
    objects_ = AssociateTracklets(tracklets_, counts, {});
    std::vector<std::vector<std::int64_t>> tracklets;
    for (const ObjectRecord& object : objects_) tracklets.push_back(object.tracklets);
    return tracklets;
  }

  [[nodiscard]] const std::vector<ObjectRecord>& records() const { return objects_; }

 private:
  std::vector<ObservedTracklet> tracklets_;
  mutable std::vector<ObjectRecord> objects_;
};

TEST(TwoDrones, SeeOneCarThatDrives) {
  TwoDrones drones;
  drones.See({0, -10, 1}, kNorth);
  EXPECT_THAT(drones.Objects(), ElementsAre(ElementsAre(1, 2)));
  const ObjectRecord& car = drones.records()[0];
  ASSERT_TRUE(car.place);
  EXPECT_NEAR(car.place->velocity_enu->y(), 8, 0.3);
  const Eigen::Vector3d truth = Eigen::Vector3d(0, -10, 1) + car.place->time_s * kNorth;
  EXPECT_LT((TangentPlane(kOrigin).EnuFromGeodetic(car.place->point) - truth).head<2>().norm(), car.place->ce90_m);
  EXPECT_EQ(car.rejected, "");
  EXPECT_EQ(car.place_rejected, "");
}

TEST(TwoDrones, KeepCarsApartThatMeet) {
  TwoDrones drones;
  drones.See({-1.5, -16, 1}, kNorth);
  drones.See({1.5, 16, 1}, -kNorth);
  EXPECT_THAT(drones.Objects(), ElementsAre(ElementsAre(1, 2), ElementsAre(3, 4)));
}

TEST(TwoDrones, DoNotJoinWithoutUtcOrAtAnotherTime) {
  TwoDrones without;
  without.See({0, -10, 1}, kNorth, /*has_utc=*/false);
  EXPECT_EQ(without.Objects().size(), 2U);
  TwoDrones later;
  later.See({0, -10, 1}, kNorth, /*has_utc=*/true, /*later_s=*/30);
  EXPECT_EQ(later.Objects().size(), 2U);
}

}  // namespace
}  // namespace victorious
