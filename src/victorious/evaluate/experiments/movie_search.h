// What the recogniser finds in movies whose truth is known, frame by frame, whatever its score: for experiments on
// recognition. A movie is a folder with video.mp4, telemetry.csv and truth.jsonl, as `victorious simulate` makes them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/evaluate/experiments/experiment.h"
#include "victorious/evaluate/truth.h"
#include "victorious/pipeline/index_options.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame_conditions.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// One frame, searched as a whole.
struct SearchedFrame {
  std::string movie;  ///< its folder's name
  std::int64_t frame = 0;
  std::optional<CameraState> camera;
  FrameConditions conditions;
  FeatureSet features;
  std::vector<Detection> detections;           ///< best first
  std::vector<std::optional<TruthRow>> truth;  ///< of each detection: what it shows; nothing: it is wrong
};

struct MovieSearch {
  std::filesystem::path movie;
  IndexOptions options;
  int frames = 20;  ///< at most so many, evenly over the movie
};

/// The folders of DATA/movies, by name. Errors: kNotFound for none.
Expected<std::vector<std::filesystem::path>> MoviesOf(const ExperimentSettings& settings);

/// A searchable model of each name in the movie's truth for which DATA/models has NAME.glb. Made once: kept in
/// OUT/models.
Expected<std::vector<ObjectModel>> ModelsFor(const std::vector<TruthRow>& truth, const ExperimentSettings& settings);

/// @param visit  called in the order of frames, with the models that were searched for
Status SearchMovie(const MovieSearch& search, const ExperimentSettings& settings,
                   const std::function<Status(const SearchedFrame&, const std::vector<ObjectModel>&)>& visit);

}  // namespace victorious
