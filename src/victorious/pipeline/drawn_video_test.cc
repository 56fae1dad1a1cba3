#include "victorious/pipeline/drawn_video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/drawn_flight.h"
#include "victorious/image/image_file.h"
#include "victorious/video/video_reader.h"
#include "victorious/video/video_writer.h"

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
  const std::vector<DrawnSighting> sightings = {
      {.frame = 2, .outline = BoxCorners({40, 50, 60, 40}), .lines = {"jeep", "42.1, 7.2"}, .identity = 0}};
  ASSERT_TRUE(DrawVideo(video.string(), sightings, 10, folder / "drawn.mp4", CancelToken()));
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

TEST(DrawnVideo, OddSizesAreAccepted) {
  const testing::ScratchFolder folder;
  std::filesystem::create_directory(folder / "frames");
  const cv::Mat image(kSize, CV_8UC3, cv::Scalar::all(80));
  ASSERT_TRUE(WriteImage(folder / "frames" / "0.png", image));
  ASSERT_TRUE(WriteImage(folder / "frames" / "1.png", image));
  ASSERT_TRUE(DrawVideo((folder / "frames").string(), {}, 4, folder / "drawn.mp4", CancelToken()));
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
  EXPECT_EQ(DrawVideo(video.string(), {}, 10, folder / "drawn.mp4", cancel).error().code, ErrorCode::kCancelled);
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
