#include "victorious/pipeline/shape_background.h"

#include <iterator>
#include <utility>

#include "victorious/image/impulse_noise.h"
#include "victorious/recognize/shape_search.h"
#include "victorious/video/video_reader.h"

namespace victorious {

Expected<std::vector<GradientCells>> ReadBackground(const std::string& video, double duration_s,
                                                    double impulse_fraction, const CancelToken& cancel) {
  constexpr int kFrames = 4;
  std::vector<GradientCells> cells;
  for (int i = 0; i < kFrames; ++i) {
    if (cancel.IsCancelled()) return Fail(ErrorCode::kCancelled, video + ": cancelled");
    auto reader = VideoReader::Open(video, {.color = FrameColor::kGrey, .threads = 1});
    if (!reader) return cells;
    const double time_s = (i + 0.5) / kFrames * duration_s;
    (*reader)->SeekTo(time_s);  // if it cannot, the frames are read from the beginning
    while (!cancel.IsCancelled()) {
      const Expected<std::optional<Frame>> frame = (*reader)->NextFrame();
      if (!frame || !*frame) break;
      if ((*frame)->time_s < time_s) continue;
      std::vector<GradientCells> of_frame = BackgroundCells(RemoveImpulses((*frame)->image, impulse_fraction));
      std::ranges::move(of_frame, std::back_inserter(cells));
      break;
    }
  }
  return cells;
}

}  // namespace victorious
