#include "experiments/steady_lock.h"

#include <utility>

#include "victorious/input/image/impulse_noise.h"
#include "victorious/input/video/frame_loop.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/search/follow/region_features.h"
#include "victorious/track/region_tracker.h"

namespace victorious {
namespace {

/// A detection with the features that it indexes.
struct Found {
  Detection detection;
  FeatureSet scene;
};

/// Searches a region of the frame; results are in frame coordinates.
Expected<std::optional<Found>> Search(const cv::Mat& grey, const Box& region, const Recognizer& recognizer,
                                      const FeatureExtractor& extractor) {
  VICTORIOUS_ASSIGN_OR_RETURN(FeatureSet scene, FeaturesIn(grey, region, extractor));
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<Detection> detections, recognizer.Recognize(scene));
  if (detections.empty()) return std::nullopt;
  return Found{std::move(detections.front()), std::move(scene)};
}

/// A tracker whose template is the recogniser's last detection.
class RecognizerAidedTracker {
 public:
  RecognizerAidedTracker(RegionTracker tracker, const Recognizer& recognizer, const FeatureExtractor& extractor)
      : tracker_(std::move(tracker)), recognizer_(&recognizer), extractor_(&extractor) {}

  Expected<std::optional<Polygon>> ProcessFrame(const Frame& frame) {
    std::optional<TrackStep> step;
    if (const auto steps = tracker_.Step(frame); !steps.empty()) step = steps.front();
    const bool active = step && step->state == TrackState::kActive;
    const Box whole = FrameBox(frame.image.cols, frame.image.rows);
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Found> found,
                                Search(frame.image, active ? step->search_box : whole, *recognizer_, *extractor_));
    if (!found) return active && step->seen() ? std::optional(step->outline) : std::nullopt;
    const std::vector<TrackPoint> points = MatchedPoints(found->detection, found->scene);
    if (active) {
      tracker_.Confirm(step->track, found->detection.outline, points);
    } else {
      tracker_.Start(found->detection.outline, points);
    }
    last_points_ = points;
    return found->detection.outline;
  }

  /// Points of the last detection.
  [[nodiscard]] const std::vector<TrackPoint>& last_points() const { return last_points_; }

 private:
  RegionTracker tracker_;
  const Recognizer* recognizer_;
  const FeatureExtractor* extractor_;
  std::vector<TrackPoint> last_points_;
};

}  // namespace

Expected<std::vector<TrackingComparisonStep>> CompareTracking(VideoReader& reader, const Recognizer& recognizer,
                                                              const FeatureExtractor& extractor,
                                                              const TrackOptions& options, const CancelToken& cancel) {
  TrackOptions tracker_only_options = options;
  tracker_only_options.min_ncc = -1;
  tracker_only_options.unconfirmed_frames = 1'000'000;
  VICTORIOUS_ASSIGN_OR_RETURN(RegionTracker alone, RegionTracker::Create(tracker_only_options));
  VICTORIOUS_ASSIGN_OR_RETURN(RegionTracker guarded, RegionTracker::Create(options));
  RecognizerAidedTracker together(std::move(guarded), recognizer, extractor);
  std::vector<TrackingComparisonStep> steps;
  FrameLoop loop(reader, cancel, {});
  const auto process = [&](Frame& frame) -> Status {
    frame.image = RemoveImpulses(frame.image, FeatureOptions().impulse_fraction);
    TrackingComparisonStep step{
        .frame = frame.index, .time_s = frame.time_s, .alone = std::nullopt, .together = std::nullopt};
    for (const TrackStep& one : alone.Step(frame)) {
      if (one.seen()) step.alone = one.outline;
    }
    VICTORIOUS_ASSIGN_OR_RETURN(step.together, together.ProcessFrame(frame));
    if (steps.empty()) {
      if (!step.together) return {};
      alone.Start(*step.together, together.last_points());
      step.alone = step.together;
    }
    steps.push_back(std::move(step));
    return {};
  };
  VICTORIOUS_ASSIGN_OR_RETURN(const FrameLoopEnd end, loop.ForEach(process));
  if (end == FrameLoopEnd::kCancelled) return Fail(ErrorCode::kCancelled, "interrupted");
  return steps;
}

}  // namespace victorious
