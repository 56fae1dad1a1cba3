// tools/: ground textures seen from above: seamless periodic materials, and objects and markings on them. Coordinates
// are metres from the image's top left corner, x to the right, y down.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "assets/make/asset.h"
#include "assets/make/paint.h"
#include "testing/drawing.h"
#include "victorious/base/random.h"

namespace victorious::assets {

/// The colour of a material at a position, m. Periodic with `period_m` (whole metres).
using Material = std::function<Bgr(float x, float y, float period_m)>;

Bgr Asphalt(float x, float y, float period_m);
Bgr NewAsphalt(float x, float y, float period_m);
Bgr Concrete(float x, float y, float period_m);
Bgr Slabs(float x, float y, float period_m);
Bgr Grass(float x, float y, float period_m);
Bgr Meadow(float x, float y, float period_m);
Bgr Gravel(float x, float y, float period_m);
Bgr Brick(float x, float y, float period_m);
Bgr Dirt(float x, float y, float period_m);

/// A square of ground to draw on.
class Ground {
 public:
  /// @param wraps  drawings that cross a border continue at the opposite border
  Ground(float side_m, int side_px, const Material& base, std::uint64_t seed, bool wraps);

  [[nodiscard]] const cv::Mat& image() const { return image_; }
  [[nodiscard]] float side_m() const { return side_m_; }
  Random& random() { return random_; }

  /// Fills an outline, m, with another material.
  void Lay(const Material& material, const std::vector<cv::Point2d>& outline);
  void LayBox(const Material& material, double x0, double y0, double x1, double y1);
  void LayDisc(const Material& material, double x, double y, double radius);

  /// Calls `draw` with a pencil in metres: once, or also once for each border that the drawing may cross.
  void Draw(const std::function<void(testing::Pencil&)>& draw);
  /// Draws markings that are partly worn off.
  void Paint(const Colour& colour, const std::function<void(testing::Pencil&, const Colour&)>& draw, double wear = 0.3);

  void Cracks(int count, double length_m, const Colour& colour);
  /// Tar seals over cracks: broad, black, winding lines.
  void TarSeals(int count, double length_m);
  void Patches(int count, const Material& material);
  void Stains(int count, double min_m, double max_m, double light);
  /// Leaves, litter, stones: specks of a few centimetres.
  void Specks(int count, double min_m, double max_m, const std::vector<Colour>& colours);
  void Manhole(double x, double y, double radius);
  void Drain(double x, double y);
  void TyreTrack(const std::vector<cv::Point2d>& path, double gauge, double light);
  /// Pairs of tracks, each winding from one border point to another.
  void TyreTracks(int count, double light);

  /// Soft darkening (light < 1) along a line: worn wheel paths, dirt along kerbs.
  void Wear(double x0, double y0, double x1, double y1, double width_m, double light);

 private:
  void Multiply(const cv::Mat& light);
  [[nodiscard]] cv::Mat Worn(double wear) const;
  std::vector<cv::Point2d> Wander(cv::Point2d from, double direction, double length_m, double step_m, double bend);

  float side_m_;
  double texels_per_m_;
  bool wraps_;
  Random random_;
  cv::Mat image_;
};

/// The shipped materials, as tiles of kMaterialSide_m.
inline constexpr float kMaterialSide_m = 20;
struct MaterialEntry {
  std::string name;
  std::function<Ground()> make;
};
const std::vector<MaterialEntry>& Materials();

/// Tiles of streets and squares, kTileSide_m to a side; roads run along z and are kRoadWidth_m wide.
inline constexpr float kTileSide_m = 24;
struct TileEntry {
  std::string name;
  std::function<Ground()> make;
};
const std::vector<TileEntry>& Tiles();
/// A flat square at y = 0 with the image as its texture; the image's top is the front (+z).
TexturedMesh GroundTile(const Ground& ground);

}  // namespace victorious::assets
