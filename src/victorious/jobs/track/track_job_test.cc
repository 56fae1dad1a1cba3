#include "victorious/jobs/track/track_job.h"

#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/drawn_flight.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;
using testing::ShortFlight;
using testing::WriteVideo;

class TrackJobTest : public ::testing::Test {
 protected:
  TrackJobTest() : flight_(ShortFlight(30)) {
    WriteVideo(flight_, folder_ / "flight.mkv");
    videos_ = {(folder_ / "flight.mkv").string()};
  }

  [[nodiscard]] UserBox UserBoxAt(int frame) const {
    const testing::TruthRow row = flight_.Truth(frame).front();
    return {row.box, frame / flight_.options().fps};
  }

  Expected<TrackedBoxes> Track(const std::vector<UserBox>& boxes, const TrackBoxesOptions& options = {}) {
    return TrackBoxes(videos_, boxes, telemetry_, options, cancel_,
                      [&](const std::string& line) { warnings_.push_back(line); });
  }

  Expected<std::vector<BoxSighting>> Run(const std::vector<UserBox>& boxes, const TrackBoxesOptions& options = {}) {
    Expected<TrackedBoxes> tracked = Track(boxes, options);
    if (!tracked) return std::unexpected(std::move(tracked).error());
    return std::move(tracked->sightings);
  }

  // A static camera, from one time to another.
  void WriteTelemetry(double from_s, double to_s) {
    telemetry_ = (folder_ / "telemetry.csv").string();
    std::ofstream rows(*telemetry_);
    rows << "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n";
    for (double time_s = from_s; time_s <= to_s; time_s += 0.5) rows << time_s << ",42,-71,100,0,-60,0,50\n";
  }

  testing::SyntheticFlight flight_;
  testing::ScratchFolder folder_;
  std::vector<std::string> videos_;
  std::optional<std::string> telemetry_;
  CancelToken cancel_;
  std::vector<std::string> warnings_;
};

TEST_F(TrackJobTest, BackwardTrackingDoesNotDependOnChunkLength) {
  const std::vector<UserBox> boxes = {UserBoxAt(25)};
  TrackBoxesOptions short_stretches;
  short_stretches.memory_mb = 1;  // a few frames
  const auto whole = Run(boxes).value();
  const auto in_stretches = Run(boxes, short_stretches).value();
  EXPECT_EQ(ToJsonLines(whole, videos_, boxes), ToJsonLines(in_stretches, videos_, boxes));
  EXPECT_LT(whole.front().frame, 25);
  EXPECT_GT(whole.back().frame, 25);
}

TEST_F(TrackJobTest, UniformBoxIsTrackedByAppearance) {
  cv::Mat plain(120, 160, CV_8UC3, cv::Scalar(90, 120, 90));
  auto writer = VideoWriter::Create(folder_ / "plain.mkv", {.width = 160, .height = 120, .fps = 10.0}).value();
  for (int i = 0; i < 5; ++i) {
    cv::Mat frame = plain.clone();
    cv::rectangle(frame, cv::Rect(30 + 3 * i, 40, 20, 14), cv::Scalar(30, 30, 200), cv::FILLED);
    ASSERT_TRUE(writer->Write(frame));
  }
  ASSERT_TRUE(writer->Finish());
  videos_ = {(folder_ / "plain.mkv").string()};
  const auto sightings = Run({{{30, 40, 20, 14}, 0.0}}).value();
  ASSERT_EQ(sightings.size(), 5U);
  EXPECT_NEAR(sightings.back().box.x, 42, 3);
  EXPECT_THAT(warnings_, ::testing::ElementsAre(HasSubstr("by its template only")));
}

TEST_F(TrackJobTest, ErrorsNameTheProblem) {
  EXPECT_THAT(Run({{{10, 10, 30, 30}, 99.0}}).error().message, HasSubstr("ends at"));
  EXPECT_THAT(Run({{{900, 10, 30, 30}, 0.0}}).error().message, HasSubstr("box-1"));
  EXPECT_EQ(Run({}).error().code, ErrorCode::kInvalidArgument);
  cancel_.Cancel();
  EXPECT_EQ(Run({UserBoxAt(0)}).error().code, ErrorCode::kCancelled);
  // Found out before the video is read.
  EXPECT_THAT(Run({{{10, 10, 30, 30}, 99.0}}).error().message, HasSubstr("ends at"));
  EXPECT_THAT(Run({{{900, 10, 30, 30}, 0.0}}).error().message, HasSubstr("outside the frame"));
}

TEST_F(TrackJobTest, ReportsWhyThereIsNoPlace) {
  const auto why = [&] { return Track({UserBoxAt(25)}).value().place_failures.at(0); };
  EXPECT_THAT(why(), HasSubstr("no telemetry with camera position"));
  WriteTelemetry(100, 101);
  EXPECT_THAT(why(), HasSubstr("telemetry has no state from"));
  WriteTelemetry(0, 10);
  EXPECT_THAT(why(), HasSubstr("do not determine its distance"));
}

TEST_F(TrackJobTest, LocatedBoxHasNoPlaceFailure) {
  WriteTelemetry(0, 10);
  TrackBoxesOptions options;
  options.ground.height_m = 20;
  const TrackedBoxes tracked = Track({UserBoxAt(25)}, options).value();
  EXPECT_THAT(tracked.place_failures.at(0), ::testing::IsEmpty());
  EXPECT_TRUE(tracked.sightings.back().place.has_value());
}

TEST_F(TrackJobTest, GroundAboveTheCameraIsReported) {
  WriteTelemetry(0, 10);
  TrackBoxesOptions options;
  options.ground.height_m = 200;
  const TrackedBoxes tracked = Track({UserBoxAt(25)}, options).value();
  EXPECT_THAT(tracked.place_failures.at(0), HasSubstr("do not meet the given ground"));
}

}  // namespace
}  // namespace victorious
