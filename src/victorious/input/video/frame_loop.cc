#include "victorious/input/video/frame_loop.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <utility>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include "victorious/base/progress.h"
#include "victorious/base/stage_time.h"
#include "victorious/base/utc.h"

namespace victorious {
namespace {

// A shorter read is that of a frame that has come before, and its decoding.
constexpr double kMinWait_s = 0.015;

double Seconds(LiveDelay::Clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

// Reads frames until the end, a cancellation, a stop or an error. Holds them back as the packet receiver wants.
class HeldFrames {
 public:
  HeldFrames(VideoReader& reader, const CancelToken& cancel, const std::atomic<bool>& stopped, PacketReceiver* packets,
             LiveDelay& delay)
      : reader_(reader), cancel_(cancel), stopped_(stopped), packets_(packets), delay_(delay) {}

  std::optional<Frame> Next() {
    if (packets_ == nullptr) return Read();
    while (held_.empty() || !packets_->IsReady(held_.front().time_s, held_.back().time_s)) {
      std::optional<Frame> frame = Read();
      if (!frame) break;
      held_.push_back(*std::move(frame));
    }
    if (held_.empty()) return std::nullopt;
    Frame first = std::move(held_.front());
    held_.pop_front();
    return first;
  }

  [[nodiscard]] const Status& status() const { return status_; }
  [[nodiscard]] FrameLoopEnd end() const { return end_; }
  [[nodiscard]] std::int64_t frames_read() const { return frames_read_; }
  [[nodiscard]] double last_time_s() const { return last_time_s_; }

 private:
  std::optional<Frame> Read() {
    if (!status_ || ended_) return std::nullopt;
    if (stopped_) return End(FrameLoopEnd::kStopped);
    if (cancel_.IsCancelled()) return End(FrameLoopEnd::kCancelled);
    const StageScope scope(Stage::kReading);
    const auto before = std::chrono::steady_clock::now();
    Expected<std::optional<Frame>> frame = reader_.NextFrame();
    if (!frame) {
      status_ = std::unexpected(std::move(frame).error());
      return std::nullopt;
    }
    if (!*frame) return End(FrameLoopEnd::kEndOfVideo);
    ++frames_read_;
    last_time_s_ = (*frame)->time_s;
    delay_.EnterRead(last_time_s_, std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count());
    std::vector<DataPacket> packets = reader_.TakeDataPackets();
    if (packets_ != nullptr) status_ = packets_->Add(std::move(packets), last_time_s_);
    return *std::move(frame);
  }

  std::optional<Frame> End(FrameLoopEnd end) {
    ended_ = true;
    end_ = end;
    return std::nullopt;
  }

  VideoReader& reader_;
  const CancelToken& cancel_;
  const std::atomic<bool>& stopped_;
  PacketReceiver* packets_;
  LiveDelay& delay_;
  std::deque<Frame> held_;
  Status status_;
  bool ended_ = false;
  FrameLoopEnd end_ = FrameLoopEnd::kEndOfVideo;
  std::int64_t frames_read_ = 0;
  double last_time_s_ = 0;
};

// A frame's work on its way through the stages.
struct Passage {
  std::int64_t frame = 0;
  double time_s = 0;
  std::shared_ptr<void> work;
  Status status;
};
using PassagePtr = std::shared_ptr<Passage>;

}  // namespace

std::optional<std::int64_t> CountFramesUntil(const VideoInfo& info, double time_s) {
  constexpr double kMaxFrames = 1e12;
  constexpr double kRounding = 0.01;  // of time stamps, in frames
  const double frames = std::floor(std::max(0.0, time_s) * info.frame_rate + kRounding) + 1;
  if (!(info.frame_rate > 0) || !(frames < kMaxFrames)) return info.frame_count;
  const auto count = static_cast<std::int64_t>(frames);
  return std::min(count, info.frame_count.value_or(count));
}

double LiveDelay::Now_s() const { return Seconds(now_()); }

void LiveDelay::EnterRead(double time_s, double waited_s) {
  const bool is_first = !std::isfinite(min_offset_s_);
  const double drift_s = is_first ? 0 : kMaxDrift * std::max(0.0, time_s - last_time_s_);
  last_time_s_ = time_s;
  min_offset_s_ = std::min(min_offset_s_ + drift_s, Now_s() - time_s);
  has_waited_ = has_waited_ || waited_s >= kMinWait_s;
  if (has_waited_ || !since_) {
    offset_s_ = min_offset_s_;
  } else if (is_first) {
    offset_s_ = Seconds(*since_) - time_s;
  }
  if (has_waited_) read_behind_s_ = BehindOf(time_s);
}

double LiveDelay::EnterDone(double time_s) {
  constexpr double kInterval_s = 5;
  const double now_s = Now_s();
  if (now_s - interval_begin_s_.value_or(now_s - kInterval_s) >= kInterval_s) {
    max_behind_before_s_ = std::exchange(max_behind_s_, 0);
    interval_begin_s_ = now_s;
  }
  max_behind_s_ = std::max(max_behind_s_, BehindOf(time_s));
  return std::max(max_behind_s_, max_behind_before_s_);
}

double LiveDelay::BehindOf(double time_s) const { return std::max(0.0, Now_s() - time_s - offset_s_); }

std::int64_t LiveDelay::ArrivalUtc(double time_s) const {
  return NowUtcMicroseconds() - static_cast<std::int64_t>(1e6 * BehindOf(time_s));
}

void FrameLoop::Stop() { stopped_ = true; }

Expected<FrameLoopEnd> FrameLoop::RunErased(const std::function<std::shared_ptr<void>(Frame)>& select,
                                            const std::vector<ErasedStage>& stages) {
  namespace tbb = oneapi::tbb;
  std::optional<Progress> progress;
  if (!options_.label.empty()) {
    progress.emplace(options_.label, options_.frame_count ? options_.frame_count : reader_.info().frame_count,
                     "frames");
  }
  HeldFrames frames(reader_, cancel_, stopped_, options_.packets, delay_);
  const bool is_live = reader_.info().live;
  const auto report = [&](std::int64_t frame, double time_s) {
    if (progress) progress->Update(frame + 1, is_live ? std::optional(delay_.EnterDone(time_s)) : std::nullopt);
  };
  std::atomic<bool> failed = false;
  Status status;  // of the first frame that failed; written by the last filter only

  bool entered = false;  // true once a frame is in the stages: from then on, the last filter reports progress
  const auto read = [&](tbb::flow_control& control) -> PassagePtr {
    while (!failed) {
      std::optional<Frame> frame = frames.Next();
      if (!frame) break;
      const std::int64_t index = frame->index;
      const double time_s = frame->time_s;
      if (std::shared_ptr<void> work = select(*std::move(frame))) {
        entered = true;
        return std::make_shared<Passage>(
            Passage{.frame = index, .time_s = time_s, .work = std::move(work), .status = {}});
      }
      if (!entered) report(index, time_s);
    }
    control.stop();
    return nullptr;
  };
  auto chain = tbb::make_filter<void, PassagePtr>(tbb::filter_mode::serial_in_order, read);
  for (const ErasedStage& stage : stages) {
    const auto run = [&stage, &failed, blocked = std::make_shared<bool>(false)](PassagePtr passage) {
      if (!stage.parallel) *blocked = *blocked || !passage->status;
      if (!passage->status || (!stage.parallel && *blocked)) return passage;
      passage->status = stage.run(passage->work.get());
      if (passage->status) return passage;
      failed = true;
      if (!stage.parallel) *blocked = true;
      return passage;
    };
    const auto mode = stage.parallel ? tbb::filter_mode::parallel : tbb::filter_mode::serial_in_order;
    chain = chain & tbb::make_filter<PassagePtr, PassagePtr>(mode, run);
  }
  const auto finish = [&](const PassagePtr& passage) {
    if (status) status = std::move(passage->status);
    report(passage->frame, passage->time_s);
  };
  const auto pipeline = chain & tbb::make_filter<PassagePtr, void>(tbb::filter_mode::serial_in_order, finish);

  const int threads = options_.threads > 0 ? options_.threads : tbb::info::default_concurrency();
  const std::size_t in_flight =
      options_.max_in_flight > 0 ? options_.max_in_flight : 2 * static_cast<std::size_t>(threads);
  // An arena cannot exceed the hardware concurrency without global_control; oneTBB would warn on stderr.
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_pipeline(in_flight, pipeline); });
  frames_read_ = frames.frames_read();
  last_time_s_ = frames.last_time_s();
  VICTORIOUS_RETURN_IF_ERROR(status);
  VICTORIOUS_RETURN_IF_ERROR(frames.status());
  return frames.end();
}

}  // namespace victorious
