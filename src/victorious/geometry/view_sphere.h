// The view sphere: camera directions around the model, on rings of equal off-nadir angle: a grid of azimuth and
// off-nadir angle (the thesis's latitude and longitude), or equally dense (the thesis, 5.3.7; docs/adr/0031).
// MakeCadModel renders one template from each.
#pragma once

#include <array>
#include <vector>

#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/sphere.h"
#include "victorious/geometry/view_direction.h"

namespace victorious {

/// Views with their neighbours. The neighbours are stored, so that users do not depend on the layout.
struct ViewSphere {
  struct View {
    ViewDirection direction;
    std::vector<int> neighbours;  ///< indices of views, ascending; mutual
  };
  std::vector<View> views;
};

/// The views of a ring.
enum class ViewLayout {
  kGrid,  ///< as many in each ring: one each step of azimuth
  kEven,  ///< one each step along the ring, whose circumference is 360 degrees times the sine of its off-nadir angle
};
inline constexpr auto kViewLayoutTexts =
    std::to_array<EnumText<ViewLayout>>({{ViewLayout::kGrid, "grid"}, {ViewLayout::kEven, "even"}});

struct ViewSphereOptions {
  double step_deg = 10.0;           ///< between rings and in a ring; for ViewLayout::kGrid it must divide 360
  double max_off_nadir_deg = 70.0;  ///< maximum off-nadir angle of the last ring
  ViewLayout layout = ViewLayout::kGrid;

  void ListFields(FieldList& fields);
};

/// The pole, then the rings outwards, each from azimuth 0 on in equal steps: at the defaults 253 views, of the layout
/// kEven 157. The neighbours of a view are the up to eight adjacent views on the grid; of the layout kEven, the two
/// adjacent views of its ring and, of the rings beside it, the views within 1.5 steps. Those of the pole are the whole
/// first ring. Error: kInvalidArgument, options out of range or, for a grid, a step that does not divide 360.
[[nodiscard]] Expected<ViewSphere> MakeViewSphere(const ViewSphereOptions& options);

/// Distance and image size of a view.
struct ViewFraming {
  double distance_m = 0;   ///< from the camera to the sphere's centre; more than its radius
  double diameter_px = 0;  ///< of the sphere's outline in the image
  int width_px = 0;
  int height_px = 0;
};

/// The camera that looks at the centre of `sphere` from `direction`; its focal length gives the sphere's outline the
/// requested diameter. The world frame is the model frame. Error: kInvalidArgument, an impossible framing (distance not
/// above the radius, or a size not above 0).
[[nodiscard]] Expected<PosedCamera> CameraForView(const ViewDirection& direction, const Sphere& sphere,
                                                  const ViewFraming& framing);

}  // namespace victorious
