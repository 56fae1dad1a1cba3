// Movies with ground truth, indexed as `victorious index` does, for the figures of chapters 4 and 5. A movie is
// simulated once, and indexed once for the same parameters and the same program build; both are cached in OUT. An
// interrupted indexing resumes.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "experiments/experiment.h"
#include "victorious/base/error.h"
#include "victorious/input/telemetry/camera_track.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/lab/evaluate/score.h"
#include "victorious/lab/evaluate/truth.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/store/index_store.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// The program's defaults, except that only every 5th frame is searched as a whole, so that objects are tracked between
/// these. The interval is the thesis's N; the thesis gives no value.
IndexOptions TrackingIndexOptions();

struct MovieWithTruth {
  std::string name;
  std::filesystem::path folder;     ///< contains video.mp4 and telemetry.csv
  std::vector<TruthRow> truth;      ///< rows whose model is in `models`
  std::vector<ObjectModel> models;  ///< made from the CAD files of the models that the truth names, by name
  /// Relit templates of each model, shared so that one search reuses those of another.
  std::vector<std::shared_ptr<const RelitTemplateSource>> relit_templates;
};

/// Returns the model of each name in the truth for which the folder has NAME.glb, by name. Models are built once and
/// cached in OUT/models. Error: kNotFound if there are none.
[[nodiscard]] Expected<std::vector<ObjectModel>> LoadTruthModels(const std::vector<TruthRow>& truth,
                                                                 const std::filesystem::path& cad_files,
                                                                 const ExperimentSettings& settings);

/// Simulates SCENES/NAME.json into OUT/flights, unless it is cached there; at most `settings.frames` frames. Errors:
/// those of ReadScene and Simulate.
[[nodiscard]] Expected<MovieWithTruth> SimulateScene(const std::string& name, const ExperimentSettings& settings);

/// Simulates the scenes `settings.movies`, or those of the first argument if it is empty.
[[nodiscard]] Expected<std::vector<MovieWithTruth>> SimulateScenes(const std::vector<std::string>& default_names,
                                                                   const ExperimentSettings& settings);

/// Reads the movie in `folder` (one of DATA/movies), with the CAD files of DATA/models.
[[nodiscard]] Expected<MovieWithTruth> ReadMovie(const std::filesystem::path& folder,
                                                 const ExperimentSettings& settings);

/// Returns the movie's index for these parameters. The sightings are searched once and cached in OUT/indexes, by the
/// name of the movie, the search parameters and the program build. The data association runs anew each time, by
/// `options.objects`.
[[nodiscard]] Expected<std::unique_ptr<IndexStore>> IndexMovie(const MovieWithTruth& movie, const IndexOptions& options,
                                                               const ExperimentSettings& settings);

/// Reads the camera states of the movie's telemetry.
[[nodiscard]] Expected<CameraTrajectory> ReadCameraTrack(const MovieWithTruth& movie);

/// The minimum distance between the camera and the centre of a visible object, m; infinity without any.
[[nodiscard]] Expected<double> MinRangeM(const MovieWithTruth& movie);

/// Describes the movies in the notes of reports: "straight (120 frames, 6 objects), ...".
std::string DescribeMovies(const std::vector<MovieWithTruth>& movies);

}  // namespace victorious
