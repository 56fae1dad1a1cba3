#include "victorious/jobs/index/shown_ground.h"

#include <cmath>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/geodesy.h"

namespace victorious {
namespace {

constexpr double kEarthRadius_m = 6.37e6;

CameraState StateAt(double time_s, double longitude_deg, double pitch_deg) {
  return {.time_s = time_s,
          .place = {RadiansFromDegrees(52.0), RadiansFromDegrees(longitude_deg), 300},
          .attitude = Attitude{.yaw_rad = 0, .pitch_rad = RadiansFromDegrees(pitch_deg), .roll_rad = 0},
          .hfov_rad = RadiansFromDegrees(40.0)};
}

bool Holds(const GeoBox& box, double latitude_rad, double longitude_rad) {
  return box.south_rad <= latitude_rad && latitude_rad <= box.north_rad && box.west_rad <= longitude_rad &&
         longitude_rad <= box.east_rad;
}

TEST(ShownGround, HoldsWhatIsSeenAtAnyHeightOfTheGround) {
  const CameraState state = StateAt(0, 13, -45);
  const auto boxes = ShownGround(std::span(&state, 1), 640, 480);
  ASSERT_EQ(boxes.size(), 1U);
  for (const double ground_m : {-400.0, 0.0, 290.0}) {
    // The middle of the frame lies as far to the north as the camera is high.
    const double north_rad = (300 - ground_m) / kEarthRadius_m;
    EXPECT_TRUE(Holds(boxes.front(), state.place.latitude_rad + north_rad, state.place.longitude_rad)) << ground_m;
  }
  EXPECT_FALSE(Holds(boxes.front(), state.place.latitude_rad - 10 / kEarthRadius_m, state.place.longitude_rad))
      << "behind the camera";
  EXPECT_FALSE(Holds(boxes.front(), state.place.latitude_rad + 5000 / kEarthRadius_m, state.place.longitude_rad));
}

TEST(ShownGround, StatesThatShowNoGroundHaveNoBox) {
  CameraState without = StateAt(0, 13, -45);
  without.attitude.reset();
  CameraState fast = StateAt(0, 13, -45);
  fast.hfov_rad.reset();
  for (const CameraState& state : {without, fast, StateAt(0, 13, -5), StateAt(0, 13, 20)}) {
    EXPECT_TRUE(ShownGround(std::span(&state, 1), 640, 480).empty());
  }
  EXPECT_TRUE(ShownGround({}, 640, 480).empty());
  const CameraState state = StateAt(0, 13, -45);
  EXPECT_TRUE(ShownGround(std::span(&state, 1), 0, 0).empty());
}

TEST(ShownGround, LongFlightsHaveFewBoxes) {
  std::vector<CameraState> states;
  for (int i = 0; i < 1000; ++i) states.push_back(StateAt(i, 13 + 0.001 * i, -60));
  const auto boxes = ShownGround(states, 640, 480);
  EXPECT_LE(boxes.size(), kMaxShownGroundBoxes);
  EXPECT_GT(boxes.size(), kMaxShownGroundBoxes / 2);
  const double latitude_rad = states.front().place.latitude_rad + 200 / kEarthRadius_m;
  for (const CameraState& state : states) {
    EXPECT_TRUE(std::ranges::any_of(boxes, [&](const GeoBox& box) {
      return Holds(box, latitude_rad, state.place.longitude_rad);
    })) << state.time_s;
  }
  EXPECT_LT(boxes.front().east_rad, boxes.back().west_rad) << "each has its own part";
}

TEST(ShownGround, OfTheAntimeridianHasAllLongitudes) {
  const CameraState state = StateAt(0, 180, -60);
  const auto boxes = ShownGround(std::span(&state, 1), 640, 480);
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_TRUE(Holds(boxes.front(), state.place.latitude_rad + 200 / kEarthRadius_m, RadiansFromDegrees(-179.999)));
  EXPECT_TRUE(Holds(boxes.front(), state.place.latitude_rad + 200 / kEarthRadius_m, RadiansFromDegrees(179.999)));
}

}  // namespace
}  // namespace victorious
