#include "victorious/search/follow/backward_follower.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

namespace victorious {

std::size_t HeldFrameCount(const FollowOptions& options, std::size_t frame_bytes) {
  constexpr std::size_t kMaxBytes = 64'000'000;
  if (options.backward_frames <= 0) return 0;
  const std::size_t fitting = std::max<std::size_t>(1, kMaxBytes / std::max<std::size_t>(1, frame_bytes));
  return std::min(static_cast<std::size_t>(options.backward_frames), fitting);
}

Status FollowBackward(const Recognizer& recognizer, const FeatureExtractor& extractor, const FollowOptions& options,
                      const FollowedFrame& now, const FeatureSet& features, std::span<FollowedFrame* const> before,
                      const ShapeSearch* shapes) {
  std::vector<Detection> started;
  std::vector<std::int64_t> tracks;  // of the detections
  for (const ObservedObject& object : now.objects) {
    if (!object.starts_track) continue;
    started.push_back(object.detection);
    tracks.push_back(object.track.value());
  }
  if (started.empty() || before.empty()) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(Follower follower,
                              Follower::Create(recognizer, extractor, options, FrameOrder::kBackward));
  if (shapes != nullptr) follower.SearchByShape(*shapes);
  std::map<std::int64_t, std::int64_t> track_of;  // by the track of `follower`
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObservedObject> at_start,
                              follower.Follow(now.frame, FullFrameResult{features, started}, now.conditions));
  for (std::size_t i = 0; i < started.size(); ++i) {
    if (at_start[i].track) track_of[*at_start[i].track] = tracks[i];
  }
  for (FollowedFrame* const past : before) {
    if (!follower.HasTracks()) break;
    VICTORIOUS_ASSIGN_OR_RETURN(std::vector<ObservedObject> found,
                                follower.Follow(past->frame, std::nullopt, past->conditions));
    for (ObservedObject& one : found) {
      const auto is_known = [&](const ObservedObject& other) { return AreOneObject(one, other); };
      if (std::ranges::any_of(past->objects, is_known)) {
        follower.Stop(*one.track);
        continue;
      }
      one.track = track_of.at(*one.track);
      past->objects.push_back(std::move(one));
    }
  }
  return {};
}

}  // namespace victorious
