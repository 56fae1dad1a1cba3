// Simulates a flight over a scene: video, telemetry and ground truth. Implements `victorious simulate`.
//
//   scene -> PlacedScene -> each frame: camera -> image, truth, telemetry -> degradation -> encoder
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/lab/simulate/scene.h"

namespace victorious {

struct SimulateOptions {
  /// Never use a GPU. The same scene then gives the same pixels each time with the same program, graphics library
  /// (Mesa) and processor; others may round differently.
  bool software = true;
};

/// Writes video.mp4, telemetry.csv and truth.jsonl into the folder `out`, which is created if it does not exist. Each
/// file is written atomically; the video is the last one. Shows progress. `warn` gets one line for each damaged part of
/// a CAD file.
/// Cost: about 4 frames of 640 x 480 a second in software on two cores.
/// Errors: kInvalidArgument and those of LoadMesh (the scene), kNotFound, kPermissionDenied, kNoSpace, kCancelled.
[[nodiscard]] Status Simulate(const Scene& scene, const std::filesystem::path& out, const SimulateOptions& options,
                              const CancelToken& cancel, const std::function<void(const std::string&)>& warn);

}  // namespace victorious
