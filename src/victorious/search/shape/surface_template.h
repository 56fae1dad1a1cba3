// shape/: draws the surface of an object as it looks from a direction, under the sun, and makes the template of the
// shape search of it. The surface comes from a rendering with depth of a nearby direction; its points are projected by
// weak perspective.
//
// Brightness of a point, linear, with n its normal, u up and s the direction to the sun:
//   albedo * (0.35 (0.4 + 0.175 (1 + n.u)) + 0.65 max(0, n.s))
// The paint is the model's own, or one grey: what is repainted, or was never painted as in the file, has the edges of
// its shape alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "victorious/geometry/view_direction.h"
#include "victorious/search/shape/background_spectrum.h"
#include "victorious/types/surface_point.h"

namespace victorious {

enum class TemplatePaint {
  kPlain,  ///< one grey
  kOwn     ///< that of the model
};
inline constexpr std::size_t kTemplatePaints = 2;

struct TemplateView {
  ViewDirection to_camera;              ///< from the object, in the model frame
  std::optional<ViewDirection> to_sun;  ///< in the model frame; std::nullopt: light from above
  double pixels_per_m = 1;              ///< scale of the template
};

/// The gradient cells of a drawn surface, row by row. They do not depend on a video.
struct DrawnCells {
  int side = 0;
  std::vector<std::uint8_t> coverage;  ///< side x side: of a cell by the object; 255: all of it
  std::vector<std::uint8_t> codes;     ///< side x side x 8, as in GradientCells

  bool operator==(const DrawnCells&) const = default;
};

/// In each paint. The centre of the object's bounding box lies in the centre of the cell (side / 2, side / 2), up is
/// the image's up. Cost: about 0.4 ms for 18 x 18 cells.
[[nodiscard]] std::array<DrawnCells, kTemplatePaints> DrawCells(const VisibleSurface& surface, const TemplateView& view,
                                                                int side);

/// Drawn cells, less the mean of the background, weighed by how much of a cell is object.
[[nodiscard]] CellTemplate MakeTemplate(const DrawnCells& drawn, const BackgroundSpectrum& background);

}  // namespace victorious
