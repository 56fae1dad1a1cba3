// Which cells of the ground the frames of a flight show, from where and how large. Input: camera states and the ground.
// Output: the coverage of models, by the probability of view_detection.h.
//
// The middle of each cell, at the height of the ground there, is projected into each frame (camera.h, lens.h): the
// frame shows the cell if it lies inside the image, and, on ground that is not flat, if the line of sight meets no
// ground before. The bounds of the search for cells are the corners and edges of the frame on the ground.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/geometry/ground.h"
#include "victorious/place/geolocate/view_detection.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/ground_coverage.h"

namespace victorious {

/// A frame whose camera and ground are known.
struct GroundLook {
  CameraState camera;  ///< complete (CameraState::IsComplete)
  int width_px = 0;
  int height_px = 0;
  std::shared_ptr<const Ground> ground;
};

/// The outline of what a frame shows of the ground, points around it; rays that meet no ground, or none within 20 km,
/// are left out. Empty: it shows none.
[[nodiscard]] std::vector<GeodeticPoint> GroundOutline(const GroundLook& look);

/// A model that is searched for.
struct SearchedModel {
  std::string name;
  double diagonal_m = 0;
};

struct GridRequest {
  std::optional<double> cell_m;  ///< side of a cell; std::nullopt: by the area and the next two
  double min_cell_m = 1;         ///< no smaller cell is chosen
  double max_cells = 250'000;    ///< about so many cells at most are chosen
  std::optional<GeodeticPoint>
      centre;           ///< of the area that was to be searched, a circle; std::nullopt: the convex hull
                        ///< of all ground that a frame shows
  double radius_m = 0;  ///< of that circle
};

/// Error: kInvalidArgument if no look shows ground, or if a given `cell_m` makes more than 4 million cells.
[[nodiscard]] Expected<GroundCoverage> CoverGround(const std::vector<GroundLook>& looks,
                                                   const std::vector<SearchedModel>& models,
                                                   const ViewDetectionOptions& options, const GridRequest& grid);

}  // namespace victorious
