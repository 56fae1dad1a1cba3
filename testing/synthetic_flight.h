// A flight over a drawn town with exact truth: things lie and move on the ground, the camera passes, turns, climbs, and
// comes back another way. For tests of whole chains. The same options give the same pixels, whatever the
// number of threads.
//
// Frames: thing (its picture, px), ground (the town's picture, px), frame (px); first pixel's centre at (0.5, 0.5).
// The camera's middle goes out and back along a line of `path_widths` frame widths on the ground, once in the whole
// flight. Things lie along that line in their order: the first is in view at the start and again at the end, later ones
// come, go and come back, and a camera far out sees none of the first.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "testing/drawn_things.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/geometry/similarity.h"
#include "victorious/types/frame.h"

namespace victorious::testing {

struct FlightOptions {
  std::uint64_t seed = 1;
  int frames = 120;
  double fps = 10.0;         ///< frames/s
  int width = 640;           ///< px
  int height = 480;          ///< px
  int things = 2;            ///< 0 to 8, of the kinds of drawn_things.h in turn
  double thing_scale = 1.0;  ///< ground px per px of a thing's picture, about which it swells and shrinks by a tenth
  double zoom = 0.8;         ///< frame px per ground px, about which the camera climbs and sinks by a fifth
  double path_widths = 1.5;  ///< how far out the camera goes, in frame widths; 0 stays where it is
  double blur_px = 0.4;      ///< sigma of the lens; 0: none
  double noise = 2.0;        ///< standard deviation of the sensor, grey levels
};

/// What is true of one thing in one frame.
struct TruthRow {
  int thing = 0;           ///< index
  std::int64_t frame = 0;  ///< from 0
  double time_s = 0;
  std::string object;  ///< "crate-1"
  std::string model;   ///< "crate"
  Polygon outline;     ///< whole, px in the frame: may leave it, and may be hidden in part
  Box box;             ///< of the visible pixels, px
  double visible = 0;  ///< visible pixels over those it would have unhidden and uncropped
  int pixels = 0;      ///< visible ones
};

class SyntheticFlight {
 public:
  explicit SyntheticFlight(const FlightOptions& options);

  /// Frame `index` of 0 to options.frames - 1; CV_8UC3.
  [[nodiscard]] Frame Render(int index) const;

  /// Every thing with a pixel in view, in order of the things.
  [[nodiscard]] std::vector<TruthRow> Truth(int index) const;

  /// The thing as drawn, BGRA with alpha: the photo to search by.
  [[nodiscard]] cv::Mat ThingPhoto(int thing) const;
  /// "crate", "truck", "sign", "aircraft", "crate2", ...
  [[nodiscard]] std::string ThingName(int thing) const;

  [[nodiscard]] Eigen::Matrix3d FrameFromThing(int thing, int index) const;
  [[nodiscard]] Eigen::Matrix3d FrameFromGround(int index) const;
  [[nodiscard]] const FlightOptions& options() const { return options_; }

 private:
  /// A flat picture that is laid into the frame: halved again and again, colours premultiplied by alpha.
  using Pyramid = std::vector<cv::Mat>;

  /// How a thing lies and moves on the ground.
  struct Course {
    Eigen::Vector2d base;   ///< ground px
    Eigen::Vector2d swing;  ///< ground px, from base to either end of its way
    double phase_rad = 0;
    double heading_rad = 0;  ///< at the start
    double turn_rad = 0;     ///< over the whole flight
  };

  struct Thing {
    DrawnThing drawn;
    std::string name;
    Pyramid pyramid;
    Pyramid shadow;
    Course course;
  };

  [[nodiscard]] double Phase(int index) const;
  [[nodiscard]] Similarity2 GroundFromThing(const Thing& thing, int index) const;
  [[nodiscard]] cv::Mat CoverOf(int thing, int index, const cv::Rect& region) const;
  void PlaceThings();

  FlightOptions options_;
  Eigen::Vector2d start_;  ///< of the camera's way, ground px
  double reach_px_ = 0;    ///< length of its way, ground px
  double heading_rad_ = 0;
  double climb_phase_rad_ = 0;
  Pyramid ground_;
  std::vector<Thing> things_;
};

}  // namespace victorious::testing
