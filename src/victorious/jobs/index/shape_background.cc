#include "victorious/jobs/index/shape_background.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "victorious/input/image/impulse_noise.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/search_scale.h"
#include "victorious/search/recognize/shape_search.h"

namespace victorious {

Expected<std::vector<cv::Mat>> ReadSpreadFrames(const std::string& video, double duration_s, int count,
                                                double impulse_fraction, const CancelToken& cancel) {
  std::vector<cv::Mat> frames;
  auto reader = VideoReader::Open(video, {.color = FrameColor::kGrey, .threads = 1});
  if (!reader) return frames;
  bool seeks = duration_s > 0;
  std::optional<double> last_s;
  for (int i = 0; i < count; ++i) {
    const double time_s = (i + 0.5) / count * duration_s;
    if (seeks) seeks = (*reader)->SeekTo(time_s);
    while (true) {
      if (cancel.IsCancelled()) return Fail(ErrorCode::kCancelled, video + ": cancelled");
      const Expected<std::optional<Frame>> frame = (*reader)->NextFrame();
      if (!frame || !*frame) return frames;
      if (last_s && (*frame)->time_s <= *last_s) {  // no key frame since: from here on decoding is faster
        seeks = false;
        continue;
      }
      if ((*frame)->time_s < time_s) continue;
      last_s = (*frame)->time_s;
      frames.push_back(RemoveImpulses((*frame)->image, impulse_fraction));
      break;
    }
  }
  return frames;
}

std::vector<GradientCells> BackgroundOf(std::span<const cv::Mat> frames) {
  std::vector<GradientCells> cells;
  for (const cv::Mat& frame : frames) std::ranges::move(BackgroundCells(frame), std::back_inserter(cells));
  return cells;
}

Expected<std::optional<CommonView>> EstimateCommonView(const ShapeSearch& shapes, std::span<const cv::Mat> frames,
                                                       const CancelToken& cancel) {
  const cv::Size filmed = frames.front().size();
  const double factor = std::min(1.0, static_cast<double>(kViewSide_px) / std::max(filmed.width, filmed.height));
  const cv::Size searched(static_cast<int>(std::lround(factor * filmed.width)),
                          static_cast<int>(std::lround(factor * filmed.height)));
  std::vector<ShapeMatch> all;
  for (const cv::Mat& frame : frames) {
    if (cancel.IsCancelled()) return Fail(ErrorCode::kCancelled, "cancelled");
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ShapeMatch> matches,
                                shapes.FindInAnyView(ShrinkTo(searched, frame), 0));
    all.insert(all.end(), matches.begin(), matches.end());
  }
  std::optional<CommonView> view = FindCommonView(all, searched);
  if (!view) return view;
  view->pixels_per_m /= factor;
  view->focal_px /= factor;
  return view;
}

}  // namespace victorious
