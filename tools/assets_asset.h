// From parts to a textured model. Each part is seen along the six axes; every view becomes a chart of one atlas, of one
// scale. A part's paint gives the colour at each place of its surface in space, so that patterns run on over the
// charts' borders; then lines, signs and stains are drawn on the charts; then weather, and the light that the
// neighbouring parts leave over.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "tools/assets_mesh.h"
#include "tools/assets_paint.h"
#include "victorious/base/error.h"

namespace victorious::assets {

struct Part {
  std::string name;
  Mesh mesh;
  Paint paint;
  float density = 1;         ///< texels a metre, in units of the model's own
  bool share_sides = false;  ///< left and right, front and back, wear the same chart
  float weather = 1;         ///< how much of it shows here
  float crease_deg = 38;
  std::vector<Eigen::Affine3f> places = {Eigen::Affine3f::Identity()};  ///< the same thing, several times
};

/// One chart's view of one part.
struct Chart {
  int part = 0;
  Side side = Side::kTop;
  cv::Point2f least;     ///< of the part's extent in the chart's own right and down, m
  cv::Point2f greatest;  ///< m
  float texels_per_m = 0;
  cv::Rect place;  ///< on the atlas, with its margin
};

/// What decorators draw on: each chart in its part's metres, as `Stencil` explains.
class Canvas {
 public:
  Canvas(const std::vector<Part>& parts, const std::vector<Chart>& charts, const cv::Mat& colour, const cv::Mat& shade)
      : parts_(parts), charts_(charts), colour_(colour), shade_(shade) {}

  /// Draws in colours of its own, over the paint.
  [[nodiscard]] Stencil Colour(std::string_view part, Side side) const { return On(colour_, part, side); }
  /// Draws in greys that make the paint below darker or lighter; kPlainShade leaves it.
  [[nodiscard]] Stencil Shade(std::string_view part, Side side) const { return On(shade_, part, side); }

 private:
  [[nodiscard]] Stencil On(const cv::Mat& picture, std::string_view part, Side side) const;

  const std::vector<Part>& parts_;
  const std::vector<Chart>& charts_;
  cv::Mat colour_;
  cv::Mat shade_;
};

struct Asset {
  std::string name;
  std::vector<Part> parts;
  std::function<void(const Canvas&)> decorate;
  Weather weather;
  float length_m = 0;  ///< scaled to this extent along z; 0: as built
  int atlas_px = 1024;
  int jpeg_quality = 84;
  float corner_shadow = 0.6F;  ///< how dark the places become that see no sky: 0 not at all, 1 black
  bool centred = true;         ///< the origin is put on the ground under the middle of the bounding box

  Part& Add(std::string part_name, Mesh mesh, Paint paint);
};

/// A mesh with its texture, as it is written.
struct Finished {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  std::vector<Eigen::Vector2f> uvs;
  std::vector<std::uint32_t> indices;
  cv::Mat texture;  ///< BGR
  int jpeg_quality = 84;
};

/// Unwraps, paints and shades. Takes a second or two.
Finished Finish(const Asset& asset);

/// The model as one GLB 2.0 file: one mesh, one material, its texture inside as JPEG.
Expected<std::string> GlbBytes(const std::string& name, const Finished& model);

}  // namespace victorious::assets
