#include "victorious/input/video/video_reader.h"

#include <limits>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "testing/data.h"
#include "testing/video_tools.h"
#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;
using testing::DecodeImageNumber;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::NumberedImage;
using testing::ScratchFolder;
using testing::SteadyTimes;
using testing::TestVideo;
using testing::WriteTestVideo;

std::unique_ptr<VideoReader> MustOpen(const fs::path& path, const VideoReaderOptions& options = {}) {
  auto reader = VideoReader::Open(path.string(), options);
  EXPECT_TRUE(reader) << reader.error().message;
  return reader ? *std::move(reader) : nullptr;
}

std::vector<Frame> ReadAll(VideoReader& reader) {
  std::vector<Frame> frames;
  while (true) {
    auto frame = reader.NextFrame();
    EXPECT_TRUE(frame) << frame.error().message;
    if (!frame || !*frame) return frames;
    frames.push_back(**std::move(frame));
  }
}

std::vector<Frame> ReadAll(const fs::path& path, const VideoReaderOptions& options = {}) {
  const auto reader = MustOpen(path, options);
  return reader ? ReadAll(*reader) : std::vector<Frame>{};
}

TEST(VideoReader, ContainersAndCodecs) {
  const struct {
    std::string name, muxer, encoder, pixel_format;
    int b_frames;
  } kinds[] = {{"a.mp4", "mp4", "libx264", "yuv420p", 3},
               {"b.mkv", "matroska", "libx264", "yuv420p", 3},
               {"c.ts", "mpegts", "libx264", "yuv420p", 3},
               {"d.avi", "avi", "mpeg4", "yuv420p", 0},
               {"e.mpg", "mpeg", "mpeg1video", "yuv420p", 2},
               {"f.m1v", "mpeg1video", "mpeg1video", "yuv420p", 2},
               {"g.h264", "h264", "libx264", "yuv420p", 0},
               {"h.mkv", "matroska", "ffv1", "bgr0", 0},
               {"i.avi", "avi", "rawvideo", "bgr24", 0},
               {"j.mjpg", "mjpeg", "mjpeg", "yuvj420p", 0},
               {"k.gif", "gif", "gif", "rgb8", 0},
               {"l.mkv", "matroska", "png", "rgb24", 0}};
  const ScratchFolder folder;
  for (const auto& kind : kinds) {
    WriteTestVideo(folder / kind.name, {.muxer = kind.muxer,
                                        .encoder = kind.encoder,
                                        .pixel_format = kind.pixel_format,
                                        .time_base_hz = 25,
                                        .pts = SteadyTimes(40, 1),
                                        .full_range = kind.encoder == "mjpeg",
                                        .max_b_frames = kind.b_frames});
    for (const FrameColor color : {FrameColor::kGrey, FrameColor::kBgr}) {
      const auto reader = MustOpen(folder / kind.name, {.color = color});
      ASSERT_TRUE(reader) << kind.name;
      const auto frames = ReadAll(*reader);
      ASSERT_EQ(frames.size(), 40U) << kind.name;
      for (std::size_t i = 0; i < frames.size(); ++i) {
        EXPECT_EQ(frames[i].index, static_cast<std::int64_t>(i)) << kind.name;
        EXPECT_EQ(DecodeImageNumber(frames[i].image), static_cast<int>(i)) << kind.name;
        EXPECT_NEAR(frames[i].time_s, static_cast<double>(i) / 25, 0.0015) << kind.name;
        EXPECT_EQ(frames[i].image.type(), color == FrameColor::kGrey ? CV_8UC1 : CV_8UC3);
      }
      EXPECT_TRUE(reader->warnings().empty()) << kind.name << ": " << reader->warnings().front();
      EXPECT_EQ(reader->info().width, 96) << kind.name;
      EXPECT_EQ(reader->info().height, 64) << kind.name;
    }
  }
}

