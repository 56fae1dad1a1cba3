// track/: follows an object that stands still by the motion of what stands around it. In: an outline in a first frame,
// and frames in order. Out: the box of the object in each, and how much its colours still differ from those around it.
// It needs no texture on the object, and sees it from all sides while the camera circles.
//
// Method:
// 1. Place: corners around the object are tracked by Lucas-Kanade from a reference frame (flow.h); MLESAC fits an
//    affine map, which moves the first outline. The reference is renewed once half of its corners are lost, so that
//    errors add up per reference, not per frame. The ellipse inscribed in the moved outline bounds the expected box.
// 2. Box: each pixel has the logarithm of the ratio of its colour's frequencies on the object and around it, clipped.
//    The box near the expected one with the largest sum wins; a quadratic penalty holds its centre and size. So the box
//    follows the object's body, which the motion of the ground does not show. It is then extended as far as the
//    object's colours go on in the turned outline, and the hull of these colours is the outline.
// 3. Contrast: the mean of the logarithms in the box, less that around it, over the same in the first frame.
// 4. Planar parallax: with A the linear part of the ground's motion between two frames, the offset o of the box from
//    the place obeys |o2 - A o1| <= h |I - A| + tolerance if the object stands still; its height in the image, h, is at
//    most that of the box. Else it moves by itself.
//
// The colours of the object are those of the first frame and of the last frames, half each.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/track/flow.h"

namespace victorious {

inline constexpr double kMinContrast = 0.6;  ///< of SurroundStep: below, the object is not seen

/// The object in one frame.
struct SurroundStep {
  Polygon place;    ///< the first outline's rectangle as its surroundings moved it, 4 corners, px; may leave the frame
  Box expected;     ///< px, of the ellipse inscribed in it; may leave the frame
  Box box;          ///< px, by the colours; may leave the frame
  Polygon outline;  ///< px, of what has the object's colours in it: convex
  double contrast = 0;             ///< relative to the first frame: 1 there
  bool moves_over_ground = false;  ///< more than a thing of its height that stands still would seem to
};

/// A frame as trackers need it: made once, shared by all.
struct SurroundFrame {
  cv::Mat bgr;          ///< CV_8UC3
  cv::Mat grey;         ///< CV_8UC1
  FlowPyramid pyramid;  ///< of the grey image, or of a smaller one

  /// @param image  CV_8UC3; shared, not copied
  explicit SurroundFrame(const cv::Mat& image);
};

/// Deterministic. Not thread-safe.
class SurroundTracker {
 public:
  /// @param frame    the first one
  /// @param outline  of the object in it, px; of 4 corners in order, or else its smallest rectangle is taken
  SurroundTracker(const SurroundFrame& frame, const Polygon& outline);

  /// In the first frame. std::nullopt if the object cannot be told from what is around it by its colours.
  [[nodiscard]] const std::optional<SurroundStep>& first() const { return first_; }

  /// Tracks the object into the next frame, in either order of time.
  /// @return std::nullopt if the surroundings are lost, or the object is not in the frame: it cannot be followed
  /// further. Cost: about 2 ms at any size of frame and object.
  std::optional<SurroundStep> Step(const SurroundFrame& frame);

 private:
  // Frequencies of colours, that sum to 1.
  using Colours = std::vector<double>;
  // The surroundings of the object, at most kColourSide_px wide on the object.
  struct Cutout {
    cv::Mat bins;   // CV_32SC1
    cv::Mat radii;  // CV_64FC1: 1 on the inscribed ellipse
    double frame_from_cutout = 1;
    Eigen::Vector2d origin_px;  // in the frame
  };

  // The centre of the box from that of the place, and the place's half axes, as columns.
  struct Offset {
    Eigen::Matrix2d axes;
    Eigen::Vector2d px;
  };

  [[nodiscard]] bool MovesOverGround(const Eigen::Matrix2d& axes, const Eigen::Vector2d& centre, const Box& box);
  [[nodiscard]] static Cutout CutOut(const cv::Mat& bgr, const Polygon& place);
  [[nodiscard]] std::optional<SurroundStep> Measure(const cv::Mat& bgr, const Polygon& place);
  [[nodiscard]] std::optional<Eigen::Matrix3d> MeasureMotion(const FlowPyramid& now) const;
  void SetReference(const FlowPyramid& pyramid, const Polygon& place);

  double small_from_frame_ = 1;  // scale of the pyramids
  std::optional<FlowPyramid> reference_;
  Polygon reference_place_;                                           // frame px
  std::vector<Eigen::Vector2d> corners_;                              // in the reference, px of the pyramid
  Eigen::Matrix3d now_from_reference_ = Eigen::Matrix3d::Identity();  // px of the pyramid
  std::optional<FlowPyramid> last_;
  Polygon last_place_;
  Colours first_colours_;
  Colours recent_colours_;
  double first_contrast_ = 0;
  std::vector<Offset> offsets_;  // in the last frames in which it was seen
  int contradictions_ = 0;       // last frames in a row whose offsets contradict others
  std::optional<SurroundStep> first_;
};

}  // namespace victorious
