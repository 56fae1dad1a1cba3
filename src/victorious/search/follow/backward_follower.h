// Follows objects backward in time from the frame of their first detection. A full-frame search comes only every few
// frames and misses an object that is small, turned away or half outside the frame; once it is found, the frames before
// are searched in its region only, as Follower does it in the frames behind.
//
// The last frames are held until later ones can no longer add to them:
//
//   frame t: Follower -> objects; those that start a track are followed to t - 1, t - 2, ... until they are lost, meet
//   an object that is known there, or reach the oldest held frame.
//
// All tracks restart at fixed frames (follower.h), and nothing is followed backward across a restart: what is stored
// does not depend on where an index was interrupted.
#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/search/follow/follower.h"
#include "victorious/types/frame.h"
#include "victorious/types/frame_conditions.h"

namespace victorious {

/// A frame that was followed, and the objects known in it.
struct FollowedFrame {
  Frame frame;  ///< without impulse noise, where it is followed
  FrameConditions conditions;
  std::vector<ObservedObject> objects;
};

/// The number of frames to hold: options.backward_frames, and less if the images would take more than 64 MB; at least 1
/// unless it is 0. @param frame_bytes  of one image
[[nodiscard]] std::size_t HeldFrameCount(const FollowOptions& options, std::size_t frame_bytes);

/// Follows the objects of `now` that start a track back through `before`, and adds what is found there to the objects
/// of those frames, under the same track ids. Deterministic.
/// @param features  of the full-frame search of `now`
/// @param before    the frames before `now`, the nearest first, without gaps
/// Errors: those of feature extraction.
[[nodiscard]] Status FollowBackward(const Recognizer& recognizer, const FeatureExtractor& extractor,
                                    const FollowOptions& options, const FollowedFrame& now, const FeatureSet& features,
                                    std::span<FollowedFrame* const> before, const ShapeSearch* shapes = nullptr);

}  // namespace victorious