TEST(VideoReader, TimesOfAVariableFrameRate) {
  const ScratchFolder folder;
  const std::vector<std::int64_t> pts_ms = {500, 540, 541, 700, 1700, 1733, 4000, 4001, 4040, 9000};
  for (const std::string muxer : {"mp4", "matroska"}) {
    WriteTestVideo(folder / "vfr", {.muxer = muxer, .pts = pts_ms, .max_b_frames = 2});
    const auto frames = ReadAll(folder / "vfr");
    ASSERT_EQ(frames.size(), pts_ms.size()) << muxer;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_NEAR(frames[i].time_s, static_cast<double>(pts_ms[i] - pts_ms[0]) / 1000, 1e-6) << muxer;
      EXPECT_EQ(DecodeImageNumber(frames[i].image), static_cast<int>(i));
    }
  }
}

TEST(VideoReader, OddSizes) {
  const ScratchFolder folder;
  for (const cv::Size size : {cv::Size(333, 251), cv::Size(161, 97), cv::Size(40, 33)}) {
    for (const std::string format : {"bgr0", "yuv420p", "yuv444p"}) {
      const cv::Mat image = NumberedImage(0xA5, size);
      WriteTestVideo(folder / "odd.mkv", {.muxer = "matroska",
                                          .encoder = "ffv1",
                                          .pixel_format = format,
                                          .size = size,
                                          .pts = SteadyTimes(2, 40),
                                          .images = {image, image}});
      const auto bgr = ReadAll(folder / "odd.mkv", {.color = FrameColor::kBgr});
      const auto grey = ReadAll(folder / "odd.mkv");
      ASSERT_EQ(bgr.size(), 2U);
      ASSERT_EQ(grey.size(), 2U);
      ASSERT_EQ(bgr[0].image.size(), size) << format;
      ASSERT_EQ(grey[0].image.size(), size) << format;
      // Including the last column and row.
      const cv::Rect corner(size.width - 9, size.height - 9, 9, 9);
      if (format != "yuv420p") {  // no chroma subsampling in the file
        EXPECT_LE(cv::norm(bgr[0].image(corner), image(corner), cv::NORM_INF), 6) << format << size;
      }
      EXPECT_LE(cv::norm(grey[0].image(corner), GreyFromBgr(image)(corner), cv::NORM_INF), 3) << format << size;
    }
  }
}

