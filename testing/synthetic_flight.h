// A synthetic flight over a drawn town with exact ground truth, for end-to-end tests. Planar objects lie and
// move on the ground; the camera passes over them, rotates, climbs, and returns. The same options give the same pixels,
// for any number of threads.
//
// Coordinate frames: object (its image, px), ground (the town's image, px), frame (px); the first pixel's centre is at
// (0.5, 0.5). The camera's footprint moves out and back along a line of `path_widths` frame widths on the ground, once
// in the whole flight. The objects lie along that line in their order: the first is in view at the start and at the
// end, later ones enter, leave and return, and the farthest camera positions show none of the first.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "testing/drawn_objects.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/geometry/similarity.h"
#include "victorious/types/frame.h"

namespace victorious::testing {

struct FlightOptions {
  std::uint64_t seed = 1;
  int frames = 120;
  double fps = 10.0;          ///< frames/s
  int width = 640;            ///< px
  int height = 480;           ///< px
  int objects = 2;            ///< 0 to 8, of the kinds of drawn_objects.h in turn
  double object_scale = 1.0;  ///< mean ground px per px of an object's image; varies by 10 %
  double zoom = 0.8;          ///< mean frame px per ground px; varies by 20 % as the camera climbs and descends
  double path_widths = 1.5;   ///< length of the camera path in frame widths; 0: no translation
  double blur_px = 0.4;       ///< sigma of the lens blur; 0: no blur
  double noise = 2.0;         ///< standard deviation of the sensor noise, grey levels
};

/// The ground truth of one object in one frame.
struct TruthRow {
  int object_index = 0;    ///< index
  std::int64_t frame = 0;  ///< from 0
  double time_s = 0;
  std::string object;  ///< "crate-1"
  std::string model;   ///< "crate"
  Polygon outline;     ///< complete outline, frame px; may exceed the frame or be occluded in part
  Box box;             ///< of the visible pixels, px
  double visible = 0;  ///< visible pixels, as a fraction of the pixels without occlusion and cropping
  int pixels = 0;      ///< number of visible pixels
};

class SyntheticFlight {
 public:
  explicit SyntheticFlight(const FlightOptions& options);

  /// Renders frame `index`, 0 to options.frames - 1; CV_8UC3.
  [[nodiscard]] Frame Render(int index) const;

  /// Returns the truth of every object with at least one visible pixel, in order of the objects.
  [[nodiscard]] std::vector<TruthRow> Truth(int index) const;

  /// The object's image, BGRA: the photo for a model.
  [[nodiscard]] cv::Mat ObjectPhoto(int object) const;
  /// "crate", "truck", "sign", "aircraft", "crate2", ...
  [[nodiscard]] std::string ObjectName(int object) const;

  [[nodiscard]] Eigen::Matrix3d FrameFromObject(int object, int index) const;
  [[nodiscard]] Eigen::Matrix3d FrameFromGround(int index) const;
  [[nodiscard]] const FlightOptions& options() const { return options_; }

 private:
  /// An image pyramid for warping into the frame, colours premultiplied by alpha.
  using Pyramid = std::vector<cv::Mat>;

  /// The motion of an object on the ground.
  struct Course {
    Eigen::Vector2d base;   ///< ground px
    Eigen::Vector2d swing;  ///< ground px, amplitude of the motion around base
    double phase_rad = 0;
    double heading_rad = 0;  ///< at the start
    double turn_rad = 0;     ///< over the whole flight
  };

  struct FlightObject {
    SyntheticObject drawn;
    std::string name;
    Pyramid pyramid;
    Pyramid shadow;
    Course course;
  };

  [[nodiscard]] double Phase(int index) const;
  [[nodiscard]] Similarity2 GroundFromObject(const FlightObject& object, int index) const;
  [[nodiscard]] cv::Mat ObjectCoverage(int object, int index, const cv::Rect& region) const;
  void PlaceObjects();

  FlightOptions options_;
  Eigen::Vector2d start_;  ///< start of the camera path, ground px
  double reach_px_ = 0;    ///< length of the camera path, ground px
  double heading_rad_ = 0;
  double climb_phase_rad_ = 0;
  Pyramid ground_;
  std::vector<FlightObject> objects_;
};

}  // namespace victorious::testing
