// Pictures of which it is known where each object stands: what matches are held against. Drawn from a scene file by the
// simulator, or a frame of a movie with telemetry and truth beside it.
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
#include "victorious/render/renderer.h"
#include "victorious/render/view_sphere.h"
#include "victorious/simulate/degrade.h"
#include "victorious/simulate/scene.h"
#include "victorious/simulate/stage.h"

namespace victorious {

/// One object in a picture.
struct KnownObject {
  std::string model;         ///< its kind
  Rigid3 camera_from_model;  ///< metres
  ViewDirection view;        ///< from its middle to the camera
  Box box;                   ///< of its visible pixels, px
  double visible = 1;        ///< visible pixels over those it would have unhidden and uncropped
};

struct KnownScene {
  std::string name;  ///< "circle_noise, frame 40"
  cv::Mat bgr;       ///< CV_8UC3
  PinholeCamera pinhole;
  cv::Mat depth_m;  ///< CV_32FC1 along the optical axis, of the nearest surface; NaN: nothing known to be there
  std::vector<KnownObject> objects;

  /// The first object of a kind; null if there is none.
  [[nodiscard]] const KnownObject* Find(std::string_view model) const;
};

/// What spoils a drawn picture: the optics and the sensor, then compression.
struct Spoiling {
  DegradeOptions degrade;
  int jpeg_quality = 0;  ///< 1 to 100; 0: not compressed
};

/// Changes a picture as a camera and an encoder would. Deterministic by `seed`.
Status Spoil(const Spoiling& spoiling, std::uint64_t seed, cv::Mat& bgr);

/// The spoiling that a scene file asks for: its blur, grain and noise, compressed to JPEG of a quality of 75, a picture
/// by itself, in place of the video's encoder.
[[nodiscard]] Spoiling SpoilingOf(const Scene& scene);

/// A scene file whose pictures can be drawn again and again, with changes to what its camera, sun and video are.
class KnownTown {
 public:
  /// Loads everything once. `renderer` must outlive it. Errors: those of ReadScene and Stage::Build.
  static Expected<KnownTown> Load(const std::filesystem::path& scene_file, Renderer& renderer,
                                  const CancelToken& cancel);

  [[nodiscard]] const Scene& scene() const { return scene_; }

  /// @param scene  scene(), or a copy of it with another video, camera or sun
  /// @param frame  of the flight
  Expected<KnownScene> Draw(const Scene& scene, int frame, const Spoiling& spoiling) const;
  /// As the file has it.
  Expected<KnownScene> Draw(int frame) const { return Draw(scene_, frame, SpoilingOf(scene_)); }

 private:
  KnownTown(std::string name, Scene scene, Stage stage, Renderer& renderer);

  std::string name_;
  Scene scene_;
  Stage stage_;
  Renderer* renderer_;
};

/// At most so many frames of a movie, evenly over its length: video.mp4, telemetry.csv and truth.jsonl in `folder`, the
/// CAD files of the objects in `models`. Objects stand upright. Depth is that of the objects alone, so hidden ones are
/// known by `visible` only. Objects whose CAD file is not there are left out.
Expected<std::vector<KnownScene>> ReadKnownMovie(const std::filesystem::path& folder,
                                                 const std::filesystem::path& models, int frames, Renderer& renderer);

}  // namespace victorious