TEST(VideoReader, GivesGreyAndColourTogether) {
  const ScratchFolder folder;
  const cv::Mat image = NumberedImage(0x35, {192, 128});
  WriteTestVideo(folder / "video.mkv", {.muxer = "matroska",
                                        .encoder = "ffv1",
                                        .pixel_format = "yuv420p",
                                        .size = image.size(),
                                        .pts = SteadyTimes(2, 40),
                                        .images = {image, image}});
  const auto both = ReadAll(folder / "video.mkv", {.color = FrameColor::kGreyAndBgr});
  const auto grey = ReadAll(folder / "video.mkv");
  const auto bgr = ReadAll(folder / "video.mkv", {.color = FrameColor::kBgr});
  ASSERT_EQ(both.size(), 2U);
  for (std::size_t i = 0; i < both.size(); ++i) {
    EXPECT_EQ(cv::norm(both[i].image, grey[i].image, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(both[i].bgr, bgr[i].image, cv::NORM_INF), 0);
    EXPECT_TRUE(grey[i].bgr.empty());
  }
}

TEST(VideoReader, GreyAgreesWithColourInEveryFormat) {
  const ScratchFolder folder;
  const struct {
    std::string encoder, format;
    bool full_range;
    int color_space;
  } kinds[] = {{"ffv1", "yuv420p", false, 2},     {"ffv1", "yuv420p", true, 2},   {"ffv1", "yuv422p", false, 6},
               {"ffv1", "yuv444p", false, 1},     {"ffv1", "yuv420p", false, 1},  {"ffv1", "yuv420p10le", false, 2},
               {"ffv1", "yuv422p10le", true, 2},  {"ffv1", "gray", false, 2},     {"ffv1", "gray10le", false, 2},
               {"ffv1", "gray", true, 2},         {"ffv1", "bgr0", true, 0},      {"rawvideo", "nv12", false, 2},
               {"rawvideo", "yuyv422", false, 2}, {"libx264", "gray", false, 2},  {"libx264", "yuv420p10le", false, 2},
               {"libx264", "nv12", true, 2},      {"ffv1", "gray12le", false, 2}, {"ffv1", "yuv420p12le", false, 1}};
  for (const auto& kind : kinds) {
    const std::string name = kind.encoder + " " + kind.format + (kind.full_range ? " full" : " limited");
    const cv::Mat image = NumberedImage(0x35, {192, 128});
    WriteTestVideo(folder / "video", {.muxer = kind.encoder == "rawvideo" ? "nut" : "matroska",
                                      .encoder = kind.encoder,
                                      .pixel_format = kind.format,
                                      .size = image.size(),
                                      .pts = SteadyTimes(2, 40),
                                      .images = {image, image},
                                      .full_range = kind.full_range,
                                      .color_space = kind.color_space});
    const auto grey = ReadAll(folder / "video");
    const auto bgr = ReadAll(folder / "video", {.color = FrameColor::kBgr});
    ASSERT_EQ(grey.size(), 2U) << name;
    ASSERT_EQ(bgr.size(), 2U) << name;
    EXPECT_LE(cv::norm(grey[0].image, GreyFromBgr(bgr[0].image), cv::NORM_INF), 3) << name;
    EXPECT_LE(cv::norm(grey[0].image, GreyFromBgr(bgr[0].image), cv::NORM_L1) / static_cast<double>(image.total()), 1.2)
        << name;
    // Also compared with the input: black is 25 and white is 230, in either range.
    EXPECT_LE(cv::norm(grey[0].image, GreyFromBgr(image), cv::NORM_L1) / static_cast<double>(image.total()), 2) << name;
  }
}

TEST(VideoReader, FramesAreDeliveredUpright) {
  const ScratchFolder folder;
  for (const int rotation_deg : {90, 180, 270}) {
    const cv::Mat upright = NumberedImage(0x1D, rotation_deg == 180 ? cv::Size(96, 64) : cv::Size(64, 96));
    cv::Mat stored;  // rotated counter-clockwise by the clockwise rotation of the display matrix
    cv::rotate(upright, stored,
               rotation_deg == 90    ? cv::ROTATE_90_COUNTERCLOCKWISE
               : rotation_deg == 180 ? cv::ROTATE_180
                                     : cv::ROTATE_90_CLOCKWISE);
    WriteTestVideo(folder / "turned.mp4",
                   {.pts = SteadyTimes(3, 40), .images = {stored, stored, stored}, .rotation_deg = rotation_deg});
    const auto reader = MustOpen(folder / "turned.mp4", {.color = FrameColor::kBgr});
    ASSERT_TRUE(reader);
    EXPECT_EQ(reader->info().rotation_deg, rotation_deg);
    EXPECT_EQ(reader->info().width, upright.cols);
    EXPECT_EQ(reader->info().height, upright.rows);
    const auto frames = ReadAll(*reader);
    ASSERT_EQ(frames.size(), 3U);
    ASSERT_EQ(frames[0].image.size(), upright.size());
    EXPECT_EQ(DecodeImageNumber(frames[0].image), 0x1D) << rotation_deg;
  }
}

TEST(VideoReader, NonSquarePixelsAreResampled) {
  const ScratchFolder folder;
  const struct {
    std::string muxer, encoder;
    cv::Size pixel_aspect, expected;
    int rotation_deg;
  } kinds[] = {{"mp4", "libx264", {4, 3}, {128, 64}, 0},   {"matroska", "libx264", {16, 11}, {140, 64}, 0},
               {"mpegts", "libx264", {2, 3}, {64, 64}, 0}, {"avi", "mpeg4", {3, 2}, {144, 64}, 0},
               {"mp4", "libx264", {4, 3}, {64, 128}, 90},  {"mp4", "libx264", {1, 1}, {96, 64}, 0}};
  for (const auto& kind : kinds) {
    const std::string name = kind.muxer + " " + std::to_string(kind.expected.width);
    cv::Mat upright = NumberedImage(0x1D, kind.expected);
    cv::Mat stored = upright;
    if (kind.rotation_deg == 90) cv::rotate(upright, stored, cv::ROTATE_90_COUNTERCLOCKWISE);
    cv::resize(stored, stored, {96, 64});
    WriteTestVideo(folder / "video", {.muxer = kind.muxer,
                                      .encoder = kind.encoder,
                                      .time_base_hz = 25,
                                      .pts = SteadyTimes(3, 1),
                                      .images = {stored, stored, stored},
                                      .rotation_deg = kind.rotation_deg,
                                      .pixel_aspect = kind.pixel_aspect});
    for (const FrameColor color : {FrameColor::kGrey, FrameColor::kBgr}) {
      const auto reader = MustOpen(folder / "video", {.color = color});
      ASSERT_TRUE(reader) << name;
      EXPECT_EQ(cv::Size(reader->info().width, reader->info().height), kind.expected) << name;
      EXPECT_DOUBLE_EQ(reader->info().pixel_aspect,
                       static_cast<double>(kind.pixel_aspect.width) / kind.pixel_aspect.height);
      const auto frames = ReadAll(*reader);
      ASSERT_EQ(frames.size(), 3U) << name;
      for (const Frame& frame : frames) {
        ASSERT_EQ(frame.image.size(), kind.expected) << name;
        EXPECT_EQ(DecodeImageNumber(frame.image), 0x1D) << name;
        if (color == FrameColor::kBgr) continue;
        EXPECT_LE(cv::norm(frame.image, GreyFromBgr(upright), cv::NORM_L1) / static_cast<double>(upright.total()), 4);
      }
      EXPECT_TRUE(reader->warnings().empty()) << name << ": " << reader->warnings().front();
    }
  }
}

TEST(VideoReader, ImplausibleOrNearlySquarePixelsAreKept) {
  const ScratchFolder folder;
  for (const cv::Size aspect : {cv::Size(20, 1), cv::Size(1, 20), cv::Size(301, 300)}) {
    WriteTestVideo(folder / "video.mp4", {.pts = SteadyTimes(2, 40), .pixel_aspect = aspect});
    const auto reader = MustOpen(folder / "video.mp4");
    ASSERT_TRUE(reader);
    EXPECT_EQ(reader->info().pixel_aspect, 1);
    EXPECT_EQ(reader->info().width, 96);
    const auto frames = ReadAll(*reader);
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_EQ(frames[0].image.size(), cv::Size(96, 64)) << aspect;
    const bool is_warned = aspect != cv::Size(301, 300);
    EXPECT_EQ(!reader->warnings().empty() && reader->warnings()[0].starts_with("pixels of "), is_warned) << aspect;
  }
}

TEST(VideoReader, FramesOwnTheirPixels) {
  const ScratchFolder folder;
  WriteTestVideo(folder / "a.mp4", {.pts = SteadyTimes(20, 40)});
  auto frames = ReadAll(folder / "a.mp4");
  for (std::size_t i = 0; i < frames.size(); ++i) EXPECT_EQ(DecodeImageNumber(frames[i].image), static_cast<int>(i));
}

TEST(VideoReader, ResultDoesNotDependOnThreads) {
  const ScratchFolder folder;
  WriteTestVideo(folder / "a.mp4", {.size = {320, 240}, .pts = SteadyTimes(30, 40), .max_b_frames = 2});
  const auto one = ReadAll(folder / "a.mp4", {.threads = 1});
  const auto four = ReadAll(folder / "a.mp4", {.threads = 4});
  ASSERT_EQ(one.size(), 30U);
  ASSERT_EQ(four.size(), 30U);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].time_s, four[i].time_s);
    EXPECT_EQ(cv::norm(one[i].image, four[i].image, cv::NORM_INF), 0);
  }
}

