// The output of a tracker: the state of each tracked object in each frame. Made by track/, read by jobs/.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/geometry/similarity.h"

namespace victorious {

/// A tracked point on an object.
struct TrackPoint {
  Eigen::Vector2d position_px = Eigen::Vector2d::Zero();  ///< in the frame
  std::optional<std::uint32_t>
      inlier;  ///< index of the inlier (PlanarFit::inliers) that it was made from; nullopt: none
};

enum class TrackState {
  kActive,    ///< expected in the next frame
  kInactive,  ///< lost: only a new recognition reactivates it
};

/// Why a track has no box in a frame, or ended.
enum class TrackLoss {
  kNone,
  kLostPoints,   ///< too few points were tracked, and no other object is visible at the predicted position
  kLeftFrame,    ///< the outline lies mostly outside the frame
  kOccluded,     ///< too few points were tracked, and something else is visible at the predicted position
  kUnconfirmed,  ///< no recognition confirmed the track for too many frames
};

/// The state of one track in one frame.
struct TrackStep {
  std::uint64_t track = 0;  ///< track number, from 1, never reused
  std::int64_t frame = 0;   ///< from 0
  double time_s = 0;        ///< since the video's first frame
  TrackState state = TrackState::kActive;
  TrackLoss loss = TrackLoss::kNone;  ///< kNone if and only if the object is tracked in this frame
  /// Of the object, px; may leave the frame. Predicted by its motion if the object is not tracked.
  Polygon outline;
  Box box;                         ///< bounding box of the outline clipped to the frame, px; empty if not tracked
  Box search_box;                  ///< region of interest for recognition, px, inside the frame; empty: none
  Similarity2 now_from_template;   ///< from the template's frame to this frame, px
  std::vector<TrackPoint> points;  ///< tracked points that move with the object; empty if it is not tracked
  double support = 0;              ///< fraction of the template's points that `points` holds, 0 to 1
  int unconfirmed_frames = 0;      ///< frames since the template was made

  [[nodiscard]] bool seen() const { return loss == TrackLoss::kNone; }
};

}  // namespace victorious
