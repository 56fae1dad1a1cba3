#include "victorious/jobs/index/search_scale.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "testing/data.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/search/follow/follower.h"

namespace victorious {
namespace {

constexpr double kHfov_rad = RadiansFromDegrees(40);
constexpr double kHeight_m = 100;
constexpr int kInterval = 60;
constexpr double kObject_px = 100;

// 8 m long: a diagonal of 9 m.
ObjectModel Truck() {
  ObjectModel model;
  model.name = "truck";
  model.box_m = Eigen::AlignedBox3d(Eigen::Vector3d(-4, -2, 0), Eigen::Vector3d(4, 2, 1));
  return model;
}

ObjectModel Photo() {
  ObjectModel model;
  model.name = "photo";
  return model;
}

VideoInfo Info(int width, int height) {
  VideoInfo info;
  info.width = width;
  info.height = height;
  info.frame_rate = 30;
  info.duration_s = 10;
  return info;
}

class SearchScaleTest : public ::testing::Test {
 protected:
  // Looks straight down from kHeight_m above the ground; from `climb_s` on from ten times that.
  CameraStates Cameras(double climb_s = 1e9) {
    std::string csv = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n";
    for (double time_s = 0; time_s <= 10; time_s += 0.5) {
      csv += std::to_string(time_s) + ",48.1,11.5," + std::to_string(500 + (time_s < climb_s ? 1 : 10) * kHeight_m) +
             ",0,-90,0,40\n";
    }
    const std::string file = (scratch_ / "t.csv").string();
    EXPECT_TRUE(WriteFileAtomically(file, csv));
    CameraStates cameras =
        CameraStates::Load("v.mp4", Info(1920, 1080), file, {}, "", [](const std::string&) {}).value();
    cameras.SetGroundHeight(GroundHeight{.height_m = 500, .datum = VerticalDatum::kEllipsoid});
    return cameras;
  }

