// CameraStates::Load as a function of an isolated process (base/isolated_process.h): the container of a video and the
// tags of photos are read there, as hostile as its frames may be.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/input/telemetry/telemetry.h"
#include "victorious/place/cameras/camera_states.h"

namespace victorious {

struct CameraRequest {
  std::string video;                 ///< path
  std::optional<double> duration_s;  ///< of the video
  int width = 0;                     ///< px, of its frames
  int height = 0;                    ///< px
  std::optional<std::string> file;   ///< the telemetry file that was given; std::nullopt: in the video or beside it
  TelemetryOptions options;
  std::string consequence;  ///< of CameraStates::Load
};

/// The files that answering it reads, besides those that belong to the video.
[[nodiscard]] std::vector<std::filesystem::path> FilesOfCameraRequest(const CameraRequest& request);

[[nodiscard]] std::string PackCameraRequest(const CameraRequest& request);

/// Loads the states that a packed request asks for, and packs them. Call it in an isolated process. Errors: those of
/// CameraStates::Load.
[[nodiscard]] Expected<std::string> AnswerCameraRequest(std::string_view packed);

/// Reads an answer, and passes its warnings on. Error: kDataLoss unless the times increase and the places are numbers:
/// the process that wrote it may have been taken over.
[[nodiscard]] Expected<CameraStates> UnpackCameraAnswer(std::string_view answer, const WarningSink& warn);

}  // namespace victorious
