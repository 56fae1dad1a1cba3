#include "experiments/video_frames.h"

#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace victorious {

std::vector<std::int64_t> EvenlySpaced(std::int64_t frames, int max_count) {
  std::vector<std::int64_t> numbers;
  for (std::int64_t i = 0; i < max_count; ++i) {
    const std::int64_t number = (2 * i + 1) * frames / (2 * max_count);
    if (number < frames && (numbers.empty() || number != numbers.back())) numbers.push_back(number);
  }
  return numbers;
}

Expected<std::int64_t> CountFrames(const std::filesystem::path& video) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(video.string(), {}));
  std::int64_t count = 0;
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Frame> frame, reader->NextFrame());
    if (!frame) break;
    ++count;
  }
  if (count == 0) return Fail(ErrorCode::kDataLoss, fmt::format("{}: no frame can be decoded", video.string()));
  return count;
}

Expected<std::vector<Frame>> ReadNumberedFrames(const std::filesystem::path& video,
                                                std::span<const std::int64_t> numbers, FrameColor color) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(video.string(), {.color = color}));
  std::vector<Frame> frames;
  while (frames.size() < numbers.size()) {
    VICTORIOUS_ASSIGN_OR_RETURN(std::optional<Frame> frame, reader->NextFrame());
    if (!frame) break;
    if (frame->index == numbers[frames.size()]) frames.push_back(*std::move(frame));
  }
  return frames;
}

}  // namespace victorious
