// An object followed from frame to frame.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/geometry/similarity.h"

namespace victorious {

/// A place on an object that is followed.
struct TrackPoint {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< px in the frame
  std::optional<std::uint32_t> feature;             ///< the template's keypoint that was matched there
};

enum class TrackState {
  kActive,    ///< expected in the next frame
  kInactive,  ///< given up: only a recogniser takes it up again
};

/// Why a track gave no box in a frame, or ended.
enum class TrackLoss {
  kNone,
  kLostPoints,   ///< too few of its points were found again, and nothing is seen where it was
  kLeftFrame,    ///< its outline lies mostly beyond the frame
  kOccluded,     ///< too few of its points were found again, and something else is seen where it was
  kUnconfirmed,  ///< no recogniser has confirmed it for too many frames
};

/// What became of one track in one frame.
struct TrackStep {
  std::uint64_t track = 0;  ///< its number, from 1, never used again
  std::int64_t frame = 0;   ///< from 0
  double time_s = 0;        ///< since the video's first frame
  TrackState state = TrackState::kActive;
  TrackLoss loss = TrackLoss::kNone;  ///< kNone exactly if it is seen in this frame
  /// Of the object, px; may leave the frame. Where it is not seen: where its motion would have it.
  Polygon outline;
  Box box;                         ///< of the outline clipped to the frame, px; empty where it is not seen
  Box search_box;                  ///< where a recogniser should look for it, px, inside the frame; empty: nowhere
  Similarity2 now_from_template;   ///< from the frame of the template to this one
  std::vector<TrackPoint> points;  ///< that were found again and move with the object; none where it is not seen
  double support = 0;              ///< the share of the template's points that these are, 0 to 1
  int unconfirmed_frames = 0;      ///< since the template was made

  [[nodiscard]] bool seen() const { return loss == TrackLoss::kNone; }
};

}  // namespace victorious
