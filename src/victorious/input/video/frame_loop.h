// The loop over a video's frames that every job shares: reading, cancellation, progress and threads. A job gives it the
// stages that a frame passes:
//
//   FrameLoop loop(reader, cancel, {.label = video});
//   loop.Run<Work>(select, {Parallel<Work>(search), InOrder<Work>(track), InOrder<Work>(store)});
//
// A parallel stage works on several frames at a time; an in-order stage sees one frame after another. Results
// therefore do not depend on the number of threads. The stages run on oneTBB's threads, reading ahead of the stages;
// a stage may itself use oneTBB.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/types/data_packet.h"
#include "victorious/types/frame.h"

namespace victorious {

/// Receives the data packets of a source while its frames are read, and holds frames back until their data has arrived.
class PacketReceiver {
 public:
  virtual ~PacketReceiver() = default;

  /// @param packets  packets since the last call
  /// @param now_s    time of the newest frame
  [[nodiscard]] virtual Status Add(std::vector<DataPacket> packets, double now_s) = 0;

  /// True if the frame at `frame_s` needs no later packet, or has waited long enough. @param now_s  of the newest frame
  [[nodiscard]] virtual bool IsReady(double frame_s, double now_s) const = 0;
};

struct FrameLoopOptions {
  std::string label = {};             ///< of the progress display; empty: none
  int threads = 0;                    ///< 0: one per processor
  std::size_t max_in_flight = 0;      ///< frames between the first and the last stage; 0: two per thread
  PacketReceiver* packets = nullptr;  ///< null: data packets are discarded
  /// Frames up to the last one wanted, for the progress display (CountFramesUntil); std::nullopt: those of the video.
  std::optional<std::int64_t> frame_count = {};
};

/// The expected number of frames up to a time, s: that of the whole video for one after its end, or if the frame rate
/// is unknown; std::nullopt if that is unknown, too.
[[nodiscard]] std::optional<std::int64_t> CountFramesUntil(const VideoInfo& info, double time_s);

/// How far the work on a live source is behind it. The time stamps of frames tell when each was filmed up to a common
/// offset to this machine's clock; the frame that waited least before it was read bounds the offset. Before a frame was
/// waited for, the first one counts as filmed when the source was opened. The clock of the source may be slower than
/// this machine's by kMaxDrift.
class LiveDelay {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr double kMaxDrift = 1e-4;  ///< of common oscillators, both together: 0.36 s an hour

  /// @param since  VideoInfo::live_since; std::nullopt: the first frame counts as filmed when it is read
  explicit LiveDelay(std::optional<Clock::time_point> since = {}, std::function<Clock::time_point()> now = Clock::now)
      : since_(since), now_(std::move(now)) {}

  /// Call when a frame has been read, from one thread. @param waited_s  that reading it took
  void EnterRead(double time_s, double waited_s);
  /// How long ago a frame of this time stamp could have been read, s: at most so long until a frame was waited for,
  /// then at least. Any thread.
  [[nodiscard]] double BehindOf(double time_s) const;
  /// Call when the work on a frame is done, from one thread. @return the most that a frame of the last 5 to 10 s was
  /// behind when its work was done, s
  double EnterDone(double time_s);
  /// UTC at which it could have been read, microseconds since 1970. Any thread.
  [[nodiscard]] std::int64_t ArrivalUtc(double time_s) const;
  /// How late the frame read last was read, s; std::nullopt until a frame was waited for: before, those that came while
  /// the source was opened may still wait. Of the reading thread.
  [[nodiscard]] std::optional<double> ReadBehind() const { return read_behind_s_; }

 private:
  [[nodiscard]] double Now_s() const;

