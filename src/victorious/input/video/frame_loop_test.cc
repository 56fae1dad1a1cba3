#include "victorious/input/video/frame_loop.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

// Frames 0 to 49, 10 per second.
class CountingReader final : public VideoReader {
 public:
  [[nodiscard]] const VideoInfo& info() const override { return info_; }
  [[nodiscard]] Expected<std::string> ContentId(const CancelToken& /*cancel*/,
                                                const ByteProgress& /*progress*/) const override {
    return "counted";
  }
  Expected<std::optional<Frame>> NextFrame() override {
    if (next == 50) return std::nullopt;
    if (next == broken_at) return Fail(ErrorCode::kDataLoss, "broken");
    if (before_frame) before_frame(next);
    const std::int64_t index = next++;
    return Frame{.index = index, .time_s = static_cast<double>(index) / 10, .image = {}};
  }
  std::vector<DataPacket> TakeDataPackets() override { return {}; }
  bool SeekTo(double /*time_s*/) override { return false; }
  void SkipToEnd() override { next = 50; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }

  std::int64_t next = 0;
  std::int64_t broken_at = -1;
  std::function<void(std::int64_t)> before_frame;

 private:
  VideoInfo info_;
  std::vector<std::string> warnings_;
};

struct Work {
  std::int64_t frame = 0;
  std::int64_t square = 0;
};

std::optional<Work> SelectEven(const Frame& frame) {
  return frame.index % 2 == 0 ? std::optional(Work{.frame = frame.index}) : std::nullopt;
}

Status Square(Work& work) {
  work.square = work.frame * work.frame;
  return {};
}

TEST(LiveDelayTest, IsUnknownUntilAFrameWasWaitedFor) {
  LiveDelay delay;
  delay.EnterRead(0, 0.001);
  delay.EnterRead(0.1, 0.001);
  EXPECT_FALSE(delay.ReadBehind());
  delay.EnterRead(0.2, 0.08);
  EXPECT_NEAR(delay.ReadBehind().value(), 0, 0.1) << "the frame of the latest time stamp, read as soon as any";
  delay.EnterRead(-0.8, 0.001);
  EXPECT_NEAR(delay.ReadBehind().value(), 1.0, 0.1) << "filmed a second before it";
}

TEST(LiveDelayTest, CountsTheTimeOfOpeningUntilAFrameWasWaitedFor) {
  LiveDelay delay(std::chrono::steady_clock::now() - std::chrono::seconds(2));
  delay.EnterRead(0, 0.001);
  EXPECT_NEAR(delay.BehindOf(0), 2.0, 0.1);
  delay.EnterRead(0.1, 0.08);
  EXPECT_NEAR(delay.BehindOf(0.1), 0, 0.1);
}

TEST(LiveDelayTest, RemembersTheLatestOfTheLastSeconds) {
  LiveDelay delay;
  delay.EnterRead(10, 0.08);
  EXPECT_NEAR(delay.EnterDone(8), 2.0, 0.1);
  EXPECT_NEAR(delay.EnterDone(10), 2.0, 0.1) << "the frame before it was late";
}

