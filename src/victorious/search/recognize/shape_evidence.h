// Private to recognize/, for ShapeSearch: what speaks for a match by shape where the camera's attitude and height are
// known (docs/adr/0047). The templates of 96 px that propose a match do not separate a vehicle from another make of the
// same length. What does: the response of larger templates; an image edge at the points of the model's contours, once
// the pose is refined on the edges; and that the refined pose stays where the camera puts it, because a model that fits
// something else does so turned, or at another distance. Lines painted on the ground have edges as a body has, but the
// same grey level on both sides.
#pragma once

namespace victorious {

struct ShapeEvidence {
  double response = 0;         ///< mean of those of templates of rising size
  double contour_mean = 0;     ///< decades a point of the contours, at the refined pose (ContourEvidence)
  double distance_change = 0;  ///< logarithm of the refined distance over that of the camera
  double step = 0;             ///< ContourEvidence::step at the refined pose
  double turn_rad = 0;         ///< from the pose by the camera and the heading searched to the refined one
};

/// The linear discriminant between vehicles and what is taken for them.
[[nodiscard]] double ScoreOf(const ShapeEvidence& evidence);

/// Decades, of one frame and model.
[[nodiscard]] double NegLog10NfaOf(const ShapeEvidence& evidence);

}  // namespace victorious
