#include "victorious/show/drawn_video.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/drawn_flight.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/telemetry/camera_track.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/input/video/video_writer.h"
#include "victorious/place/cameras/video_telemetry.h"

namespace victorious {
namespace {

using testing::DrawnFlight;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ShortFlight;
using testing::SightingsOf;

const cv::Size kSize(162, 121);  // odd height: the drawn video has a row more
const std::vector<double> kTimes_s = {0, 0.1, 0.35, 0.4};

// A grey video with frames at kTimes_s; the encoder pads it to an even height.
std::filesystem::path GreyVideo(const testing::ScratchFolder& folder) {
  const std::filesystem::path path = folder / "grey.mkv";
  auto writer = VideoWriter::Create(path, {.width = kSize.width, .height = 120, .fps = 10, .timed = true}).value();
  for (const double time_s : kTimes_s) {
    EXPECT_TRUE(writer->WriteAt(cv::Mat(120, kSize.width, CV_8UC3, cv::Scalar::all(100)), time_s));
  }
  EXPECT_TRUE(writer->Finish());
  return path;
}

std::vector<Frame> ReadAll(const std::filesystem::path& path) {
  const auto reader = VideoReader::Open(path.string(), {.color = FrameColor::kBgr}).value();
  std::vector<Frame> frames;
  while (auto frame = reader->NextFrame().value()) frames.push_back(*std::move(frame));
  return frames;
}

// Pixels that are not grey, in a part of the image.
int Coloured(const cv::Mat& image, const cv::Rect& part) {
  int coloured = 0;
  for (const cv::Vec3b& pixel : cv::Mat_<cv::Vec3b>(image(part))) coloured += pixel[2] - pixel[0] > 60 ? 1 : 0;
  return coloured;
}

TEST(DrawnVideo, DrawsEachSightingInItsFrameAndKeepsTheTimes) {
  const testing::ScratchFolder folder;
  const std::filesystem::path video = GreyVideo(folder);
  const std::vector<DrawnSighting> sightings = {{.frame = 2,
                                                 .time_s = 0.35,
                                                 .outline = BoxCorners({40, 50, 60, 40}),
                                                 .lines = {"jeep", "42.1, 7.2"},
                                                 .identity = 0}};
  ASSERT_TRUE(DrawVideo(video.string(), sightings, {}, folder / "drawn.mp4", CancelToken()));
  const std::vector<Frame> frames = ReadAll(folder / "drawn.mp4");
  ASSERT_EQ(frames.size(), kTimes_s.size());
  const cv::Rect around(30, 15, 90, 80);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_NEAR(frames[i].time_s, kTimes_s[i], 0.001) << i;
    if (i == 2) {
      EXPECT_GT(Coloured(frames[i].image, around), 150) << i;
    } else {
      EXPECT_EQ(Coloured(frames[i].image, around), 0) << i;
    }
  }
}

TEST(DrawnVideo, AClipHasItsFramesTheirTracksAndTelemetry) {
  const testing::ScratchFolder folder;
  const std::filesystem::path video = GreyVideo(folder);
  std::vector<DrawnSighting> sightings;
  for (int i = 0; i < 4; ++i) {
    sightings.push_back({.frame = i,
                         .time_s = kTimes_s[static_cast<std::size_t>(i)],
                         .outline = BoxCorners({20.0 + 25 * i, 60, 10, 10}),
                         .identity = 0});
  }
  const VideoSpan wanted{.from_s = 0.05, .to_s = 0.35};
  const auto span =
      DrawVideo(video.string(), sightings, {.clip = wanted, .track_frames = 60}, folder / "clip.mp4", CancelToken());
  ASSERT_TRUE(span) << span.error().message;
  EXPECT_NEAR(span->from_s, 0.1, 1e-6);
  EXPECT_NEAR(span->to_s, 0.35, 1e-6);
  const std::vector<Frame> frames = ReadAll(folder / "clip.mp4");
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_NEAR(frames[0].time_s, 0, 1e-3);
  EXPECT_NEAR(frames[1].time_s, 0.25, 1e-3);
  const cv::Rect way(58, 58, 10, 14);  // between the boxes of the second and the third frame
  EXPECT_EQ(Coloured(frames[0].image, way), 0);
  EXPECT_GT(Coloured(frames[1].image, way), 5);
  EXPECT_EQ(Coloured(frames[0].image, {0, 40, 40, 40}), 0) << "the frame before the clip is no part of the track";

  std::ofstream(folder / "grey.telemetry.csv")
      << "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n"
         "0,52,13,100,0,-90,0,60\n0.1,52.1,13,100,0,-90,0,60\n0.2,52.2,13,100,0,-90,0,60\n"
         "0.3,52.3,13,100,0,-90,0,60\n0.4,52.4,13,100,0,-90,0,60\n0.5,52.5,13,100,0,-90,0,60\n";
  const auto warn = [](const std::string& line) { FAIL() << line; };
  const auto kept = WriteClipTelemetry(video.string(), std::nullopt, *span, folder / "clip.mp4", warn);
  ASSERT_TRUE(kept) << kept.error().message;
  const auto telemetry = FindTelemetry((folder / "clip.mp4").string(), {}, warn);
  ASSERT_TRUE(telemetry && *telemetry) << "it is found beside the clip";
  ASSERT_EQ((*telemetry)->states.size(), *kept);
  const CameraTrajectory in_clip((*telemetry)->states, 1);
  for (const double time_s : {0.0, 0.25}) {
    const auto state = in_clip.At(time_s);
    ASSERT_TRUE(state) << time_s;
    EXPECT_NEAR(DegreesFromRadians(state->place.latitude_rad), 52 + span->from_s + time_s, 1e-4) << time_s;
  }
  EXPECT_EQ(*WriteClipTelemetry(video.string(), std::nullopt, {.from_s = 7, .to_s = 8}, folder / "late.mp4", warn), 0U);
  EXPECT_FALSE(std::filesystem::exists(folder / "late.telemetry.csv"));
  const auto nothing =
      DrawVideo(video.string(), {}, {.clip = VideoSpan{.from_s = 7, .to_s = 8}}, folder / "late.mp4", CancelToken());
  EXPECT_EQ(nothing.error().code, ErrorCode::kInvalidArgument);
  EXPECT_FALSE(std::filesystem::exists(folder / "late.mp4"));
}

TEST(DrawnVideo, OddSizesAreAccepted) {
  const testing::ScratchFolder folder;
  std::filesystem::create_directory(folder / "frames");
  const cv::Mat image(kSize, CV_8UC3, cv::Scalar::all(80));
  ASSERT_TRUE(WriteImage(folder / "frames" / "0.png", image));
  ASSERT_TRUE(WriteImage(folder / "frames" / "1.png", image));
  ASSERT_TRUE(
      DrawVideo((folder / "frames").string(), {}, {.folder_frame_rate = 4}, folder / "drawn.mp4", CancelToken()));
  const std::vector<Frame> frames = ReadAll(folder / "drawn.mp4");
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[1].image.size(), cv::Size(kSize.width, kSize.height + 1));
  EXPECT_NEAR(frames[1].time_s, 0.25, 0.001);
}

