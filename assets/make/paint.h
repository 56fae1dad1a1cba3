// tools/: paint as a function of the 3D surface position, weathering, and a stencil for markings on vehicles.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "assets/make/mesh.h"
#include "testing/drawing.h"

namespace victorious::assets {

using testing::Colour;

/// The direction from which a chart is seen. The model's front is +z, its left +x.
enum class Side { kLeft, kRight, kTop, kBottom, kFront, kBack };

struct Surface {
  Vec3 position;  ///< m, in the part's axes
  Vec3 normal;
};

/// Blue, green, red, 0 to 255.
using Bgr = cv::Vec3f;
using Paint = std::function<Bgr(const Surface&)>;

Bgr Rgb(int red, int green, int blue);
Bgr Mix(const Bgr& a, const Bgr& b, float share_of_b);
Colour Pigment(const Bgr& ink);

/// Smooth step: 0 below `low`, 1 above `high`.
float Ramp(float value, float low, float high);

/// Smooth 3D noise, about -1 to 1, with a wavelength of about one unit.
float Noise(const Vec3& p, std::uint32_t seed);
/// Fractal noise, about -1 to 1: octaves of halving wavelength and amplitude.
float Fractal(const Vec3& p, std::uint32_t seed, int octaves);
/// Cellular noise: the distance to the nearest of random points, one per unit cube; 0 to about 1.
float Cells(const Vec3& p, std::uint32_t seed);

// --- Paints ----------------------------------------------------------------------------------------------------------

/// One colour, slightly uneven.
Paint Coat(const Bgr& colour, float unevenness = 0.05F, std::uint32_t seed = 1);
/// A camouflage patch over the base colour, with sharp edges; `fraction` is the fraction of the surface that it covers.
struct Patch {
  Bgr colour;
  float fraction = 0.3F;
};
Paint Camouflage(const Bgr& base, const std::vector<Patch>& patches, float patch_m, std::uint32_t seed);
/// Glass that reflects a bright sky in its upper part and shows a dark interior in its lower part.
Paint Glass(std::uint32_t seed = 3);
/// Rubber around an axle along x, with a rim within `rim_radius` that has `bolts` bolts.
Paint Wheel(float radius, float rim_radius, const Bgr& rim, int bolts);
Paint Metal(const Bgr& colour, std::uint32_t seed = 5);

struct Weather {
  Bgr dust = {105, 125, 140};
  float dust_height_m = 0.5F;  ///< full at the ground, zero at twice this height
  float dust_fraction = 0.45F;
  float streaks = 0.14F;  ///< relative amplitude of vertical streaks
  float stains = 0.10F;   ///< relative amplitude of stains
  float grain = 0.03F;    ///< relative amplitude of noise of a few centimetres
  std::uint32_t seed = 7;
};
Bgr Weathered(const Weather& weather, const Bgr& colour, const Surface& surface);

// --- Stencil ---------------------------------------------------------------------------------------------------------

inline constexpr double kPlainShade = 128;
inline const Colour kGroove{72};  ///< the dark gap between panels
inline const Colour kRidge{160};  ///< the highlight on an edge
inline const Colour kSoot{50};

/// Draws on one chart in metres of its part. (a, b) is (z, y) on the left and right, (z, x) on top and bottom,
/// (x, y) in front and at the back. Text is never mirrored.
class Stencil {
 public:
  /// @param origin  the part's origin on `image`, px
  Stencil(const cv::Mat& image, cv::Point2d origin, double texels_per_m, Side side);

  void Fill(const std::vector<cv::Point2d>& corners, const Colour& colour);
  void Box(double a0, double b0, double a1, double b1, const Colour& colour);
  void Frame(double a0, double b0, double a1, double b1, const Colour& colour, double thickness = 0.02);
  void Disc(double a, double b, double radius, const Colour& colour);
  void Ring(double a, double b, double radius, const Colour& colour, double thickness = 0.02);
  void Line(double a0, double b0, double a1, double b1, const Colour& colour, double thickness = 0.02);
  void Path(const std::vector<cv::Point2d>& points, const Colour& colour, double thickness = 0.02);
  void Text(double a, double b, const std::string& text, double height, const Colour& colour, double stroke = 0);

  /// A lid or door: a gap around it, a highlight on its edge, bolts in the corners.
  void Panel(double a0, double b0, double a1, double b1);
  void Rivets(double a0, double b0, double a1, double b1, double step);
  /// Dark slots with bright bars between, along a or along b.
  void Grille(double a0, double b0, double a1, double b1, int slots, bool along_a = true);
  /// Diagonal stripes within a box.
  void Hazard(double a0, double b0, double a1, double b1, const Colour& first, const Colour& second, double stripe);

 private:
  [[nodiscard]] cv::Point2d Place(double a, double b) const { return {sign_a_ * a, sign_b_ * b}; }

  testing::Pencil pencil_;
  double sign_a_;
  double sign_b_;
};

}  // namespace victorious::assets
