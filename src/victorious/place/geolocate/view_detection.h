// The probability that an object which stands at a place would have been found, from the views that a flight had of the
// place. Input: directions and sizes. Used by ground_views.h for each cell of the ground.
//
// One view finds an object of apparent size s, its diagonal in pixels, at a distance b from the edge of the frame, with
//   p(s, b) = min(1, b / (border_fraction s)) / (1 + (half_size_px / s)^slope)
// Frames of nearly the same view find the same objects: what hides or spoils one of them does so in the next. They
// count as one view, with the largest size and the largest distance from the edge. Views of other directions or sizes
// are independent, and
//   P = ceiling (1 - (1 - p_1) (1 - p_2) ...)
// with a ceiling below 1 for what no view helps against: roofs and trees, and models that are hard to find.
//
// Limits. Blur, noise and light are those of the flights that the parameters were measured in
// (docs/adr/0044-probability-of-detection.md): a worse image finds less. That buildings hide a place, and that models
// differ in more than their size, is in the ceiling only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/options.h"

namespace victorious {

struct ViewDetectionOptions {
  double half_size_px = 48;
  double slope = 5;
  double ceiling = 0.92;
  double border_fraction = 0.15;
  double view_angle_deg = 15;
  double view_size_ratio = 1.5;

  void ListFields(FieldList& fields);
};

/// What a frame shows of a place.
struct PlaceView {
  Eigen::Vector3f to_camera = Eigen::Vector3f::UnitZ();  ///< unit vector, east, north, up
  float px_per_m = 0;                                    ///< of the image, across the line of sight, at the place
  float border_px = 0;                                   ///< from the place to the nearest edge of the frame
};

/// The probability of one view. @param diagonal_m  of the object
[[nodiscard]] double FindProbability(const ViewDetectionOptions& options, const PlaceView& view, double diagonal_m);

/// The independent views of a place.
class PlaceViews {
 public:
  /// Counts a view as independent, or as nearly the same as one of the present: the larger size and border of both
  /// stay. Of more than 24 the smallest is dropped.
  void Add(const ViewDetectionOptions& options, const PlaceView& view);

  [[nodiscard]] std::span<const PlaceView> views() const { return views_; }
  [[nodiscard]] std::uint16_t looks() const { return looks_; }
  /// The one of the largest size; null without any.
  [[nodiscard]] const PlaceView* Nearest() const;

 private:
  std::vector<PlaceView> views_;
  std::uint16_t looks_ = 0;
};

/// That of all of them, P above; 0 without views.
[[nodiscard]] double FindProbability(const ViewDetectionOptions& options, std::span<const PlaceView> views,
                                     double diagonal_m);

}  // namespace victorious