TEST(DrawnVideo, NothingIsWrittenIfCancelled) {
  const testing::ScratchFolder folder;
  const std::filesystem::path video = GreyVideo(folder);
  CancelToken cancel;
  cancel.Cancel();
  EXPECT_EQ(DrawVideo(video.string(), {}, {}, folder / "drawn.mp4", cancel).error().code, ErrorCode::kCancelled);
  EXPECT_FALSE(std::filesystem::exists(folder / "drawn.mp4"));
}

TEST(DrawnVideo, ListsTheSightingsOfOneIndexedVideo) {
  DrawnFlight flight{ShortFlight(8)};
  const std::unique_ptr<IndexStore> store = flight.Store("index.db");
  EXPECT_THAT(ListIndexedDrawing({}, *store).error().message, HasSubstr("index one first"));
  ASSERT_TRUE(Indexer::Create(flight.Models(), {}).value().Index({.video = flight.video()}, CancelToken(), *store));
  const IndexedDrawing drawing = ListIndexedDrawing({}, *store).value();
  const std::vector<SightingRecord> sightings = SightingsOf(*store);
  EXPECT_EQ(drawing.video, flight.video());
  ASSERT_EQ(drawing.sightings.size(), sightings.size());
  ASSERT_FALSE(sightings.empty());
  EXPECT_EQ(drawing.sightings.front().frame, sightings.front().frame);
  EXPECT_THAT(drawing.sightings.front().lines.front(), HasSubstr("score"));
  EXPECT_FALSE(drawing.sightings.front().outline.empty());
}

TEST(DrawnVideo, UserBoxesAreNamedAndPlaced) {
  BoxSighting seen{.box_index = 1, .video = 0, .frame = 3, .time_s = 0.3, .box = {1, 2, 30, 40}, .score = 0.5};
  seen.place = Geolocation{.point = {0.5, 0.25, 10}, .covariance_enu_m2 = Eigen::Matrix3d::Identity(), .ce90_m = 2.1};
  BoxSighting elsewhere = seen;
  elsewhere.video = 1;
  const std::vector<UserBox> boxes = {{.box = {0, 0, 9, 9}}, {.box = {0, 0, 9, 9}, .type = "tank"}};
  const std::vector<BoxSighting> sightings = {seen, elsewhere};
  const std::vector<DrawnSighting> drawn = ListBoxDrawing(sightings, boxes);
  ASSERT_EQ(drawn.size(), 1U) << "only the first video is drawn";
  EXPECT_EQ(drawn.front().frame, 3);
  EXPECT_EQ(drawn.front().lines,
            (std::vector<std::string>{"box-2 tank  score 0.50", "28.647890, 14.323945  CE90 2.1 m"}));
  EXPECT_THAT(ListBoxDrawing({}, boxes), IsEmpty());
}

}  // namespace
}  // namespace victorious