  testing::ScratchFolder scratch_;
  std::vector<ObjectModel> models_ = {Truck()};
};

TEST_F(SearchScaleTest, ASmallModelKeepsItsPixels) {
  const CameraStates cameras = Cameras();
  const SearchScale scale(
      {.models = models_, .cameras = cameras, .object_px = kObject_px, .restart_interval_frames = kInterval},
      Info(1920, 1080));
  const FrameSizes sizes = scale.SizesAt(0, {1920, 1080});
  // In the corner, 22.6 degrees off nadir.
  const double focal = 0.5 * sizes.searched.width / std::tan(kHfov_rad / 2);
  const double range_m = kHeight_m * std::hypot(1.0, std::hypot(960.0, 540.0) / (960 / std::tan(kHfov_rad / 2)));
  const double object_px = 9 * focal / range_m;
  EXPECT_GE(object_px, kObject_px);
  EXPECT_LT(object_px, 1.03 * kObject_px);
  EXPECT_EQ(sizes.searched.width * 9, sizes.searched.height * 16);
  EXPECT_EQ(ShrinkTo(sizes.searched, cv::Mat(1080, 1920, CV_8UC1, cv::Scalar(7))).size(), sizes.searched);
}

TEST_F(SearchScaleTest, BoxesComeBackInPixelsOfTheFrame) {
  const FrameSizes sizes{{1920, 1080}, {960, 540}};
  const Box box = sizes.ToFilmed(Box{10, 20, 30, 40});
  EXPECT_EQ(box.x, 20);
  EXPECT_EQ(box.y, 40);
  EXPECT_EQ(box.width, 60);
  EXPECT_EQ(box.height, 80);
  EXPECT_EQ(sizes.ToFilmed(Polygon{{1, 2}}).front(), Eigen::Vector2d(2, 4));
}

TEST_F(SearchScaleTest, LargeFramesOfOneFlightAreSearchedInOneSize) {
  const CameraStates cameras = Cameras();
  const auto width = [&](int filmed_width, int filmed_height) {
    const SearchScale scale(
        {.models = models_, .cameras = cameras, .object_px = kObject_px, .restart_interval_frames = kInterval},
        Info(filmed_width, filmed_height));
    return scale.SizesAt(0, {filmed_width, filmed_height}).searched.width;
  };
  EXPECT_NEAR(width(3840, 2160), width(1920, 1080), 16);
  EXPECT_EQ(width(640, 480), 640);  // the truck has 75 px there
}

// As of a CAD file in feet.
TEST_F(SearchScaleTest, ALengthThatIsWrongDoesNotBlindTheSearch) {
  Eigen::AlignedBox3d& box = *models_[0].box_m;
  box = Eigen::AlignedBox3d(40 * box.min(), 40 * box.max());
  const CameraStates cameras = Cameras();
  const auto searched = [&](int width, int height) {
    const SearchScale scale(
        {.models = models_, .cameras = cameras, .object_px = kObject_px, .restart_interval_frames = kInterval},
        Info(width, height));
    return scale.SizesAt(0, {width, height}).searched;
  };
  EXPECT_EQ(searched(1920, 1080), cv::Size(640, 360));
  EXPECT_EQ(searched(640, 480), cv::Size(640, 480));
}

TEST_F(SearchScaleTest, IsDecidedWhereTracksRestart) {
  const CameraStates cameras = Cameras(5);  // within the third interval of 60 frames
  const SearchScale scale(
      {.models = models_, .cameras = cameras, .object_px = kObject_px, .restart_interval_frames = kInterval},
      Info(1920, 1080));
  const auto width = [&](std::int64_t frame) { return scale.SizesAt(frame, {1920, 1080}).searched.width; };
  EXPECT_LT(width(0), 1000);
  EXPECT_EQ(width(0), width(59));
  EXPECT_EQ(width(120), 1920);  // high above at its end
  EXPECT_EQ(width(179), 1920);
  const SearchScale without_restart(
      {.models = models_, .cameras = cameras, .object_px = kObject_px, .restart_interval_frames = kNoRestart},
      Info(1920, 1080));
  EXPECT_EQ(without_restart.SizesAt(0, {1920, 1080}).searched.width, 1920);
}

TEST_F(SearchScaleTest, UnknownSizesAreSearchedAsFilmed) {
  const CameraStates cameras = Cameras();
  const auto width = [&](const SearchScale::Input& input, const VideoInfo& info) {
    return SearchScale(input, info).SizesAt(0, {1920, 1080}).searched.width;
  };
  const SearchScale::Input known{
      .models = models_, .cameras = cameras, .object_px = kObject_px, .restart_interval_frames = kInterval};
  ASSERT_LT(width(known, Info(1920, 1080)), 1920);

  const std::vector<ObjectModel> with_photo = {Truck(), Photo()};
  EXPECT_EQ(
      width({.models = with_photo, .cameras = cameras, .object_px = kObject_px, .restart_interval_frames = kInterval},
            Info(1920, 1080)),
      1920);
  CameraStates without_ground = Cameras();
  without_ground.SetGroundHeight(std::nullopt);
  EXPECT_EQ(
      width(
          {.models = models_, .cameras = without_ground, .object_px = kObject_px, .restart_interval_frames = kInterval},
          Info(1920, 1080)),
      1920);
  VideoInfo live = Info(1920, 1080);
  live.live = true;
  EXPECT_EQ(width(known, live), 1920);
  VideoInfo images = Info(1920, 1080);
  images.of_images = true;
  EXPECT_EQ(width(known, images), 1920);
  SearchScale::Input off = known;
  off.object_px = 0;
  EXPECT_EQ(width(off, Info(1920, 1080)), 1920);
  // A frame of another size than the video's.
  EXPECT_EQ(SearchScale(known, Info(1920, 1080)).SizesAt(0, {1280, 720}).searched.width, 1280);
}

}  // namespace
}  // namespace victorious
