#include "victorious/search/follow/looks_before.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/search/follow/image_motion.h"

namespace victorious {
namespace {

// Every visible track is searched for in every frame that is looked at.
FollowOptions OptionsOfLooks(FollowOptions options) {
  options.min_recognised_frames = 0;
  options.search_interval_s = 0;
  return options;
}

bool IsWhole(const Polygon& outline, const Box& frame) {
  return std::ranges::all_of(outline,
                             [&](const Eigen::Vector2d& corner) { return frame.Contains(corner.x(), corner.y()); });
}

Polygon Moved(Polygon outline, const Similarity2& motion) {
  for (Eigen::Vector2d& corner : outline) corner = motion.Apply(corner);
  return outline;
}

// True if the frame before shows the same object already, or another model there with more evidence: what looks
// somewhat like the true model does so in all frames.
bool IsExplained(const Detection& detection, const FrameBefore& last) {
  constexpr double kMinOverlap = 0.3;
  const Similarity2 now_from_then = last.then_from_now.Inverse();
  return std::ranges::any_of(last.seen->objects, [&](const ObservedObject& object) {
    const Detection& known = object.detection;
    return (known.model_index == detection.model_index || known.neg_log10_nfa >= detection.neg_log10_nfa) &&
           IntersectionOverUnion(BoundingBox(Moved(known.outline, now_from_then)), detection.box) >= kMinOverlap;
  });
}

}  // namespace

Expected<std::vector<LooksBefore>> LookBefore(const Recognizer& recognizer, const FeatureExtractor& extractor,
                                              const FollowOptions& options, const FollowedFrame& now,
                                              const FeatureSet& features, std::span<const Detection> detections,
                                              std::span<const FrameBefore> before, const ShapeSearch& shapes) {
  std::vector<LooksBefore> found(detections.size());
  if (detections.empty() || before.empty()) return found;
  VICTORIOUS_ASSIGN_OR_RETURN(Follower follower,
                              Follower::Create(recognizer, extractor, OptionsOfLooks(options), FrameOrder::kBackward));
  follower.SearchByShape(shapes);
  std::vector<Detection> started;
  std::vector<std::size_t> numbers;  // of the detections
  for (std::size_t i = 0; i < detections.size(); ++i) {
    if (IsExplained(detections[i], before.front())) {
      found[i].is_explained = true;
      continue;
    }
    started.push_back(detections[i]);
    numbers.push_back(i);
  }
  if (started.empty()) return found;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObservedObject> at_start,
                              follower.Follow(now.frame, FullFrameResult{features, started}, now.conditions));
  const cv::Size size = now.frame.image.size();
  const Box frame_box = FrameBox(size.width, size.height);
  Similarity2 last_from_now;
  int looks = 0;
  for (const FrameBefore& past : before) {
    if (looks == kMaxLooksBefore || !follower.HasTracks()) break;
    if (FractionMoved(past.then_from_now * last_from_now.Inverse(), size) < kMotionBetweenLooks) continue;
    last_from_now = past.then_from_now;
    ++looks;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObservedObject> seen,
                                follower.Follow(past.seen->frame, std::nullopt, past.seen->conditions));
    for (std::size_t i = 0; i < started.size(); ++i) {
      const std::optional<std::int64_t> track = at_start[i].track;
      if (!track || !follower.IsFollowed(*track)) continue;
      const auto again = std::ranges::find(seen, track, &ObservedObject::track);
      const bool is_seen = again != seen.end();
      const Polygon outline = is_seen ? again->detection.outline : Moved(started[i].outline, past.then_from_now);
      if (!IsWhole(outline, frame_box)) continue;
      const bool is_found = is_seen && !again->tracked();
      LooksBefore& of_one = found[numbers[i]];
      of_one.looks += 1;
      of_one.sum += is_found ? again->detection.neg_log10_nfa : kDecadesWhereMissed;
    }
  }
  return found;
}

Expected<std::vector<ShapeMatch>> FindFurtherOn(const Recognizer& recognizer, const FeatureExtractor& extractor,
                                                FollowOptions options, const FollowedFrame& then,
                                                const FullFrameResult& earlier,
                                                std::span<const FollowedFrame* const> since,
                                                const ShapeSearch& shapes) {
  constexpr double kSearchInterval_s = 0.3;  // often enough for the heading to be known
  options.min_recognised_frames = 1;
  options.search_interval_s = kSearchInterval_s;
  VICTORIOUS_ASSIGN_OR_RETURN(Follower follower, Follower::Create(recognizer, extractor, options));
  follower.SearchByShape(shapes);
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<ObservedObject> seen, follower.Follow(then.frame, earlier, then.conditions));
  for (const FollowedFrame* next : since) {
    if (!follower.HasTracks()) return std::vector<ShapeMatch>{};
    VICTORIOUS_ASSIGN_OR_RETURN(seen, follower.Follow(next->frame, std::nullopt, next->conditions));
  }
  const FollowedFrame& now = *since.back();
  std::vector<ShapeMatch> found;
  for (const ObservedObject& one : seen) {
    VICTORIOUS_ASSIGN_OR_RETURN(std::optional<ShapeMatch> match,
                                shapes.FindAgain(now.frame.image, now.conditions, one.detection, {0, 0}));
    if (!match || !match->is_examined) continue;
    match->neg_log10_nfa -= kDecadesOfOnePlace;
    found.push_back(*match);
  }
  return found;
}

}  // namespace victorious
