// A pool of match trials: a few frames of every scene file's flight, and of the movies if they are available. Each
// visible object is matched with the template of the nearest view.
#pragma once

#include <memory>
#include <vector>

#include "experiments/match_trial.h"

namespace victorious {

/// An image, and the folder of its objects' CAD files.
struct PooledScene {
  std::shared_ptr<const AnnotatedImage> scene;
  std::filesystem::path cad_folder;
  int flight = 0;  ///< index of its flight or movie in the pool
};

enum class IncludeMovies { kYes, kNo };

/// Renders or reads `frames` (at least 1) images of each scene file in settings.scenes and of each movie in
/// settings.data, evenly spaced over its length. Error: kNotFound without any image.
[[nodiscard]] Expected<std::vector<PooledScene>> PoolScenes(const ExperimentSettings& settings, int frames,
                                                            IncludeMovies with);

/// Returns one trial per image and model that has an object with a visible fraction of 0.5 or more.
[[nodiscard]] Expected<std::vector<MatchTrial>> PoolTrials(const ExperimentSettings& settings, const MatchSetup& setup,
                                                           const std::vector<PooledScene>& scenes);

}  // namespace victorious