// Each seekable container, with B-frames: decoding order differs from presentation order.
TEST(VideoReader, FramesAfterASkipMatchTheWholeVideo) {
  const testing::ScratchFolder folder;
  for (const std::string muxer : {"mp4", "matroska", "mpegts", "avi"}) {
    const std::string path = folder / ("video." + muxer);
    const int time_base_hz = muxer == "avi" ? 25 : 1000;
    WriteTestVideo(path, {.muxer = muxer,
                          .time_base_hz = time_base_hz,
                          .pts = SteadyTimes(100, time_base_hz / 25),
                          .max_b_frames = muxer == "avi" ? 0 : 2});
    std::map<double, int> numbers;
    const auto whole = MustOpen(path);
    while (const auto frame = *whole->NextFrame()) numbers[frame->time_s] = DecodeImageNumber(frame->image);
    EXPECT_FALSE(MustOpen(path)->SeekTo(0)) << muxer << ": nothing to skip";
    for (const double time_s : {2.5, 3.9, 1.21}) {
      const auto reader = MustOpen(path);
      ASSERT_TRUE(reader->SeekTo(time_s)) << muxer;
      auto frame = *reader->NextFrame();
      ASSERT_TRUE(frame) << muxer;
      EXPECT_LE(frame->time_s, time_s + 1e-9) << muxer;
      EXPECT_TRUE(time_s < 2 || frame->time_s > 0) << muxer << ": from the beginning";
      int read = 0;
      for (; frame; frame = *reader->NextFrame()) {
        if (frame->time_s < time_s - 1e-9) continue;
        ASSERT_TRUE(numbers.contains(frame->time_s)) << muxer << " " << frame->time_s;
        EXPECT_EQ(DecodeImageNumber(frame->image), numbers[frame->time_s]);
        ++read;
      }
      EXPECT_EQ(read, std::ranges::count_if(numbers, [&](const auto& one) { return one.first >= time_s - 1e-9; }))
          << muxer << " " << time_s;
    }
  }
}

