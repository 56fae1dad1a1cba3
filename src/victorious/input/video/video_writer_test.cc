#include "victorious/input/video/video_writer.h"

#include <csignal>
#include <limits>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <sys/resource.h>

#include "testing/data.h"
#include "testing/video_tools.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;
using testing::DecodeImageNumber;
using ::testing::HasSubstr;
using testing::NumberedImage;
using testing::ScratchFolder;

constexpr VideoWriterOptions kSmall = {.width = 96, .height = 64, .fps = 12.5};

void WriteNumbered(const fs::path& path, const VideoWriterOptions& options, int frames) {
  auto writer = VideoWriter::Create(path, options);
  ASSERT_TRUE(writer) << writer.error().message;
  for (int i = 0; i < frames; ++i) {
    ASSERT_TRUE((*writer)->Write(NumberedImage(i, {options.width, options.height})));
  }
  EXPECT_FALSE(fs::exists(path)) << "no file has the name before Finish()";
  const auto finished = (*writer)->Finish();
  ASSERT_TRUE(finished) << finished.error().message;
}

TEST(VideoWriter, CountTimesAndPixelsRoundTrip) {
  const ScratchFolder folder;
  for (const std::string name : {"video.mp4", "video.mkv", "VIDEO.MP4"}) {
    WriteNumbered(folder / name, kSmall, 30);
    const auto reader = VideoReader::Open((folder / name).string(), {.color = FrameColor::kBgr});
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ((*reader)->info().codec, "h264");
    EXPECT_NEAR((*reader)->info().duration_s.value(), 2.4, 0.01) << name;
    EXPECT_NEAR((*reader)->info().frame_rate, 12.5, 0.01);
    int count = 0;
    while (const auto frame = (*reader)->NextFrame().value()) {
      EXPECT_EQ(frame->index, count);
      EXPECT_NEAR(frame->time_s, count / 12.5, 0.0006) << name;  // MKV has a resolution of 1 ms
      EXPECT_EQ(DecodeImageNumber(frame->image), count);
      const cv::Mat sent = NumberedImage(count, {96, 64});
      EXPECT_LT(cv::norm(frame->image, sent, cv::NORM_L1) / static_cast<double>(sent.total() * 3), 4);
      ++count;
    }
    EXPECT_EQ(count, 30) << name;
    EXPECT_TRUE((*reader)->warnings().empty()) << (*reader)->warnings().front();
  }
}

