// Ground truth of a rendered frame: for each visible object its box, visibility, geodetic position, heading and view
// angles.
//
//   visible = pixels of the object in the frame / pixels of the object rendered alone, neither occluded nor cropped
// Both count pixels whose central ray meets the object. If the second image would be wider or higher than 4096 pixels,
// it is rendered at a smaller scale and the count is rescaled. Angles are those of geometry/view_direction.h.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/geometry/view_direction.h"
#include "victorious/lab/simulate/placed_scene.h"
#include "victorious/lab/simulate/scene.h"
#include "victorious/object/render/renderer.h"

namespace victorious {

/// One object in one frame.
struct ObjectTruth {
  int object = 0;                    ///< its index in the scene
  Box box;                           ///< bounding box of the visible pixels, px
  int pixels = 0;                    ///< number of visible pixels, > 0
  double visible = 0;                ///< visible fraction, (0, 1]
  GeodeticPoint place;               ///< position of the centre of its 3D bounding box
  double heading_rad = 0;            ///< heading of its front, clockwise from true north, [0, 2 pi)
  double speed_m_s = 0;              ///< of that centre, over the ground
  std::optional<double> course_rad;  ///< direction of its motion, clockwise from true north, [0, 2 pi); none at rest
  ViewDirection view;                ///< direction from the centre of its 3D bounding box to the camera
};

/// The truth of all objects with at least one visible pixel, in the scene's order.
/// @param objects           of PlacedScene::ObjectsAt()
/// @param instances         RenderedView::instances of the frame; instance i < objects.size() is object i
/// @param earth             tangent plane at the origin of the town
/// @param town_heading_rad  heading of the town's y axis at the origin, clockwise from north
/// Errors: those of Render.
[[nodiscard]] Expected<std::vector<ObjectTruth>> ComputeTruth(std::span<const PlacedMesh> objects,
                                                              const cv::Mat& instances, const PosedCamera& camera,
                                                              const TangentPlane& earth, double town_heading_rad,
                                                              Renderer& renderer);

/// One line of truth.jsonl, with the newline.
[[nodiscard]] std::string FormatTruthLine(const ObjectTruth& truth, const SceneObject& object, int frame,
                                          double time_s);

/// Rotation from the town frame to east-north-up at the origin of the town.
[[nodiscard]] Eigen::Quaterniond EnuFromTown(double town_heading_rad);

}  // namespace victorious
