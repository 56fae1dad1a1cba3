#include "victorious/jobs/index/video_cut.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::ElementsAre;

// 10 frames per second, a key frame at every multiple of `key_step`.
FrameTable SteadyTable(int frames, int key_step) {
  FrameTable table;
  for (int i = 0; i < frames; ++i) {
    table.times_s.push_back(i / 10.0);
    if (i % key_step == 0) table.key_times_s.push_back(i / 10.0);
  }
  return table;
}

TEST(CutVideo, CutsLieWhereTracksRestart) {
  EXPECT_THAT(CutVideo(SteadyTable(2000, 50), {.first_frame = 0, .step = 60, .segment_s = 60}),
              ElementsAre(FrameInterval{0, 600}, FrameInterval{600, 1200}, FrameInterval{1200, 2000}))
      << "no short rest";
  EXPECT_THAT(CutVideo(SteadyTable(400, 50), {.first_frame = 0, .step = 60, .segment_s = 10}),
              ElementsAre(FrameInterval{0, 120}, FrameInterval{120, 240}, FrameInterval{240, 400}));
  EXPECT_THAT(CutVideo(SteadyTable(400, 50), {.first_frame = 0, .step = 60, .segment_s = 60}),
              ElementsAre(FrameInterval{0, 400}));
}

TEST(CutVideo, BeginsWithTheFirstFrameThatIsNeeded) {
  EXPECT_THAT(CutVideo(SteadyTable(400, 50), {.first_frame = 130, .step = 60, .segment_s = 10}),
              ElementsAre(FrameInterval{120, 240}, FrameInterval{240, 400}));
  EXPECT_TRUE(CutVideo(SteadyTable(120, 50), {.first_frame = 120, .step = 60, .segment_s = 10}).empty());
}

TEST(CutVideo, StreamWithoutKeyFramesStaysWhole) {
  EXPECT_THAT(CutVideo(SteadyTable(3000, 3000), {.first_frame = 0, .step = 60, .segment_s = 60}),
              ElementsAre(FrameInterval{0, 3000}));
  FrameTable rare = SteadyTable(3000, 3000);
  rare.key_times_s.push_back(151);
  EXPECT_THAT(CutVideo(rare, {.first_frame = 0, .step = 60, .segment_s = 60}),
              ElementsAre(FrameInterval{0, 1560}, FrameInterval{1560, 3000}))
      << "near its only key frame";
}

TEST(PreparedVideo, ComesBackAsItWas) {
  PreparedVideo prepared{
      .times_s = {0, 0.1, 0.25}, .cameras = {}, .sun = Sun{1.5, 0.7}, .is_sun_by_clock = true, .file_bytes = 12345};
  prepared.cameras.SetFallbackFieldOfView(0.9);
  prepared.cameras.SetClockSigma(0.3);
  const std::vector<std::byte> bytes = PackPreparedVideo(prepared);
  const auto read = UnpackPreparedVideo(bytes);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->times_s, prepared.times_s);
  EXPECT_EQ(read->sun->elevation_rad, 0.7);
  EXPECT_TRUE(read->is_sun_by_clock);
  EXPECT_EQ(read->file_bytes, 12345);
  EXPECT_EQ(read->cameras.At(3)->hfov_rad, 0.9);
  EXPECT_EQ(PackPreparedVideo(*read), bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto damaged = UnpackPreparedVideo(std::span(bytes).first(size));
    ASSERT_FALSE(damaged) << size;
    EXPECT_EQ(damaged.error().code, ErrorCode::kDataLoss);
  }
}

}  // namespace
}  // namespace victorious
