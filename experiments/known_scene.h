// Images with ground truth: the camera, the scene depth and the pose of each object. Matches are judged against these
// (true_matches.h). An image is rendered from a scene file by the simulator, or is a frame of a movie with telemetry
// and truth.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/view_direction.h"
#include "victorious/input/image/degrade.h"
#include "victorious/lab/simulate/placed_scene.h"
#include "victorious/lab/simulate/scene.h"
#include "victorious/object/render/renderer.h"

namespace victorious {

/// One object in an image.
struct LabelledObject {
  std::string model;         ///< name of its model
  Rigid3 camera_from_model;  ///< metres
  ViewDirection view;        ///< direction from its centre to the camera
  Box box;                   ///< bounding box of its visible pixels, px
  double visible = 1;        ///< visible pixels over its pixels without occlusion and cropping
};

struct AnnotatedImage {
  std::string name;  ///< "circle_noise, frame 40"
  cv::Mat bgr;       ///< CV_8UC3
  PinholeCamera pinhole;
  cv::Mat depth_m;  ///< CV_32FC1, depth of the nearest surface along the optical axis; NaN: unknown
  std::vector<LabelledObject> objects;

  /// The first object of a model; null if there is none.
  [[nodiscard]] const LabelledObject* Find(std::string_view model) const;
};

/// The degradation of a scene file: its blur, sensor noise and salt-and-pepper noise, then JPEG compression with a
/// quality of 75 in place of the video encoder.
[[nodiscard]] ImageDegradation DegradationOf(const Scene& scene);

/// Renders single frames of a scene file, also with a changed camera, sun or video.
class SceneRenderer {
 public:
  /// Loads the scene and its meshes. `renderer` must outlive the result. Errors: those of ReadScene and
  /// PlacedScene::Build.
  [[nodiscard]] static Expected<SceneRenderer> Load(const std::filesystem::path& scene_file, Renderer& renderer,
                                                    const CancelToken& cancel);

  [[nodiscard]] const Scene& scene() const { return scene_; }

  /// Renders one frame with its truth.
  /// @param scene  scene(), or a copy of it with another video, camera or sun
  /// @param frame  number of the frame of the flight, from 0
  [[nodiscard]] Expected<AnnotatedImage> Draw(const Scene& scene, int frame, const ImageDegradation& degradation) const;
  /// Renders one frame with the scene and the degradation of the file.
  [[nodiscard]] Expected<AnnotatedImage> Draw(int frame) const { return Draw(scene_, frame, DegradationOf(scene_)); }

 private:
  SceneRenderer(std::string name, Scene scene, PlacedScene placed, Renderer& renderer);

  std::string name_;
  Scene scene_;
  PlacedScene placed_;
  Renderer* renderer_;
};

/// Reads frames of a movie with their truth.
/// @param folder  contains video.mp4, telemetry.csv and truth.jsonl
/// @param models  folder of the objects' CAD files; objects without a file are left out
/// @param frames  maximum number of frames, evenly spaced over the movie
/// Objects are assumed to stand upright. The depth covers the objects only, so that occlusion by anything else shows in
/// `visible` only.
[[nodiscard]] Expected<std::vector<AnnotatedImage>> ReadLabelledMovie(const std::filesystem::path& folder,
                                                                      const std::filesystem::path& models, int frames,
                                                                      Renderer& renderer);

}  // namespace victorious
