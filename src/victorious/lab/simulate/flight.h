// Renders the frames of a scene one by one, with their ground truth (camera, depth, instances). `Simulate` writes them
// to files; experiments evaluate matches with them.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/lab/simulate/placed_scene.h"
#include "victorious/lab/simulate/scene.h"
#include "victorious/object/render/renderer.h"

namespace victorious {

/// One rendered frame of a flight.
struct RenderedFrame {
  double time_s = 0;
  PosedCamera camera;               ///< its world frame is the town frame
  std::vector<PlacedMesh> objects;  ///< the scene's objects in its order, at their poses at `time_s`
  RenderedView view;                ///< before degradation; instance i < objects.size() is object i
  cv::Mat bgr;                      ///< CV_8UC3, after degradation (degrade.h)
};

class Flight {
 public:
  /// `placed` is built from `scene` on `renderer`. All three must outlive this object.
  Flight(const Scene& scene, Renderer& renderer, const PlacedScene& placed);

  /// Renders and degrades one frame.
  /// @param frame  from 0 to scene.video.frames - 1
  /// Errors: those of Render.
  [[nodiscard]] Expected<RenderedFrame> Draw(int frame);

 private:
  [[nodiscard]] std::vector<MeshInstance> Instances(const std::vector<PlacedMesh>& objects,
                                                    const PosedCamera& camera) const;

  const Scene& scene_;
  Renderer& renderer_;
  const PlacedScene& placed_;
  Light light_;
};

}  // namespace victorious
