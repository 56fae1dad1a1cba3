#include "victorious/pipeline/shape_background.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "victorious/image/impulse_noise.h"
#include "victorious/recognize/shape_search.h"
#include "victorious/video/video_reader.h"

namespace victorious {

Expected<std::vector<GradientCells>> ReadBackground(const std::string& video, double duration_s,
                                                    double impulse_fraction, const CancelToken& cancel) {
  constexpr int kFrames = 4;
  std::vector<GradientCells> cells;
  auto reader = VideoReader::Open(video, {.color = FrameColor::kGrey, .threads = 1});
  if (!reader) return cells;
  bool seeks = duration_s > 0;
  std::optional<double> last_s;
  for (int i = 0; i < kFrames; ++i) {
    const double time_s = (i + 0.5) / kFrames * duration_s;
    if (seeks) seeks = (*reader)->SeekTo(time_s);
    while (true) {
      if (cancel.IsCancelled()) return Fail(ErrorCode::kCancelled, video + ": cancelled");
      const Expected<std::optional<Frame>> frame = (*reader)->NextFrame();
      if (!frame || !*frame) return cells;
      if (last_s && (*frame)->time_s <= *last_s) {  // no key frame since: from here on decoding is faster
        seeks = false;
        continue;
      }
      if ((*frame)->time_s < time_s) continue;
      last_s = (*frame)->time_s;
      std::vector<GradientCells> of_frame = BackgroundCells(RemoveImpulses((*frame)->image, impulse_fraction));
      std::ranges::move(of_frame, std::back_inserter(cells));
      break;
    }
  }
  return cells;
}

}  // namespace victorious