TEST(VideoReader, FramesOfAnotherSizeAreRescaled) {
  const ScratchFolder folder;
  TestVideo part{.muxer = "mpegts", .encoder = "mpeg1video", .time_base_hz = 25, .pts = SteadyTimes(20, 1)};
  WriteTestVideo(folder / "small.ts", part);
  part.size = {192, 128};
  WriteTestVideo(folder / "large.ts", part);
  testing::WriteBytes(folder / "both.ts",
                      testing::ReadBytes(folder / "small.ts") + testing::ReadBytes(folder / "large.ts"));
  for (const FrameColor color : {FrameColor::kGrey, FrameColor::kBgr}) {
    const auto reader = MustOpen(folder / "both.ts", {.color = color});
    ASSERT_TRUE(reader);
    const auto frames = ReadAll(*reader);
    ASSERT_GE(frames.size(), 38U);
    for (const Frame& frame : frames) EXPECT_EQ(frame.image.size(), cv::Size(96, 64));
    for (std::size_t i = 1; i < frames.size(); ++i) EXPECT_GT(frames[i].time_s, frames[i - 1].time_s);
    EXPECT_EQ(DecodeImageNumber(frames.back().image), 19);
    EXPECT_THAT(reader->warnings(), ::testing::Contains(HasSubstr("it is scaled to 96 x 64")));
  }
}

TEST(VideoReader, AudioAndCoverStreamsAreIgnored) {
  const ScratchFolder folder;
  WriteTestVideo(folder / "a.mp4", {.pts = SteadyTimes(10, 40), .audio = true, .cover = true});
  const auto reader = MustOpen(folder / "a.mp4");
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().width, 96);
  EXPECT_EQ(reader->info().streams.size(), 3U);
  EXPECT_EQ(ReadAll(*reader).size(), 10U);
  EXPECT_TRUE(reader->warnings().empty());
  for (const bool cover : {false, true}) {
    WriteTestVideo(folder / "sound.mp4", {.audio = true, .video = false, .cover = cover});
    const auto sound = VideoReader::Open((folder / "sound.mp4").string(), {});
    ASSERT_FALSE(sound);
    EXPECT_EQ(sound.error().code, ErrorCode::kDataLoss);
    EXPECT_THAT(sound.error().message, HasSubstr("no video stream"));
  }
}

