// tools/: from parts to a textured model. Each part is projected along the six axes; each view becomes a chart of one
// texture atlas with one scale. A part's paint gives the colour as a function of the 3D surface position, so patterns
// continue across chart borders. Then lines, signs and stains are drawn on the charts; last come weathering and ambient
// occlusion.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "assets/make/mesh.h"
#include "assets/make/paint.h"
#include "victorious/base/error.h"

namespace victorious::assets {

struct Part {
  std::string name;
  Mesh mesh;
  Paint paint;
  float density = 1;         ///< texels per metre, relative to the model's
  bool share_sides = false;  ///< left and right, front and back use the same chart
  float weather = 1;         ///< strength of the weathering on this part
  float crease_deg = 38;
  std::vector<Eigen::Affine3f> places = {Eigen::Affine3f::Identity()};  ///< one instance of the part per pose
};

/// A chart: one of six views of one part.
struct Chart {
  int part = 0;
  Side side = Side::kTop;
  cv::Point2f min_corner;  ///< minimum of the part's extent along the chart's right and down axes, m
  cv::Point2f max_corner;  ///< maximum of the same, m
  float texels_per_m = 0;
  cv::Rect place;  ///< on the atlas, margin included
};

/// The drawing surface of decorators: each chart in metres of its part, as described at `Stencil`.
class Canvas {
 public:
  Canvas(const std::vector<Part>& parts, const std::vector<Chart>& charts, const cv::Mat& colour, const cv::Mat& shade)
      : parts_(parts), charts_(charts), colour_(colour), shade_(shade) {}

  /// Draws opaque colours over the paint.
  [[nodiscard]] Stencil Colour(std::string_view part, Side side) const { return On(colour_, part, side); }
  /// Draws greys that darken or lighten the paint below; kPlainShade does not change it.
  [[nodiscard]] Stencil Shade(std::string_view part, Side side) const { return On(shade_, part, side); }

 private:
  [[nodiscard]] Stencil On(const cv::Mat& image, std::string_view part, Side side) const;

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
  float length_m = 0;  ///< the model is scaled to this extent along z; 0: not scaled
  int atlas_px = 1024;
  int jpeg_quality = 84;
  float corner_shadow = 0.6F;  ///< strength of the ambient occlusion, 0 to 1
  bool centred = true;         ///< moves the origin to the ground below the centre of the bounding box

  Part& Add(std::string part_name, Mesh mesh, Paint paint);
};

/// A textured mesh, ready to be written.
struct TexturedMesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  std::vector<Eigen::Vector2f> uvs;
  std::vector<std::uint32_t> indices;
  cv::Mat texture;  ///< BGR
  int jpeg_quality = 84;
};

/// Unwraps, paints and shades an asset. Cost: one to two seconds.
TexturedMesh BuildTexturedMesh(const Asset& asset);

/// The model as one GLB 2.0 file: one mesh, one material, the texture embedded as JPEG.
[[nodiscard]] Expected<std::string> GlbBytes(const std::string& name, const TexturedMesh& model);

}  // namespace victorious::assets
