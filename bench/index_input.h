// The input of `bench index`: movies and the models to search them for. With $VICTORIOUS_DATA the movies and the
// vehicles there; without it a flight simulated from scenes/ and the project's own models.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/benchmarks.h"
#include "victorious/base/error.h"
#include "victorious/types/object_model.h"

namespace victorious::bench {

/// A movie and the folder of CAD files of the objects in it.
struct IndexMovie {
  std::string name;
  std::filesystem::path folder;     ///< contains video.mp4 and telemetry.csv
  std::filesystem::path cad_files;  ///< NAME.glb
};

/// Lists $VICTORIOUS_DATA/movies, sorted by name; without it, or with settings.quick, simulates scenes/straight.json
/// into the cache, unless it is there. Errors: those of Simulate.
[[nodiscard]] Expected<std::vector<IndexMovie>> FindIndexMovies(const Settings& settings);

/// The names of the models in a folder of CAD files, those of the thesis first, then alphabetically.
std::vector<std::string> ListModels(const std::filesystem::path& cad_files);

/// Loads a model from the cache; makes it with the options of `victorious model add` if it is not there (7 to 35 s).
/// With settings.quick it has a view every 45 degrees. Errors: those of LoadMesh, MakeCadModel and of writing.
[[nodiscard]] Expected<ObjectModel> LoadIndexModel(const std::filesystem::path& cad_file, const Settings& settings);

}  // namespace victorious::bench