TEST(VideoReader, ContentIdIgnoresTheName) {
  const ScratchFolder folder;
  WriteTestVideo(folder / "a.mp4", {.pts = SteadyTimes(10, 40)});
  fs::copy_file(folder / "a.mp4", folder / "b.mp4");
  const std::string id = ContentId(folder / "a.mp4").value();
  for (const std::string& source :
       {(folder / "a.mp4").string(), (folder / "b.mp4").string(), "file://" + (folder / "a.mp4").string()}) {
    EXPECT_EQ(MustOpen(source)->ContentId(CancelToken(), {}), id) << source;
  }
  CancelToken cancel;
  cancel.Cancel();
  EXPECT_EQ(MustOpen(folder / "a.mp4")->ContentId(cancel, {}).error().code, ErrorCode::kCancelled);
}

TEST(VideoReader, DataPacketsWithoutDecodingTheFrames) {
  const ScratchFolder folder;
  WriteTestVideo(folder / "klv.ts", {.muxer = "mpegts",
                                     .pts = {400, 440, 480, 520, 560, 600},
                                     .klv = {{400, "\x06\x0E\x2B\x34-first"}, {600, "\x06\x0E\x2B\x34-last"}}});
  const auto reader = MustOpen(folder / "klv.ts", {.data_packets = true});
  ASSERT_TRUE(reader);
  reader->SkipToEnd();
  const std::vector<DataPacket> packets = reader->TakeDataPackets();
  ASSERT_EQ(packets.size(), 2U);
  EXPECT_NEAR(packets[1].time_s.value_or(-1), 0.2, 1e-4);
  EXPECT_FALSE(reader->NextFrame().value());
  EXPECT_TRUE(reader->warnings().empty());
}

// Muxers leave out the descriptor, and write the header of metadata cells (ISO/IEC 13818-1, 2.12.4) all the same.
TEST(VideoReader, KlvInAPrivateStreamIsRecognised) {
  const ScratchFolder folder;
  const std::string label = "\x06\x0E\x2B\x34";
  const std::string cell("\x00\x01\xDF\x00\x09", 5);
  WriteTestVideo(folder / "cells.ts", {.muxer = "mpegts",
                                       .pts = {400, 440, 480, 520},
                                       .klv = {{400, cell + label + "begin"}, {440, "rest of it"}, {480, "more"}},
                                       .names_klv = false});
  const auto reader = MustOpen(folder / "cells.ts", {.data_packets = true});
  ASSERT_TRUE(reader);
  reader->SkipToEnd();
  const std::vector<DataPacket> packets = reader->TakeDataPackets();
  ASSERT_EQ(packets.size(), 3U);
  for (const DataPacket& packet : packets) EXPECT_EQ(packet.kind, DataKind::kKlv);
}

TEST(VideoReader, UnknownDataTracksAreNamedByTheirLetters) {
  const ScratchFolder folder;
  WriteTestVideo(folder / "gopro.mp4",
                 {.pts = {0, 40, 80}, .klv = {{0, "DEVC....first"}, {40, "DEVC....second"}}, .names_klv = false});
  const auto reader = MustOpen(folder / "gopro.mp4");
  ASSERT_TRUE(reader);
  ASSERT_EQ(reader->info().streams.size(), 2U);
  EXPECT_EQ(reader->info().streams[1].type, StreamType::kData);
  EXPECT_EQ(reader->info().streams[1].codec, "gpmd");
}