// By a clock that loses 50 microseconds a second, a source seemed to be 0.1 s behind after half an hour.
TEST(LiveDelayTest, SourceWithASlowClockIsNotBehind) {
  double now_s = 0;
  LiveDelay delay({},
                  [&] { return LiveDelay::Clock::time_point(std::chrono::nanoseconds(std::llround(1e9 * now_s))); });
  for (double time_s = 0; time_s < 86'400; time_s += 10) {
    now_s = time_s * (1 + 0.5 * LiveDelay::kMaxDrift);
    delay.EnterRead(time_s, 0.04);
  }
  EXPECT_NEAR(delay.ReadBehind().value(), 0, 0.01);
  now_s += 2;
  EXPECT_NEAR(delay.BehindOf(86'390), 2, 0.01);
}

class FrameLoopTest : public ::testing::Test {
 protected:
  // A loop with a parallel stage, and one that stores the squares in order.
  Expected<FrameLoopEnd> Run(FrameLoop& loop, const std::function<Status(Work&)>& parallel = Square) {
    return loop.Run<Work>(SelectEven, {Parallel<Work>(parallel), InOrder<Work>([&](const Work& work) -> Status {
                                         if (work.frame == refused_) return Fail(ErrorCode::kNoSpace, "refused");
                                         squares_.push_back(work.square);
                                         return {};
                                       })});
  }

  CountingReader reader_;
  CancelToken cancel_;
  std::int64_t refused_ = -1;
  std::vector<std::int64_t> squares_;
};

TEST(CountFramesUntilTest, KnowsTheFramesOfAPart) {
  VideoInfo info;
  info.frame_rate = 10;
  EXPECT_EQ(CountFramesUntil(info, 1), 11);
  info.frame_count = 60;
  EXPECT_EQ(CountFramesUntil(info, 0), 1);
  EXPECT_EQ(CountFramesUntil(info, 0.999), 11);
  EXPECT_EQ(CountFramesUntil(info, 1), 11);
  EXPECT_EQ(CountFramesUntil(info, 1.05), 11);
  EXPECT_EQ(CountFramesUntil(info, 100), 60);
  EXPECT_EQ(CountFramesUntil(info, 1e300), 60);
  info.frame_rate = 0;
  EXPECT_EQ(CountFramesUntil(info, 1), 60);
  info.frame_count.reset();
  EXPECT_EQ(CountFramesUntil(info, 1), std::nullopt);
}

TEST_F(FrameLoopTest, ResultsDoNotDependOnTheNumberOfThreads) {
  std::set<std::vector<std::int64_t>> results;
  for (const int threads : {1, 2, 8}) {
    reader_.next = 0;
    squares_.clear();
    FrameLoop loop(reader_, cancel_, {.threads = threads});
    EXPECT_EQ(Run(loop), FrameLoopEnd::kEndOfVideo);
    EXPECT_EQ(loop.frames_read(), 50);
    EXPECT_DOUBLE_EQ(loop.last_time_s(), 4.9);
    results.insert(squares_);
  }
  ASSERT_THAT(results, SizeIs(1));
  EXPECT_THAT(*results.begin(), SizeIs(25));
  EXPECT_EQ(results.begin()->back(), 48 * 48);
}

TEST_F(FrameLoopTest, FirstErrorInFrameOrderIsReturned) {
  FrameLoop loop(reader_, cancel_, {.threads = 4});
  refused_ = 6;
  const auto fail_at_10 = [](Work& work) -> Status {
    if (work.frame >= 10) return Fail(ErrorCode::kInternal, "too far");
    return Square(work);
  };
  const auto end = Run(loop, fail_at_10);
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().message, "refused");
  EXPECT_THAT(squares_, ElementsAre(0, 4, 16));
}

TEST_F(FrameLoopTest, FramesBeforeAReadErrorPassAllStages) {
  FrameLoop loop(reader_, cancel_, {.threads = 2});
  reader_.broken_at = 5;
  const auto end = Run(loop);
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error(), (Error{ErrorCode::kDataLoss, "broken"}));
  EXPECT_THAT(squares_, ElementsAre(0, 4, 16));
}

TEST_F(FrameLoopTest, FramesReadBeforeCancelPassAllStages) {
  FrameLoop loop(reader_, cancel_, {.threads = 2});
  reader_.before_frame = [&](std::int64_t frame) {
    if (frame == 4) cancel_.Cancel();
  };
  EXPECT_EQ(Run(loop), FrameLoopEnd::kCancelled);
  EXPECT_EQ(loop.frames_read(), 5);
  EXPECT_THAT(squares_, ElementsAre(0, 4, 16));
}

TEST_F(FrameLoopTest, StopEndsTheLoop) {
  FrameLoop loop(reader_, cancel_, {.threads = 2, .max_in_flight = 2});
  std::vector<std::int64_t> seen;
  const auto end = loop.ForEach([&](const Frame& frame) -> Status {
    seen.push_back(frame.index);
    if (frame.index == 3) loop.Stop();
    return {};
  });
  EXPECT_EQ(end, FrameLoopEnd::kStopped);
  EXPECT_GE(seen.size(), 4U);
  EXPECT_LT(seen.size(), 10U);
}

TEST_F(FrameLoopTest, FramesInFlightAreLimited) {
  FrameLoop loop(reader_, cancel_, {.threads = 8, .max_in_flight = 2});
  std::atomic<int> in_flight = 0;
  std::atomic<int> max_in_flight = 0;
  const auto end = Run(loop, [&](Work& work) {
    const int now = ++in_flight;
    for (int before = max_in_flight; now > before && !max_in_flight.compare_exchange_weak(before, now);) {
    }
    const Status status = Square(work);
    --in_flight;
    return status;
  });
  EXPECT_EQ(end, FrameLoopEnd::kEndOfVideo);
  EXPECT_LE(max_in_flight, 2);
}

// Holds every frame back until one of a second later was read.
class OneSecondLate final : public PacketReceiver {
 public:
  Status Add(std::vector<DataPacket> /*packets*/, double now_s) override {
    newest_s = now_s;
    return {};
  }
  [[nodiscard]] bool IsReady(double frame_s, double now_s) const override { return now_s >= frame_s + 1; }

  double newest_s = 0;
};

TEST_F(FrameLoopTest, FramesWaitForTheirPackets) {
  OneSecondLate packets;
  FrameLoop loop(reader_, cancel_, {.threads = 1, .packets = &packets});
  std::vector<double> waits_s;
  const auto select = [&](const Frame& frame) {
    waits_s.push_back(packets.newest_s - frame.time_s);
    return std::optional(Work{.frame = frame.index});
  };
  EXPECT_EQ(loop.Run<Work>(select, {}), FrameLoopEnd::kEndOfVideo);
  ASSERT_THAT(waits_s, SizeIs(50));
  EXPECT_DOUBLE_EQ(waits_s.front(), 1);
  EXPECT_DOUBLE_EQ(waits_s.back(), 0);  // nothing comes after the end
}

}  // namespace
}  // namespace victorious
