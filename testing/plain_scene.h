// For tests only: scenes with a rendered object of one grey before fields, seen at an angle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/geometry/box.h"
#include "victorious/search/shape/gradient_cells.h"
#include "victorious/types/frame_conditions.h"
#include "victorious/types/object_model.h"

namespace victorious::testing {

/// The off-nadir angle that the object of a plain scene is seen at.
inline constexpr double kOffNadirOfScene_deg = 40;

/// The model of the object: a slab with blocks (MakeSmallCadModel), views every 10 degrees.
const ObjectModel& PlainModel();

/// Fields: overlapping rectangles of different greys, turned, with noise. @return CV_8UC1
cv::Mat DrawFields(std::uint64_t seed, const cv::Size& size = {640, 480});

/// What a search by shape has as background: cells of two scenes of fields.
std::vector<GradientCells> CellsOfFields();

struct PlainScene {
  cv::Mat grey;               ///< CV_8UC1
  Box box;                    ///< of the object, px
  Eigen::Vector2d centre_px;  ///< of its bounding box
  double azimuth_rad = 0;     ///< of the camera, in the model frame
  FrameConditions conditions;
};

/// The object in one grey under light from above, before a background. The camera sees the place of the object at the
/// off-nadir angle of the view, and from as far away.
/// @param number   of the view, every 40 degrees: between those of the model
/// @param left_px  of the view in the scene
PlainScene MakePlainScene(std::size_t number, cv::Mat background, double left_px);

}  // namespace victorious::testing
