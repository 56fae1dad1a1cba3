// The parameter study of thesis section 5.3.3: the default setting, and each of 14 parameters once decreased and once
// increased, on three movies. Figures 5.2 to 5.5 report its results.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/experiment.h"
#include "experiments/indexed_movie.h"
#include "victorious/base/error.h"
#include "victorious/jobs/index/index_options.h"

namespace victorious {

/// A parameter that is varied.
struct VariedParameter {
  const char* name;  ///< its name in `--params`
  const char* of;    ///< its component: "recogniser", "tracker", "association", "geolocation"
};
std::span<const VariedParameter> VariedParameters();

/// The default, or the default with one parameter changed.
struct StudySetting {
  std::string name;  ///< "default", "search.nearest = 3"
  std::string of;    ///< component of the varied parameter; empty for the default
  IndexOptions options;
};

/// Returns the default, then each parameter times 0.75 and times 1.25. Integers are rounded and change by at least 1.
std::vector<StudySetting> StudySettings();

/// The result of one setting for one true object.
struct ObjectResult {
  std::string movie;
  std::string name;
  std::string model;
  bool found = false;
  double density = 0;             ///< fraction of the frames in view in which it is reported
  double density_between = 0;     ///< the same from the first to the last such frame
  int ids = 0;                    ///< reported objects that show it
  std::optional<double> error_m;  ///< horizontal error of its place
};

/// The results of one setting on all movies together.
struct SettingResult {
  std::string name;
  std::string of;
  int findable = 0;
  int found = 0;
  int false_objects = 0;
  std::vector<ObjectResult> objects;  ///< the findable objects, by movie and name
  int changed_sightings = 0;          ///< sightings (movie, model, frame, box) that only this or only the default has
  int changed_places = 0;             ///< objects whose horizontal error differs by 1 mm or more from the default's

  [[nodiscard]] double Recall() const;
  [[nodiscard]] double Precision() const;
  [[nodiscard]] double IdsPerObject() const;  ///< mean over the objects that are shown at all
};

struct Study {
  std::vector<MovieWithTruth> movies;
  std::vector<SettingResult> settings;  ///< in the order of StudySettings()
};

/// Evaluates all settings on the movies of `settings`, or on the scenes straight, circle and shaken. Settings that
/// differ in the data association only share one search of a movie (IndexMovie).
[[nodiscard]] Expected<Study> RunStudy(const ExperimentSettings& settings);

/// Evaluates `wanted` on `movies`; the first setting is the baseline of the comparison.
[[nodiscard]] Expected<Study> StudyMovies(std::vector<MovieWithTruth> movies, const std::vector<StudySetting>& wanted,
                                          const ExperimentSettings& settings);

/// Collects `value` of the findable objects over all settings; std::nullopt is skipped.
std::vector<double> CollectValues(const Study& study,
                                  const std::function<std::optional<double>(const ObjectResult&)>& value);

/// Describes the study in the notes of reports.
std::string DescribeStudy(const Study& study);

}  // namespace victorious
