#include "victorious/place/associate/place_grid.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Law: Near() contains the items within the reach, in order.
TEST(PlaceGrid, FindsAllPlacesWithinTheReach) {
  constexpr double kReach_m = 9.5;
  for (const GeodeticPoint& origin : {GeodeticPoint{RadiansFromDegrees(48), RadiansFromDegrees(11), 500},
                                      GeodeticPoint{RadiansFromDegrees(-89.9999), RadiansFromDegrees(180), 0}}) {
    const TangentPlane plane(origin);
    Random random(3);
    PlaceGrid grid(kReach_m);
    std::vector<GeodeticPoint> points;
    for (std::int64_t i = 0; i < 400; ++i) {
      points.push_back(
          plane.GeodeticFromEnu({random.Uniform(-60, 60), random.Uniform(-60, 60), random.Uniform(-5, 5)}));
      grid.Add(points.back(), i);
    }
    int found = 0;
    for (const GeodeticPoint& point : points) {
      const std::vector<std::int64_t> near = grid.Near(point);
      EXPECT_TRUE(std::ranges::is_sorted(near));
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double apart_m = TangentPlane(point).EnuFromGeodetic(points[i]).norm();
        const bool is_near = std::ranges::binary_search(near, static_cast<std::int64_t>(i));
        EXPECT_FALSE(apart_m <= kReach_m && !is_near) << apart_m;
        EXPECT_FALSE(apart_m > kReach_m + 0.01 && is_near) << apart_m;
        found += is_near ? 1 : 0;
      }
    }
    EXPECT_GT(found, 400 + 100) << "themselves and others";
  }
}

TEST(PlaceGrid, RemovedItemsAreNotFound) {
  const GeodeticPoint point{1, 2, 3};
  PlaceGrid grid(0);
  grid.Add(point, 7);
  grid.Add(point, 5);
  EXPECT_THAT(grid.Near(point), ElementsAre(5, 7));
  grid.Remove(point, 7);
  EXPECT_THAT(grid.Near(point), ElementsAre(5));
  grid.Remove(point, 5);
  EXPECT_THAT(grid.Near(point), IsEmpty());
}

}  // namespace
}  // namespace victorious