TEST(VideoReader, DataPacketsOnTheFramesClock) {
  const ScratchFolder folder;
  const std::string label = "\x06\x0E\x2B\x34";
  WriteTestVideo(folder / "klv.ts",
                 {.muxer = "mpegts",
                  .pts = {400, 440, 480, 520, 560, 600},
                  .klv = {{300, label + "before"}, {400, label + "first"}, {520, label + "fourth"}}});
  const auto reader = MustOpen(folder / "klv.ts", {.data_packets = true});
  ASSERT_TRUE(reader);
  // Packets read before the first frame already have times before the first NextFrame.
  std::vector<DataPacket> packets = reader->TakeDataPackets();
  EXPECT_FALSE(packets.empty());
  while (reader->NextFrame().value()) {
    for (auto& packet : reader->TakeDataPackets()) packets.push_back(std::move(packet));
  }
  for (auto& packet : reader->TakeDataPackets()) packets.push_back(std::move(packet));
  ASSERT_EQ(packets.size(), 3U);
  const double expected_s[] = {-0.1, 0, 0.12};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(packets[i].kind, DataKind::kKlv);
    ASSERT_TRUE(packets[i].time_s);
    EXPECT_NEAR(*packets[i].time_s, expected_s[i], 1e-4);
  }
  EXPECT_EQ(packets[2].bytes.size(), label.size() + 6);
  EXPECT_EQ(packets[2].bytes[4], std::byte{'f'});
  const auto without = MustOpen(folder / "klv.ts");
  ReadAll(*without);
  EXPECT_TRUE(without->TakeDataPackets().empty());
}

TEST(VideoReader, SubtitlesAreDataPackets) {
  const ScratchFolder folder;
  WriteTestVideo(folder / "srt.mkv", {.muxer = "matroska",
                                      .pts = SteadyTimes(10, 40),
                                      .subtitles = {{0, "[latitude: 50.8]"}, {200, "[latitude: 50.9]"}}});
  const auto reader = MustOpen(folder / "srt.mkv", {.data_packets = true});
  ASSERT_TRUE(reader);
  ReadAll(*reader);
  const auto packets = reader->TakeDataPackets();
  ASSERT_EQ(packets.size(), 2U);
  EXPECT_EQ(packets[1].kind, DataKind::kSubtitle);
  EXPECT_NEAR(packets[1].time_s.value(), 0.2, 1e-6);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(packets[1].bytes.data()), packets[1].bytes.size()),
            "[latitude: 50.9]");
}

TEST(VideoReader, ErrorsAreOneLineWithTheirCode) {
  const ScratchFolder folder;
  testing::WriteBytes(folder / "empty.mp4", "");
  testing::WriteBytes(folder / "text.txt", "Some words on a line.\nAnd on another.\n");
  testing::WriteBytes(folder / "text.mp4", "Some words on a line.\nAnd on another.\n");
  const struct {
    std::string source;
    ErrorCode code;
    std::string words;
  } cases[] = {{(folder / "missing.mp4").string(), ErrorCode::kNotFound, "no such file or folder"},
               {(folder / "empty.mp4").string(), ErrorCode::kInvalidArgument, "the file is empty"},
               {(folder / "text.txt").string(), ErrorCode::kDataLoss, "not a video that can be read"},
               {(folder / "text.mp4").string(), ErrorCode::kDataLoss, "not a video that can be read"},
               {"/dev/null", ErrorCode::kInvalidArgument, "neither a file nor a folder"},
               {"", ErrorCode::kInvalidArgument, "no video given"},
               {"gopher://127.0.0.1/video", ErrorCode::kInvalidArgument, "not a kind of address that can be read"},
               {"concat:" + (folder / "a.mp4").string(), ErrorCode::kNotFound, "no such file or folder"},
               {std::string(300, 'x'), ErrorCode::kInvalidArgument, "File name too long"}};
  for (const auto& [source, code, words] : cases) {
    const auto reader = VideoReader::Open(source, {});
    ASSERT_FALSE(reader) << source;
    EXPECT_EQ(reader.error().code, code) << reader.error().message;
    EXPECT_THAT(reader.error().message, HasSubstr(words));
    EXPECT_THAT(reader.error().message, Not(HasSubstr("\n")));
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const VideoReaderOptions& bad :
       {VideoReaderOptions{.threads = -1}, {.open_timeout_s = 0}, {.folder_frame_rate = nan}}) {
    const auto reader = VideoReader::Open("any.mp4", bad);
    ASSERT_FALSE(reader);
    EXPECT_EQ(reader.error().code, ErrorCode::kInvalidArgument);
  }
}

