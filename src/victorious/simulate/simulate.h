// A scene in; a flight over it out, with everything that is true of it: what `victorious simulate` does.
//
//   scene -> Stage (meshes in their places) -> each frame: camera -> picture, truth, telemetry -> degraded -> encoded
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/simulate/scene.h"

namespace victorious {

struct SimulateOptions {
  /// Not on a GPU even if there is one: the same scene gives the same pixels each time, as long as the program and the
  /// libraries that draw (Mesa) and the processor they draw for are the same; others may round otherwise.
  bool software = true;
};

/// Writes video.mp4, telemetry.csv and truth.jsonl into the folder `out`, which is made if it is not there. Each is
/// whole or not there; the video comes last. Shows progress. `warn` is told what is damaged in CAD files, a line each.
/// Cost: some 4 frames of 640 x 480 a second in software on two cores.
/// Errors: kInvalidArgument and those of LoadMesh (the scene), kNotFound, kPermissionDenied, kNoSpace, kCancelled.
Status Simulate(const Scene& scene, const std::filesystem::path& out, const SimulateOptions& options,
                const CancelToken& cancel, const std::function<void(const std::string&)>& warn);

}  // namespace victorious
