#include "victorious/jobs/reverse_frame_reader.h"

#include <algorithm>
#include <optional>
#include <ranges>
#include <utility>

#include "victorious/base/progress.h"
#include "victorious/input/video/frame_loop.h"

namespace victorious {

Expected<std::unique_ptr<VideoReader>> OpenRereadable(const std::string& video) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::unique_ptr<VideoReader> reader,
                              VideoReader::Open(video, {.color = FrameColor::kBgr}));
  if (reader->info().live) {
    return Fail(ErrorCode::kInvalidArgument, video + ": a live source cannot be read twice: give a file or a folder");
  }
  return reader;
}

Status ReverseFrameReader::ForEach(std::int64_t end, const std::function<Status(const Frame&)>& visit) const {
  constexpr std::int64_t kMinInterval = 8;  // frames
  VICTORIOUS_ASSIGN_OR_RETURN(const auto first, OpenRereadable(video_));
  const std::int64_t frame_bytes = std::int64_t{3} * first->info().width * first->info().height;
  const std::int64_t interval = std::max(kMinInterval, (std::int64_t{memory_mb_} << 20) / frame_bytes);
  Progress progress(video_ + ", backward", end, "frames");
  std::int64_t done = 0;
  for (; end > 0; end = std::max<std::int64_t>(0, end - interval)) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Frame> frames,
                                ReadInterval(std::max<std::int64_t>(0, end - interval), end));
    for (auto frame = frames.rbegin(); frame != frames.rend(); ++frame) {
      if (cancel_.IsCancelled()) return Fail(ErrorCode::kCancelled, "interrupted: nothing was written");
      VICTORIOUS_RETURN_IF_ERROR(visit(*frame));
      progress.Update(++done);
    }
  }
  return {};
}

Expected<std::vector<Frame>> ReverseFrameReader::ReadInterval(
    std::int64_t first, std::int64_t end, const std::function<bool(std::int64_t)>& is_wanted) const {
  const auto indices = std::views::iota(first, end);
  const std::int64_t count = is_wanted ? std::ranges::count_if(indices, is_wanted) : end - first;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto entered, OpenRereadable(video_));
  if (entered->SeekTo(times_s_[static_cast<std::size_t>(first)])) {
    VICTORIOUS_ASSIGN_OR_RETURN(std::vector<Frame> frames, ReadOn(*entered, first, end, is_wanted));
    if (std::ssize(frames) == count && !entered->has_damage()) return frames;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto whole, OpenRereadable(video_));
  return ReadOn(*whole, first, end, is_wanted);
}

// Reads on and returns the wanted frames whose time stamps are those of [first, end).
Expected<std::vector<Frame>> ReverseFrameReader::ReadOn(VideoReader& reader, std::int64_t first, std::int64_t end,
                                                        const std::function<bool(std::int64_t)>& is_wanted) const {
  FrameLoop loop(reader, cancel_, {});
  std::vector<Frame> frames;
  std::int64_t wanted = first;
  const auto select = [&](Frame frame) -> std::optional<Frame> {
    const auto time_s = [&] { return times_s_[static_cast<std::size_t>(wanted)]; };
    while (wanted < end && time_s() < frame.time_s - kSameTime_s) ++wanted;
    const bool is_inside = wanted < end && time_s() <= frame.time_s + kSameTime_s;
    if (is_inside) frame.index = wanted++;
    if (wanted == end) loop.Stop();
    const bool is_kept = is_inside && (!is_wanted || is_wanted(frame.index));
    return is_kept ? std::optional(std::move(frame)) : std::nullopt;
  };
  const auto collect = [&](Frame& frame) -> Status {
    frames.push_back(std::move(frame));
    return {};
  };
  VICTORIOUS_ASSIGN_OR_RETURN(const FrameLoopEnd how, loop.Run<Frame>(select, {InOrder<Frame>(collect)}));
  if (how == FrameLoopEnd::kCancelled) return Fail(ErrorCode::kCancelled, "interrupted: nothing was written");
  return frames;
}

}  // namespace victorious
