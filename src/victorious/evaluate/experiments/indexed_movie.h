// Movies of known truth, indexed as `victorious index` does: what the figures of chapters 4 and 5 are made of. A movie
// is flown once and searched once with the same parameters by the same build, and kept in OUT; a run that was stopped
// goes on.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/evaluate/experiments/experiment.h"
#include "victorious/evaluate/score.h"
#include "victorious/evaluate/truth.h"
#include "victorious/pipeline/index_options.h"
#include "victorious/store/index_store.h"
#include "victorious/telemetry/camera_track.h"
#include "victorious/types/lit_templates.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// The program's defaults, but for frames between whole-frame searches, the thesis's N, to which it gives no value: 5,
/// so that objects are followed.
IndexOptions FollowingOptions();

struct TrueMovie {
  std::string name;
  std::filesystem::path folder;     ///< with video.mp4 and telemetry.csv
  std::vector<TruthRow> truth;      ///< of what there are models of
  std::vector<ObjectModel> models;  ///< of the CAD files of what the truth names, by name
  /// Theirs, so that what one search made of them serves the next.
  std::vector<std::shared_ptr<const LitTemplates>> lit;
};

/// SCENES/NAME.json, flown once into OUT/flights; at most `settings.frames` frames. Errors: those of ReadScene and
/// Simulate.
Expected<TrueMovie> FlyScene(const std::string& name, const ExperimentSettings& settings);

/// The scenes that settings name, else these.
Expected<std::vector<TrueMovie>> FlyScenes(const std::vector<std::string>& unless_named,
                                           const ExperimentSettings& settings);

/// DATA/movies/NAME with the CAD files of DATA/models.
Expected<TrueMovie> ReadMovie(const std::filesystem::path& folder, const ExperimentSettings& settings);

/// The movie's index with these parameters. What decides what is found is searched once and kept, in OUT/indexes by the
/// name of the movie, the parameters and the program that runs; the objects are made anew of it each time, by
/// `options.objects`.
Expected<std::unique_ptr<IndexStore>> IndexOf(const TrueMovie& movie, const IndexOptions& options,
                                              const ExperimentSettings& settings);

/// Where its telemetry has the camera.
Expected<CameraTrack> CamerasOf(const TrueMovie& movie);

/// The least distance between a camera and the middle of an object in view, m.
Expected<double> NearestRangeM(const TrueMovie& movie);

/// "120 frames of straight" or so, for notes.
std::string Describe(const std::vector<TrueMovie>& movies);

}  // namespace victorious
