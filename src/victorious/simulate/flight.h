// A scene's frames, drawn one by one: the picture as the camera delivers it, and what is known of it because it was
// drawn. What `Simulate` writes to files, and experiments measure matches with.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/render/renderer.h"
#include "victorious/simulate/scene.h"
#include "victorious/simulate/stage.h"

namespace victorious {

/// One moment of a flight.
struct DrawnFrame {
  double time_s = 0;
  PosedCamera camera;                ///< its world is the town
  std::vector<StagedThing> objects;  ///< the scene's, in its order, where they are now
  RenderedView view;                 ///< before it was degraded; instance i below objects.size() is object i
  cv::Mat bgr;                       ///< CV_8UC3, with blur, grain and noise
};

class Flight {
 public:
  /// All three must outlive it; `stage` is the scene's, on `renderer`.
  Flight(const Scene& scene, Renderer& renderer, const Stage& stage);

  /// @param frame  from 0 to scene.video.frames - 1. Errors: those of Render.
  Expected<DrawnFrame> Draw(int frame);

 private:
  [[nodiscard]] std::vector<MeshInstance> Instances(const std::vector<StagedThing>& objects,
                                                    const PosedCamera& camera) const;

  const Scene& scene_;
  Renderer& renderer_;
  const Stage& stage_;
  Light light_;
};

}  // namespace victorious
