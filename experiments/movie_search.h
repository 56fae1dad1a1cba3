// Runs the recogniser on single frames of movies with ground truth and pairs its detections with the truth, for the
// experiments on recognition. A movie is a folder with video.mp4, telemetry.csv and truth.jsonl, as `victorious
// simulate` writes it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/experiment.h"
#include "victorious/base/error.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/lab/evaluate/truth.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame_conditions.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// One frame, searched as a whole.
struct SearchedFrame {
  std::string movie;  ///< name of its folder
  std::int64_t frame = 0;
  std::optional<CameraState> camera;
  FrameConditions conditions;
  FeatureSet features;
  std::vector<Detection> detections;           ///< best first
  std::vector<std::optional<TruthRow>> truth;  ///< of each detection; std::nullopt: a false positive
};

struct MovieSearch {
  std::filesystem::path movie;
  IndexOptions options;
  int frames = 20;  ///< maximum number, evenly spaced over the movie
};

/// Lists the movie folders in DATA/movies, sorted by name. Error: kNotFound if there are none.
[[nodiscard]] Expected<std::vector<std::filesystem::path>> FindMovies(const ExperimentSettings& settings);

/// Searches the frames of a movie, on all cores.
/// @param visit  called for each frame in their order, with the models that are searched for; its error ends the search
[[nodiscard]] Status SearchMovie(
    const MovieSearch& search, const ExperimentSettings& settings,
    const std::function<Status(const SearchedFrame&, const std::vector<ObjectModel>&)>& visit);

}  // namespace victorious