  std::optional<Clock::time_point> since_;
  std::function<Clock::time_point()> now_;
  double last_time_s_ = 0;
  std::atomic<double> offset_s_ = std::numeric_limits<double>::infinity();
  double min_offset_s_ = std::numeric_limits<double>::infinity();  // of the frames read
  bool has_waited_ = false;
  std::optional<double> read_behind_s_;
  // Of EnterDone: the maximum of the current interval and of the one before it, and when the current one began.
  double max_behind_s_ = 0;
  double max_behind_before_s_ = 0;
  std::optional<double> interval_begin_s_;
};

/// How a loop ended without an error.
enum class FrameLoopEnd {
  kEndOfVideo,
  kStopped,    ///< by FrameLoop::Stop
  kCancelled,  ///< all frames that were read have passed all stages
};

/// A step of the work on a frame. An error ends the loop.
template <typename Work>
struct FrameStage {
  bool parallel = false;
  std::function<Status(Work&)> run;
};

/// A stage that works on several frames at a time. `run` is called concurrently.
template <typename Work, typename Run>
FrameStage<Work> Parallel(Run run) {
  return {.parallel = true, .run = std::move(run)};
}

/// A stage that works on one frame at a time, in frame order.
template <typename Work, typename Run>
FrameStage<Work> InOrder(Run run) {
  return {.parallel = false, .run = std::move(run)};
}

/// One loop over the frames of a reader, from where it stands.
class FrameLoop {
 public:
  /// The references outlive it.
  FrameLoop(VideoReader& reader, const CancelToken& cancel, FrameLoopOptions options)
      : reader_(reader), cancel_(cancel), options_(std::move(options)), delay_(reader.info().live_since) {}

  /// Passes the frames through stages until the video ends, a stage fails, Stop() is called, or `cancel` is set.
  /// @param select  makes the work of a frame; std::nullopt skips the frame. Called in frame order, while earlier
  ///                frames are in the stages
  /// After an error of a stage, no later frame enters that in-order stage or those behind it; the frames before it pass
  /// all stages. Errors: the first stage's in frame order, else that of reading or of the packet receiver.
  template <typename Work>
  [[nodiscard]] Expected<FrameLoopEnd> Run(const std::function<std::optional<Work>(Frame)>& select,
                                           const std::vector<FrameStage<Work>>& stages) {
    std::vector<ErasedStage> erased;
    for (const FrameStage<Work>& stage : stages) {
      erased.push_back({stage.parallel, [&stage](void* work) { return stage.run(*static_cast<Work*>(work)); }});
    }
    const auto select_erased = [&select](Frame frame) -> std::shared_ptr<void> {
      std::optional<Work> work = select(std::move(frame));
      return work ? std::make_shared<Work>(*std::move(work)) : nullptr;
    };
    return RunErased(select_erased, erased);
  }

  /// Runs one in-order stage on every frame.
  [[nodiscard]] Expected<FrameLoopEnd> ForEach(const std::function<Status(Frame&)>& visit) {
    return Run<Frame>([](Frame frame) { return std::optional(std::move(frame)); }, {InOrder<Frame>(visit)});
  }

  /// Ends the loop: no further frame is read; those that were read pass all stages. Callable from `select` and from any
  /// stage.
  void Stop();

  /// Number of frames read.
  [[nodiscard]] std::int64_t frames_read() const { return frames_read_; }
  /// How far reading is behind a live source, s; std::nullopt as long as it has not caught up with it (LiveDelay).
  /// Callable from `select`.
  [[nodiscard]] std::optional<double> ReadBehind() const { return delay_.ReadBehind(); }
  /// Time of the last frame read, s; 0 if there was none.
  [[nodiscard]] double last_time_s() const { return last_time_s_; }

 private:
  struct ErasedStage {
    bool parallel = false;
    std::function<Status(void*)> run;
  };

  [[nodiscard]] Expected<FrameLoopEnd> RunErased(const std::function<std::shared_ptr<void>(Frame)>& select,
                                                 const std::vector<ErasedStage>& stages);

  VideoReader& reader_;
  const CancelToken& cancel_;
  FrameLoopOptions options_;
  std::atomic<bool> stopped_ = false;
  LiveDelay delay_;
  std::int64_t frames_read_ = 0;
  double last_time_s_ = 0;
};

}  // namespace victorious
