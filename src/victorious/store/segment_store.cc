#include "victorious/store/segment_store.h"

namespace victorious {

std::optional<std::int64_t> MiddleOf(FrameInterval frames, std::int64_t step) {
  const std::int64_t steps = (frames.size() + step - 1) / step;
  if (steps < 2 || frames.size() <= kMinSegmentFrames) return std::nullopt;
  return frames.from + (steps + 1) / 2 * step;
}

}  // namespace victorious
