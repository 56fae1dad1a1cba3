// Many trials to pool: every scene file's flight, and the movies where they are at hand, each in a few frames with
// every object in view, held against the template of the nearest view.
#pragma once

#include <memory>
#include <vector>

#include "victorious/evaluate/experiments/match_trial.h"

namespace victorious {

/// A picture and where the CAD files of what it shows lie.
struct PooledScene {
  std::shared_ptr<const KnownScene> scene;
  std::filesystem::path cad_folder;
  int flight = 0;  ///< whose picture it is, counted through the pool
};

enum class Movies { kToo, kNone };

/// `frames` pictures of each scene file of the folder settings.scenes and of each movie of settings.data, spread over
/// its length; one at least.
Expected<std::vector<PooledScene>> PoolScenes(const ExperimentSettings& settings, int frames, Movies with);

/// One trial for each kind of object of each picture of which half or more is in view.
Expected<std::vector<MatchTrial>> PoolTrials(const ExperimentSettings& settings, const MatchSetup& setup,
                                             const std::vector<PooledScene>& scenes);

}  // namespace victorious
