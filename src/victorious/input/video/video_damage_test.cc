// Damaged videos: for any damage, reading terminates, times increase, and a warning gives the time of the damage.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "testing/data.h"
#include "testing/video_tools.h"
#include "victorious/base/random.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using testing::DecodeImageNumber;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::ScratchFolder;
using testing::SteadyTimes;
using testing::WriteTestVideo;

struct Outcome {
  std::size_t frames = 0;
  std::vector<int> numbers;
  std::vector<std::string> warnings;
  std::optional<Error> error;
};

Outcome ReadDamaged(const std::filesystem::path& path) {
  Outcome outcome;
  const auto reader = VideoReader::Open(path.string(), {.data_packets = true, .threads = 1});
  if (!reader) {
    outcome.error = reader.error();
    return outcome;
  }
  double last_s = -1;
  while (true) {
    const auto frame = (*reader)->NextFrame();
    if (!frame) outcome.error = frame.error();
    if (!frame || !*frame) break;
    EXPECT_GT((*frame)->time_s, last_s);
    last_s = (*frame)->time_s;
    EXPECT_EQ((*frame)->index, static_cast<std::int64_t>(outcome.frames));
    outcome.numbers.push_back(DecodeImageNumber((*frame)->image));
    ++outcome.frames;
  }
  outcome.warnings = (*reader)->warnings();
  for (const std::string& warning : outcome.warnings) EXPECT_THAT(warning, Not(HasSubstr("\n")));
  return outcome;
}

constexpr int kDamagedFrames = 50;

void WriteWhole(const std::filesystem::path& path, const std::string& muxer, const std::string& encoder) {
  WriteTestVideo(path, {.muxer = muxer,
                        .encoder = encoder,
                        .time_base_hz = 25,
                        .pts = SteadyTimes(kDamagedFrames, 1),
                        .max_b_frames = encoder == "libx264" ? 2 : 0});
}

const std::pair<std::string, std::string> kKinds[] = {
    {"mp4", "libx264"}, {"matroska", "libx264"}, {"mpegts", "libx264"}, {"avi", "mpeg4"}, {"mpeg", "mpeg1video"}};

