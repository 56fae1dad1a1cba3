// What a searcher ought to find in a rendered frame: of each object the part that is seen, where it is on Earth, and
// from which side it is seen.
//
//   visible = pixels of the object in the frame / pixels it would have alone, unhidden, on a canvas as large as it is
// Both count the pixels whose centre's line of sight meets the object; where the canvas would be wider or higher than
// 4096 pixels, it is drawn smaller and counted as the larger one. Angles are those of render/view_sphere.h.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/render/renderer.h"
#include "victorious/render/view_sphere.h"
#include "victorious/simulate/scene.h"
#include "victorious/simulate/stage.h"

namespace victorious {

/// One object in one frame.
struct ObjectTruth {
  int object = 0;          ///< its index in the scene
  Box box;                 ///< of the visible pixels, px
  int pixels = 0;          ///< visible ones, above 0
  double visible = 0;      ///< (0, 1]
  GeodeticPoint place;     ///< of the bounding box's centre
  double heading_rad = 0;  ///< of its front, clockwise from true north, [0, 2 pi)
  ViewDirection view;      ///< from the bounding box's centre to the camera
};

/// The objects with a part in view, in the scene's order.
/// @param objects    as Stage::ObjectsAt gives them
/// @param instances  RenderedView::instances of the frame, where instance i below objects.size() is object i
/// @param earth      its origin is the town's
/// @param town_heading_rad  where the town's y axis points there, clockwise from north
/// Errors: those of Render.
Expected<std::vector<ObjectTruth>> TruthOf(std::span<const StagedThing> objects, const cv::Mat& instances,
                                           const PosedCamera& camera, const TangentPlane& earth,
                                           double town_heading_rad, Renderer& renderer);

/// A line of truth.jsonl, with its end.
[[nodiscard]] std::string TruthLine(const ObjectTruth& truth, const SceneObject& object, int frame, double time_s);

/// Turns a direction of the town into one of the tangent plane at its origin.
[[nodiscard]] Eigen::Quaterniond EnuFromTown(double town_heading_rad);

}  // namespace victorious
