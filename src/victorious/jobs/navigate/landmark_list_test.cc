#include "victorious/jobs/navigate/landmark_list.h"

#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/store/index_store.h"

namespace victorious {
namespace {

constexpr std::string_view kLine =
    R"({"model":"jeep","latitude_deg":52.5,"longitude_deg":13.4,"altitude_m":75.5,"heading_deg":90})";

LandmarkList Parsed(std::string_view text) {
  Expected<LandmarkList> list = ParseLandmarks(text, {});
  EXPECT_TRUE(list.has_value());
  return list ? *std::move(list) : LandmarkList{};
}

TEST(LandmarkList, ReadsExportedObjects) {
  const LandmarkList list =
      Parsed(R"({"object_id":1,"model":"jeep","category":null,"rank":1,"latitude_deg":52.5,"longitude_deg":13.4,)"
             R"("altitude_m":75.5,"covariance_enu_m2":[[0.04,0.01,0],[0.01,0.09,0],[0,0,0.25]],"heading_deg":90.0,)"
             R"("speed_m_s":0.0})"
             "\n");
  ASSERT_EQ(list.landmarks.size(), 1);
  EXPECT_TRUE(list.warnings.empty());
  const Landmark& landmark = list.landmarks.front();
  EXPECT_EQ(landmark.model, "jeep");
  EXPECT_NEAR(landmark.place.latitude_rad, RadiansFromDegrees(52.5), 1e-12);
  EXPECT_EQ(landmark.place.altitude_m, 75.5);
  EXPECT_NEAR(*landmark.heading_rad, kPi / 2, 1e-12);
  EXPECT_NEAR(landmark.sigma_heading_rad, RadiansFromDegrees(LandmarkListOptions().heading_deg), 1e-12);
  EXPECT_NEAR(landmark.covariance_enu_m2(0, 1), 0.01, 1e-9);
  EXPECT_NEAR(landmark.covariance_enu_m2(2, 2), 0.25, 1e-9);
}

TEST(LandmarkList, MissingColumnsAreExactOrUnknown) {
  const LandmarkList list =
      Parsed(R"({"model":"jeep","latitude_deg":52.5,"longitude_deg":13.4,"altitude_m":75.5,"heading_deg":null})");
  EXPECT_FALSE(list.landmarks.front().heading_rad);
  EXPECT_EQ(list.landmarks.front().covariance_enu_m2, Eigen::Matrix3d::Zero());
}

TEST(LandmarkList, SkipsUnusableRows) {
  const std::vector<std::string> lines = {
      "not json",
      "[1, 2]",
      R"({"latitude_deg":52.5,"longitude_deg":13.4,"altitude_m":75.5})",
      R"({"model":"jeep","latitude_deg":95,"longitude_deg":13.4,"altitude_m":75.5})",
      R"({"model":"jeep","latitude_deg":null,"longitude_deg":null,"altitude_m":null})",
      R"({"model":"jeep","latitude_deg":"52","longitude_deg":13.4,"altitude_m":75.5})",
      R"({"model":"jeep","latitude_deg":52,"longitude_deg":13.4,"altitude_m":75.5,"speed_m_s":5})",
      R"({"model":"jeep","latitude_deg":52,"longitude_deg":13.4,"altitude_m":7,"covariance_enu_m2":[[1,0],[0,1]]})",
      R"({"model":"jeep","latitude_deg":5,"longitude_deg":1,"altitude_m":7,"covariance_enu_m2":[[-1,0,0],[0,1,0],[0,0,1]]})",
      R"({"model":"jeep","latitude_deg":5,"longitude_deg":1,"altitude_m":7,"covariance_enu_m2":[[1,5,0],[0,1,0],[0,0,1]]})",
      R"({"model":"jeep","latitude_deg":52,"longitude_deg":13.4,"altitude_m":75.5,"heading_deg":1e9})",
  };
  for (const std::string& line : lines) {
    const LandmarkList list = Parsed(line + "\n\n" + std::string(kLine));
    EXPECT_EQ(list.landmarks.size(), 1) << line;
    ASSERT_EQ(list.warnings.size(), 1) << line;
    EXPECT_TRUE(list.warnings.front().starts_with("line 1 is skipped: ")) << list.warnings.front();
    const auto alone = ParseLandmarks(line, {});
    ASSERT_FALSE(alone) << line;
    EXPECT_EQ(alone.error().code, ErrorCode::kInvalidArgument);
  }
  EXPECT_EQ(ParseLandmarks("", {}).error().code, ErrorCode::kInvalidArgument);
}

TEST(LandmarkList, WarnsOfTheFirstSkippedRows) {
  std::string text(kLine);
  for (int i = 0; i < 1000; ++i) text += "\nnot json";
  const LandmarkList list = Parsed(text);
  EXPECT_EQ(list.landmarks.size(), 1);
  ASSERT_EQ(list.warnings.size(), 21);
  EXPECT_TRUE(list.warnings.front().starts_with("line 2 is skipped: ")) << list.warnings.front();
  EXPECT_EQ(list.warnings.back(), "and 980 more warnings of this kind");
}

TEST(LandmarkList, DistinguishesIndexFromList) {
  const testing::ScratchFolder scratch;
  const std::filesystem::path list = scratch / "list.jsonl";
  ASSERT_TRUE(WriteFileAtomically(list, kLine));
  EXPECT_EQ(ReadLandmarks(list, {})->landmarks.size(), 1);

  const std::filesystem::path empty = scratch / "index.db";
  ASSERT_TRUE(OpenSqliteStore(empty, StoreMode::kCreate));
  const auto none = ReadLandmarks(empty, {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(none.error().message.starts_with(empty.string())) << none.error().message;

  EXPECT_EQ(ReadLandmarks(scratch / "missing", {}).error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace victorious
