#include "victorious/place/associate/flight_registration.h"

#include <gtest/gtest.h>

#include "victorious/place/associate/merge_flights.h"
#include "victorious/place/associate/simulated_tracklet_test.h"

namespace victorious {
namespace {

constexpr double kGate = 3.5;

// Parked objects that two flights place, whose telemetry has errors of 4 m.
class TwoFlights {
 public:
  // @param second_is_off  the place by the second flight minus that by the first one; std::nullopt: it does not see it
  void Add(std::int64_t model, const Eigen::Vector3d& enu, std::optional<Eigen::Vector3d> second_is_off) {
    Place(1, model, enu);
    if (second_is_off) Place(2, model, enu + *second_is_off);
  }

  [[nodiscard]] FlightRegistrations Register() const { return RegisterFlights(objects_, kGate); }

  // Pairs of one object, of model 1.
  [[nodiscard]] std::size_t CountPairs() const {
    ObjectInFlights of_model;
    for (const ObjectInFlight& object : objects_) {
      if (object.model == 1) of_model.push_back(&object);
    }
    const auto merged = MergeFlights(of_model, Register(), {}, {});
    return static_cast<std::size_t>(
        std::ranges::count_if(merged, [](const ObjectInFlights& flights) { return flights.size() == 2; }));
  }

 private:
  void Place(std::int64_t video, std::int64_t model, const Eigen::Vector3d& enu) {
    ObjectInFlight object;
    object.id = static_cast<std::int64_t>(objects_.size()) + 1;
    object.video = video;
    object.model = model;
    object.relative.place = Geolocation{.point = TangentPlane(kOrigin).GeodeticFromEnu(enu),
                                        .covariance_enu_m2 = 0.04 * Eigen::Matrix3d::Identity()};
    Geolocation absolute = *object.relative.place;
    absolute.covariance_enu_m2 += 16 * Eigen::Matrix3d::Identity();
    object.SetPlaces(object.relative, absolute);
    objects_.push_back(object);
  }

  std::vector<ObjectInFlight> objects_;
};

const Eigen::Vector3d kOffset(10, -7, 2);  // 12.4 m

TEST(RegisterFlights, EqualDifferencesShowTheOffset) {
  TwoFlights flights;
  flights.Add(1, {0, 0, 1}, kOffset);
  flights.Add(2, {30, 10, 1}, kOffset + Eigen::Vector3d(0.3, 0, 0));
  flights.Add(3, {-20, 40, 1}, kOffset + Eigen::Vector3d(0, -0.3, 0));
  flights.Add(4, {15, 25, 1}, std::nullopt);
  const FlightRegistrations registrations = flights.Register();
  const auto offset = registrations.Between(1, 2);
  ASSERT_TRUE(offset);
  EXPECT_LT((offset->enu_m - kOffset).norm(), 0.6) << "drawn to zero a little, which is most probable beforehand";
  EXPECT_LT(offset->covariance_m2(0, 0), 0.3);
  EXPECT_EQ(registrations.Between(2, 1)->enu_m, -offset->enu_m);
  EXPECT_FALSE(registrations.Between(1, 3));
  EXPECT_NEAR(registrations.MaxOffset_m(), kOffset.norm(), 0.6);
}

TEST(RegisterFlights, TwoObjectsAreTooFew) {
  TwoFlights flights;
  flights.Add(1, {0, 0, 1}, kOffset);
  flights.Add(2, {30, 10, 1}, kOffset);
  EXPECT_FALSE(flights.Register().Between(1, 2));
}

TEST(RegisterFlights, ARowOfEqualVehiclesIsAmbiguous) {
  TwoFlights flights;
  for (int i = 0; i < 5; ++i) flights.Add(1, {4.0 * i, 0, 1}, Eigen::Vector3d(4, 0, 0));
  EXPECT_FALSE(flights.Register().Between(1, 2));
}

TEST(RegisterFlights, OffsetsThatTelemetryExcludesAreNone) {
  TwoFlights flights;
  for (const std::int64_t model : {1, 2, 3})
    flights.Add(model, {30.0 * static_cast<double>(model), 0, 1}, {{25, 0, 0}});
  EXPECT_FALSE(flights.Register().Between(1, 2)) << "25 m at a standard deviation of 5.7";
}

TEST(MergeFlights, RegisteredFlightsAgreeOnWhatIsFarApart) {
  TwoFlights flights;
  flights.Add(1, {0, 0, 1}, kOffset);
  EXPECT_EQ(flights.CountPairs(), 0U) << "beyond max_merge_distance_m";
  flights.Add(2, {30, 10, 1}, kOffset);
  flights.Add(3, {-20, 40, 1}, kOffset);
  EXPECT_EQ(flights.CountPairs(), 1U);
}

TEST(MergeFlights, RegisteredFlightsSeparateNeighbours) {
  const Eigen::Vector3d off(4, 0, 0);
  TwoFlights flights;
  flights.Add(1, {0, 0, 1}, std::nullopt);
  flights.Add(1, {4, 0, 1}, off);  // the second flight places it 8 m from the first object
  EXPECT_EQ(flights.CountPairs(), 1U);
  flights.Add(2, {30, 10, 1}, off);
  flights.Add(3, {-20, 40, 1}, off);
  flights.Add(1, {-4, 0, 1}, off);  // and this one where the first object is
  EXPECT_EQ(flights.CountPairs(), 2U);
}

}  // namespace
}  // namespace victorious
