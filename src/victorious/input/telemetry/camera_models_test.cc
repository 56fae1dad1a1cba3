#include "victorious/input/telemetry/camera_models.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

TEST(CameraModels, AreFoundByAircraftAndByCode) {
  for (const char* name : {"mavic-pro", "Mavic Pro", "DJI Mavic Pro", "FC220", "fc220"}) {
    const CameraModel* model = FindCameraModel(name);
    ASSERT_NE(model, nullptr) << name;
    EXPECT_EQ(model->code, "FC220") << name;
  }
  EXPECT_EQ(FindCameraModel("FC6310R")->aircraft, "phantom-4-rtk") << "not FC6310, with which it begins";
  for (const char* name : {"", "DJI", "mavic", "FC22"}) EXPECT_EQ(FindCameraModel(name), nullptr) << name;
}

TEST(CameraModels, NamesAreUniqueAndFieldsOfViewPossible) {
  std::set<std::string_view> names;
  for (const CameraModel& model : CameraModels()) {
    EXPECT_TRUE(names.insert(model.aircraft).second) << model.aircraft;
    EXPECT_TRUE(names.insert(model.code).second) << model.code;
    EXPECT_EQ(FindCameraModel(model.aircraft), &model);
    EXPECT_EQ(FindCameraModel(model.code), &model);
    EXPECT_GT(model.diagonal_deg, 10);
    EXPECT_LT(model.diagonal_deg, 100);
  }
}

// 8.8 mm on a sensor 13.2 mm wide; 3.61 mm on one 6.17 mm wide.
TEST(CameraModels, FieldOfViewIsThatOfLensAndSensor) {
  EXPECT_NEAR(DegreesFromRadians(FieldOfView(*FindCameraModel("phantom-4-pro"), std::nullopt)), 73.7, 0.5);
  EXPECT_NEAR(DegreesFromRadians(FieldOfView(*FindCameraModel("phantom-3-pro"), std::nullopt)), 81.0, 0.5);
  EXPECT_NEAR(DegreesFromRadians(FieldOfView(*FindCameraModel("mavic-3"), 24)), 71.6, 0.1);
  EXPECT_NEAR(DegreesFromRadians(FieldOfView(*FindCameraModel("mavic-3t"), 643.3)), 3.08, 0.01);
}

TEST(CameraModels, AnUnknownCameraIsWithinFourPercentOfTheKnownOnes) {
  for (const CameraModel& model : CameraModels()) {
    for (const double focal_mm : {20.0, 24.0, 70.0, 162.0}) {
      EXPECT_NEAR(FocalFromFieldOfView(FieldOfViewFromFocal(focal_mm)), focal_mm, 1e-9);
      EXPECT_NEAR(FieldOfViewFromFocal(focal_mm) / FieldOfView(model, focal_mm), 1, 0.042) << model.aircraft;
    }
  }
}

}  // namespace
}  // namespace victorious
