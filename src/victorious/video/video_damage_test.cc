// Damaged videos: for any damage, reading terminates, times increase, and a warning gives the time of the damage.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "testing/data.h"
#include "testing/video_tools.h"
#include "victorious/base/random.h"
#include "victorious/video/video_reader.h"

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

constexpr int kFrames = 50;

void WriteWhole(const std::filesystem::path& path, const std::string& muxer, const std::string& encoder) {
  WriteTestVideo(path, {.muxer = muxer,
                        .encoder = encoder,
                        .time_base_hz = 25,
                        .pts = SteadyTimes(kFrames, 1),
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
      EXPECT_LE(outcome.frames, static_cast<std::size_t>(kFrames)) << name;
      EXPECT_GE(static_cast<double>(outcome.frames), kFrames * (part - 0.3)) << name;
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
      EXPECT_LE(outcome.frames, static_cast<std::size_t>(kFrames + 5)) << muxer << ", seed " << kSeed;
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
  EXPECT_EQ(count, kFrames);
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
  EXPECT_GT(outcome.frames, static_cast<std::size_t>(kFrames / 2));
  EXPECT_EQ(outcome.numbers.front(), 0);
  EXPECT_EQ(outcome.numbers.back(), kFrames - 1) << "frames after the hole are read";
  EXPECT_FALSE(outcome.warnings.empty());
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