TEST(VideoDamage, TruncatedFilesGiveTheirFirstFrames) {
  const ScratchFolder folder;
  for (const auto& [muxer, encoder] : kKinds) {
    WriteWhole(folder / "whole", muxer, encoder);
    const std::string whole = testing::ReadBytes(folder / "whole");
    for (const double part : {0.01, 0.1, 0.33, 0.5, 0.77, 0.95}) {
      testing::WriteBytes(folder / "cut",
                          whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
      const Outcome outcome = ReadDamaged(folder / "cut");
      const std::string name = muxer + " cut at " + std::to_string(part);
      if (outcome.error) {
        EXPECT_EQ(outcome.error->code, ErrorCode::kDataLoss) << name << ": " << outcome.error->message;
        EXPECT_LE(part, 0.5) << name << ": " << outcome.error->message;
        continue;
      }
      EXPECT_LE(outcome.frames, static_cast<std::size_t>(kDamagedFrames)) << name;
      EXPECT_GE(static_cast<double>(outcome.frames), kDamagedFrames * (part - 0.3)) << name;
      for (std::size_t i = 0; i + 1 < outcome.frames; ++i) EXPECT_EQ(outcome.numbers[i], static_cast<int>(i)) << name;
      // A transport or program stream has no duration in its header.
      if (muxer != "mpegts" && muxer != "mpeg" && part < 0.8) {
        EXPECT_THAT(outcome.warnings, Contains(HasSubstr("decoding stopped at"))) << name;
        EXPECT_THAT(outcome.warnings, Contains(HasSubstr(" of 2.0"))) << name;
      }
    }
  }
}

TEST(VideoDamage, TruncationIsReportedWithoutDecoding) {
  const ScratchFolder folder;
  for (const auto& [muxer, encoder] : kKinds) {
    WriteWhole(folder / "whole", muxer, encoder);
    const std::string whole = testing::ReadBytes(folder / "whole");
    const auto warnings_of = [&](double part) {
      testing::WriteBytes(folder / "part",
                          whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
      const auto reader = VideoReader::Open((folder / "part").string(), {.threads = 1});
      if (!reader) return std::vector<std::string>{reader.error().message};
      EXPECT_TRUE((*reader)->NextFrame().value());
      (*reader)->SkipToEnd();
      return (*reader)->warnings();
    };
    EXPECT_THAT(warnings_of(1), IsEmpty()) << muxer;
    if (muxer == "mpegts" || muxer == "mpeg") continue;  // no duration in the header
    EXPECT_THAT(warnings_of(0.6), Contains(AllOf(HasSubstr("reading stopped at"), HasSubstr(" of 2.0")))) << muxer;
  }
}

// Decoders delay frames: at the end of a short file no frame may have been output yet.
TEST(VideoDamage, CompleteFilesGiveNoWarning) {
  const ScratchFolder folder;
  for (const auto& [muxer, encoder] : kKinds) {
    for (const int frames : {5, 7, 12, 40}) {
      WriteTestVideo(folder / "whole", {.muxer = muxer,
                                        .encoder = encoder,
                                        .time_base_hz = 25,
                                        .pts = SteadyTimes(frames, 1),
                                        .max_b_frames = encoder == "libx264" ? 2 : 0});
      for (const int decoded : {0, 1, frames / 2}) {
        const auto reader = VideoReader::Open((folder / "whole").string(), {.threads = 8});
        ASSERT_TRUE(reader) << muxer << ", " << frames << " frames: " << reader.error().message;
        for (int i = 0; i < decoded; ++i) EXPECT_TRUE((*reader)->NextFrame().value());
        (*reader)->SkipToEnd();
        EXPECT_THAT((*reader)->warnings(), IsEmpty()) << muxer << ", " << decoded << " of " << frames;
      }
    }
  }
}

TEST(VideoDamage, Mp4WithoutIndexIsRefused) {
  const ScratchFolder folder;
  WriteWhole(folder / "whole.mp4", "mp4", "libx264");
  std::string bytes = testing::ReadBytes(folder / "whole.mp4");
  bytes.replace(bytes.find("moov"), 4, "skit");
  testing::WriteBytes(folder / "cut.mp4", bytes);
  const Outcome outcome = ReadDamaged(folder / "cut.mp4");
  ASSERT_TRUE(outcome.error);
  EXPECT_EQ(outcome.error->code, ErrorCode::kDataLoss);
  EXPECT_THAT(outcome.error->message, HasSubstr("not a video that can be read"));
}

TEST(VideoDamage, ChangedBytesNeverCrash) {
  constexpr std::uint64_t kSeed = 4711;
  Random random(kSeed);
  const ScratchFolder folder;
  for (const auto& [muxer, encoder] : kKinds) {
    WriteWhole(folder / "whole", muxer, encoder);
    const std::string whole = testing::ReadBytes(folder / "whole");
    for (int round = 0; round < 12; ++round) {
      std::string bytes = whole;
      const int changes = 1 << (round % 7);
      for (int i = 0; i < changes; ++i) {
        bytes[random.Below(static_cast<std::uint32_t>(bytes.size()))] = static_cast<char>(random.Next());
      }
      testing::WriteBytes(folder / "damaged", bytes);
      const Outcome outcome = ReadDamaged(folder / "damaged");
      EXPECT_LE(outcome.frames, static_cast<std::size_t>(kDamagedFrames + 5)) << muxer << ", seed " << kSeed;
    }
  }
}

TEST(VideoDamage, TimestampFarAheadAffectsNoOtherFrame) {
  const ScratchFolder folder;
  WriteWhole(folder / "whole.ts", "mpegts", "mpeg1video");
  std::string bytes = testing::ReadBytes(folder / "whole.ts");
  std::size_t packet = 0;
  for (int i = 0; i < 20; ++i) packet = bytes.find(std::string("\0\0\x01\xE0", 4), packet + 1);
  char& stamp = bytes[packet + 9];  // bits 30 to 32 of the time stamp
  ASSERT_EQ(stamp & 0xE1, 0x21);
  stamp = static_cast<char>(stamp | 0x04);
  testing::WriteBytes(folder / "stamp.ts", bytes);
  const auto reader = VideoReader::Open((folder / "stamp.ts").string(), {});
  ASSERT_TRUE(reader) << reader.error().message;
  int count = 0;
  while (const auto frame = (*reader)->NextFrame().value()) {
    EXPECT_EQ(DecodeImageNumber(frame->image), count);
    EXPECT_NEAR(frame->time_s, count / 25.0, 1e-4);
    ++count;
  }
  EXPECT_EQ(count, kDamagedFrames);
  EXPECT_THAT((*reader)->warnings(), Contains(HasSubstr("at 0.76 s: a damaged time stamp")));
}

TEST(VideoDamage, HoleIsSkippedWithAWarning) {
  const ScratchFolder folder;
  WriteWhole(folder / "whole.ts", "mpegts", "libx264");
  std::string bytes = testing::ReadBytes(folder / "whole.ts");
  const std::size_t third = bytes.size() / 3 / 188 * 188;
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(third), bytes.size() / 8, '\xFF');
  testing::WriteBytes(folder / "hole.ts", bytes);
  const Outcome outcome = ReadDamaged(folder / "hole.ts");
  EXPECT_FALSE(outcome.error);
  EXPECT_GT(outcome.frames, static_cast<std::size_t>(kDamagedFrames / 2));
  EXPECT_EQ(outcome.numbers.front(), 0);
  EXPECT_EQ(outcome.numbers.back(), kDamagedFrames - 1) << "frames after the hole are read";
  EXPECT_FALSE(outcome.warnings.empty());
}

// A part of a stream whose first picture has the number `first`, with a KLV packet at each.
std::string WritePart(const std::filesystem::path& path, int first, std::int64_t begin_ms,
                      int key_frame_interval = 12) {
  testing::TestVideo video{.muxer = "mpegts", .pts = {}, .key_frame_interval = key_frame_interval};
  for (int i = 0; i < 24; ++i) {
    video.pts.push_back(begin_ms + 40 * i);
    video.images.push_back(testing::NumberedImage(first + i, video.size));
    video.klv.push_back({begin_ms + 40 * i, "\x06\x0E\x2B\x34" + std::to_string(first + i)});
  }
  WriteTestVideo(path, video);
  return testing::ReadBytes(path);
}

// ISO/IEC 13818-1: a programme has one time base. What moves the frames moves the telemetry.
TEST(VideoDamage, JoinedStreamsShareOneClock) {
  const ScratchFolder folder;
  for (const std::int64_t second_ms : {2000, 1000, 2500}) {
    const std::string bytes = WritePart(folder / "a.ts", 0, 2000) + WritePart(folder / "b.ts", 24, second_ms);
    testing::WriteBytes(folder / "joined.ts", bytes);
    const Outcome outcome = ReadDamaged(folder / "joined.ts");
    ASSERT_EQ(outcome.frames, 48U) << second_ms;
    EXPECT_THAT(outcome.warnings, ::testing::ElementsAre(HasSubstr("at 0.96 s: the time stamps begin anew")));
    for (const bool decodes : {false, true}) {
      const auto reader = VideoReader::Open((folder / "joined.ts").string(), {.data_packets = true}).value();
      std::vector<double> frames_s;
      while (decodes) {
        const auto frame = reader->NextFrame().value();
        if (!frame) break;
        frames_s.push_back(frame->time_s);
      }
      if (!decodes) reader->SkipToEnd();
      const std::vector<DataPacket> packets = reader->TakeDataPackets();
      ASSERT_EQ(packets.size(), 48U);
      for (int i = 0; i < 48; ++i) {
        EXPECT_NEAR(packets[static_cast<std::size_t>(i)].time_s.value_or(-1), 0.04 * i, 1e-3) << second_ms;
        if (decodes) {
          EXPECT_NEAR(frames_s[static_cast<std::size_t>(i)], 0.04 * i, 1e-3);
        }
      }
    }
  }
}

TEST(VideoDamage, AStreamThatBeginsBetweenKeyFramesIsNotDamaged) {
  const ScratchFolder folder;
  const std::string whole = WritePart(folder / "a.ts", 0, 2000, 12);
  // From the first packet of the sixth picture on, behind the tables.
  constexpr std::size_t kPacket = 188;
  std::size_t images = 0;
  std::size_t at = 0;
  for (; at < whole.size() && images < 6; at += kPacket) {
    const bool begins = (whole[at + 1] & 0x40) != 0;
    images += begins && (whole[at + 1] & 0x1F) == 1 && static_cast<unsigned char>(whole[at + 2]) == 0 ? 1 : 0;
  }
  testing::WriteBytes(folder / "tap.ts", whole.substr(0, 3 * kPacket) + whole.substr(at - kPacket));
  const auto reader = VideoReader::Open((folder / "tap.ts").string(), {.data_packets = true}).value();
  EXPECT_NEAR(reader->info().duration_s.value_or(0), 0.48, 0.05);
  reader->SkipToEnd();
  EXPECT_THAT(reader->warnings(),
              ::testing::ElementsAre(HasSubstr("begins without a key frame: its first 0.28 s cannot be shown")));
  EXPECT_FALSE(reader->has_damage());
  const Outcome outcome = ReadDamaged(folder / "tap.ts");
  EXPECT_EQ(outcome.frames, 12U);
  EXPECT_THAT(outcome.warnings, ::testing::ElementsAre(HasSubstr("begins without a key frame")));
}

TEST(VideoDamage, NoFrameIsAnError) {
  const ScratchFolder folder;
  WriteWhole(folder / "whole.mp4", "mp4", "libx264");
  std::string bytes = testing::ReadBytes(folder / "whole.mp4");
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.find("mdat") + 4), bytes.end(), '\0');
  testing::WriteBytes(folder / "none.mp4", bytes);
  const Outcome outcome = ReadDamaged(folder / "none.mp4");
  ASSERT_TRUE(outcome.error);
  EXPECT_EQ(outcome.error->code, ErrorCode::kDataLoss);
  EXPECT_THAT(outcome.error->message, HasSubstr("no frame of its video can be decoded"));
  EXPECT_THAT(outcome.error->message, Not(HasSubstr("\n")));
}

}  // namespace
}  // namespace victorious
