// The thesis's section 5.3.3: the default setting and its variations, each of 14 parameters once less and once more, on
// three movies. Figures 5.2 to 5.5 are four views of what this gives.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/evaluate/experiments/experiment.h"
#include "victorious/evaluate/experiments/indexed_movie.h"
#include "victorious/pipeline/index_options.h"

namespace victorious {

/// One that is varied.
struct VariedParameter {
  const char* name;  ///< as `--params` names it
  const char* of;    ///< the part of the system: "recogniser", "tracker", "association", "geolocation"
};
std::span<const VariedParameter> VariedParameters();

/// The default, or the default with one parameter changed.
struct StudySetting {
  std::string name;  ///< "default", "search.nearest = 3"
  std::string of;    ///< VariedParameter's
  IndexOptions options;
};

/// The default first, then each parameter times 0.75 and times 1.25; whole numbers are rounded, and change by at least
/// 1.
std::vector<StudySetting> StudySettings();

/// One true object as one setting reports it.
struct StudiedObject {
  std::string movie;
  std::string name;
  std::string model;
  bool found = false;
  double density = 0;             ///< of the frames in view, those in which it was reported
  double density_between = 0;     ///< the same from the first to the last such report
  int ids = 0;                    ///< reported objects that show it
  std::optional<double> error_m;  ///< of its place, along the ground
};

/// What one setting gives on all movies together.
struct StudiedSetting {
  std::string name;
  std::string of;
  int findable = 0;
  int found = 0;
  int false_objects = 0;
  std::vector<StudiedObject> objects;  ///< the findable ones, by movie and name
  int other_sightings = 0;  ///< of the default's and this one's, those that only one has (movie, model, frame, box)
  int other_places = 0;     ///< of the objects, those placed a millimetre or more nearer or farther than by default

  [[nodiscard]] double Recall() const;
  [[nodiscard]] double Precision() const;
  [[nodiscard]] double IdsPerObject() const;  ///< of those shown at all
};

struct Study {
  std::vector<TrueMovie> movies;
  std::vector<StudiedSetting> settings;  ///< in the order of StudySettings()
};

/// All settings on the movies of `settings`, or three that stand for the project's: straight, round and shaken. Of
/// settings that differ in what is made of sightings alone, a movie is searched once (IndexOf).
Expected<Study> RunStudy(const ExperimentSettings& settings);

/// These settings on these movies; the first is what others are compared with.
Expected<Study> StudyMovies(std::vector<TrueMovie> movies, const std::vector<StudySetting>& wanted,
                            const ExperimentSettings& settings);

/// What `value` tells of the findable objects, over all settings.
std::vector<double> ValuesOf(const Study& study,
                             const std::function<std::optional<double>(const StudiedObject&)>& value);

/// How the settings were searched, for notes.
std::string DescribeStudy(const Study& study);

}  // namespace victorious