TEST(VideoWriter, FramesKeepTheirOwnTimes) {
  const ScratchFolder folder;
  const std::vector<double> times_s = {0, 0.04, 0.1, 0.5, 0.533, 2.25};
  VideoWriterOptions options = kSmall;
  options.timed = true;
  for (const std::string name : {"video.mp4", "video.mkv"}) {
    auto writer = VideoWriter::Create(folder / name, options);
    ASSERT_TRUE(writer) << writer.error().message;
    for (std::size_t i = 0; i < times_s.size(); ++i) {
      ASSERT_TRUE((*writer)->WriteAt(NumberedImage(static_cast<int>(i), {96, 64}), times_s[i]));
    }
    EXPECT_THAT((*writer)->WriteAt(NumberedImage(9, {96, 64}), 2.25).error().message, HasSubstr("must be later"));
    EXPECT_THAT((*writer)->WriteAt(NumberedImage(9, {96, 64}), 30'000).error().message, HasSubstr("6.6 hours"));
    ASSERT_TRUE((*writer)->Finish());
    const auto reader = VideoReader::Open((folder / name).string(), {.color = FrameColor::kBgr});
    ASSERT_TRUE(reader) << reader.error().message;
    std::size_t count = 0;
    while (const auto frame = (*reader)->NextFrame().value()) {
      ASSERT_LT(count, times_s.size());
      EXPECT_NEAR(frame->time_s, times_s[count], 0.0006) << name;
      EXPECT_EQ(DecodeImageNumber(frame->image), static_cast<int>(count));
      ++count;
    }
    EXPECT_EQ(count, times_s.size()) << name;
  }
}

TEST(VideoWriter, GreyRoundTrips) {
  const ScratchFolder folder;
  VideoWriterOptions lossless = kSmall;
  lossless.crf = 0;
  const cv::Mat grey = GreyFromBgr(NumberedImage(0x5A, {96, 64}));
  auto writer = VideoWriter::Create(folder / "grey.mp4", lossless);
  ASSERT_TRUE(writer);
  ASSERT_TRUE((*writer)->Write(grey));
  ASSERT_TRUE((*writer)->Write(grey));
  ASSERT_TRUE((*writer)->Finish());
  const auto reader = VideoReader::Open((folder / "grey.mp4").string(), {});
  ASSERT_TRUE(reader);
  const auto frame = (*reader)->NextFrame().value();
  ASSERT_TRUE(frame);
  EXPECT_LE(cv::norm(frame->image, grey, cv::NORM_INF), 1);
}

TEST(VideoWriter, ReplacesAnExistingFileOnlyWhenFinished) {
  const ScratchFolder folder;
  testing::WriteBytes(folder / "video.mp4", "older");
  {
    auto writer = VideoWriter::Create(folder / "video.mp4", kSmall);
    ASSERT_TRUE(writer);
    ASSERT_TRUE((*writer)->Write(NumberedImage(1, {96, 64})));
  }
  EXPECT_EQ(testing::ReadBytes(folder / "video.mp4"), "older");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1) << "the unfinished file is removed";
  auto writer = VideoWriter::Create(folder / "video.mp4", kSmall);
  ASSERT_TRUE(writer);
  ASSERT_TRUE((*writer)->Write(NumberedImage(1, {96, 64})));
  ASSERT_TRUE((*writer)->Finish());
  EXPECT_GT(fs::file_size(folder / "video.mp4"), 100U);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
  EXPECT_FALSE((*writer)->Write(NumberedImage(2, {96, 64})));
  EXPECT_FALSE((*writer)->Finish());
}

TEST(VideoWriter, BadOptionsAreInvalidArguments) {
  const ScratchFolder folder;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const VideoWriterOptions bad[] = {{.width = 95}, {.height = 0}, {.width = 100'000},
                                    {.fps = 0},    {.fps = nan},  {.crf = 52}};
  for (const VideoWriterOptions& options : bad) {
    const auto writer = VideoWriter::Create(folder / "video.mp4", options);
    ASSERT_FALSE(writer);
    EXPECT_EQ(writer.error().code, ErrorCode::kInvalidArgument) << writer.error().message;
  }
  const auto name = VideoWriter::Create(folder / "video.avi", kSmall);
  ASSERT_FALSE(name);
  EXPECT_THAT(name.error().message, HasSubstr("must end in .mp4 or .mkv"));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(VideoWriter, BadFramesAreInvalidArguments) {
  const ScratchFolder folder;
  auto writer = VideoWriter::Create(folder / "video.mp4", kSmall);
  ASSERT_TRUE(writer);
  const auto wrong_size = (*writer)->Write(cv::Mat(64, 64, CV_8UC3));
  ASSERT_FALSE(wrong_size);
  EXPECT_EQ(wrong_size.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(wrong_size.error().message, HasSubstr("64 x 64 of type CV_8UC3; it must be 96 x 64"));
  EXPECT_FALSE((*writer)->Write(cv::Mat(64, 96, CV_16UC1)));
  const auto nothing = (*writer)->Finish();
  ASSERT_FALSE(nothing);
  EXPECT_THAT(nothing.error().message, HasSubstr("at least one frame"));
}

// A limit on the file size simulates a full disk.
TEST(VideoWriter, FullDiskLeavesNoFile) {
  const ScratchFolder folder;
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, SIG_IGN);
  std::optional<Error> error;
  {
    auto writer = VideoWriter::Create(folder / "video.mp4", kSmall);
    ASSERT_TRUE(writer);
    const rlimit small{2000, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    for (int i = 0; i < 100 && !error; ++i) {
      const auto status = (*writer)->Write(NumberedImage(i, {96, 64}));
      if (!status) error = status.error();
    }
    const auto finished = (*writer)->Finish();
    if (!error && !finished) error = finished.error();
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  }
  std::signal(SIGXFSZ, SIG_DFL);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::kNoSpace) << error->message;
  EXPECT_THAT(error->message, HasSubstr((folder / "video.mp4").string()));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(VideoWriter, SystemErrorsKeepTheirCodes) {
  const ScratchFolder folder;
  const auto missing = VideoWriter::Create(folder / "nowhere/video.mp4", kSmall);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound) << missing.error().message;
}

}  // namespace
}  // namespace victorious