// FFmpeg would open the files and URLs that a playlist refers to.
TEST(VideoReader, PlaylistsAreRefused) {
  const ScratchFolder folder;
  WriteTestVideo(folder / "part.ts", {.muxer = "mpegts", .pts = SteadyTimes(10, 40)});
  const std::string part = (folder / "part.ts").string();
  const std::pair<std::string, std::string> playlists[] = {
      {"list.m3u8", "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:0.4,\n" + part + "\n#EXT-X-ENDLIST\n"},
      {"list.ffconcat", "ffconcat version 1.0\nfile " + part + "\n"},
      {"list.sdp", "v=0\no=- 0 0 IN IP4 127.0.0.1\ns=x\nc=IN IP4 127.0.0.1\nt=0 0\nm=video 5004 RTP/AVP 33\n"},
      {"list.mpd", "<?xml version=\"1.0\"?><MPD xmlns=\"urn:mpeg:dash:schema:mpd:2011\"></MPD>"}};
  for (const auto& [name, text] : playlists) {
    testing::WriteBytes(folder / name, text);
    const auto reader = VideoReader::Open((folder / name).string(), {});
    ASSERT_FALSE(reader) << name;
    EXPECT_EQ(reader.error().code, ErrorCode::kDataLoss);
    EXPECT_THAT(reader.error().message, HasSubstr("not a video that can be read"));
  }
}

TEST(VideoReader, ProtocolLikeNamesAreFiles) {
  const ScratchFolder folder;
  WriteTestVideo(folder / "http:video, 1%d.mp4", {.pts = SteadyTimes(5, 40)});
  EXPECT_EQ(ReadAll(folder / "http:video, 1%d.mp4").size(), 5U);
  EXPECT_EQ(ReadAll(fs::path("file://" + (folder / "http:video, 1%d.mp4").string())).size(), 5U);
}

TEST(VideoReaderRealData, FramesAndKlvPacketsAreCounted) {
  VICTORIOUS_DATA_OR_SKIP(folder, "real/fmv_klv");
  const struct {
    std::string file;
    std::size_t frames, packets;
    bool stamped;
  } clips[] = {{"osh_vrsg/sample-stream.ts", 277, 277, true},
               {"kwiver_aphill/aphill_short.ts", 48, 48, true},
               {"kwiver_synthetic/h264_klv.ts", 30, 30, false},  // asynchronous KLV: no time stamps
               {"kwiver_synthetic/h264_no_klv.ts", 30, 0, false}};
  for (const auto& clip : clips) {
    const auto reader = MustOpen(folder / clip.file, {.data_packets = true});
    ASSERT_TRUE(reader);
    const auto frames = ReadAll(*reader);
    const auto packets = reader->TakeDataPackets();
    EXPECT_EQ(frames.size(), clip.frames) << clip.file;
    ASSERT_EQ(packets.size(), clip.packets) << clip.file;
    EXPECT_TRUE(reader->warnings().empty()) << clip.file << ": " << reader->warnings().front();
    for (const DataPacket& packet : packets) {
      EXPECT_EQ(packet.kind, DataKind::kKlv);
      EXPECT_EQ(packet.bytes[0], std::byte{0x06});
      EXPECT_EQ(packet.time_s.has_value(), clip.stamped) << clip.file;
      if (packet.time_s) {
        EXPECT_GE(*packet.time_s, -1);
        EXPECT_LE(*packet.time_s, frames.back().time_s + 1);
      }
    }
  }
}

}  // namespace
}  // namespace victorious
