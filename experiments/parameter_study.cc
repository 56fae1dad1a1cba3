#include "experiments/parameter_study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/lab/evaluate/reported.h"

namespace victorious {
namespace {

// Movie, model, frame, box in hundredths of a pixel.
using SightingKey = std::tuple<std::string, std::string, std::int64_t, std::array<std::int64_t, 4>>;

struct SettingFindings {
  SettingResult studied;
  std::set<SightingKey> sightings;
};

SightingKey KeyOf(const std::string& movie, const ReportedSighting& sighting) {
  const auto hundredths = [](double px) { return std::llround(px * 100); };
  const Box& box = sighting.box;
  return {movie,
          sighting.model,
          sighting.frame,
          {hundredths(box.x), hundredths(box.y), hundredths(box.width), hundredths(box.height)}};
}

Expected<SettingFindings> EvaluateSetting(const std::vector<MovieWithTruth>& movies, const StudySetting& setting,
                                          const ExperimentSettings& settings) {
  SettingFindings found{.studied = {.name = setting.name, .of = setting.of, .objects = {}}, .sightings = {}};
  SettingResult& studied = found.studied;
  for (const MovieWithTruth& movie : movies) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto store, IndexMovie(movie, setting.options, settings));
    VICTORIOUS_ASSIGN_OR_RETURN(const ReportedContent reported, ReadReported(*store, {}));
    const Score score = ScoreIndex(movie.truth, reported.objects, reported.sightings);
    std::map<std::string, std::string> models;
    for (const TruthRow& row : movie.truth) models[row.object] = row.model;
    studied.findable += score.findable;
    studied.found += score.found;
    studied.false_objects += score.false_objects;
    for (const auto& [name, object] : score.per_object) {
      studied.objects.push_back({.movie = movie.name,
                                 .name = name,
                                 .model = models.at(name),
                                 .found = object.found,
                                 .density = object.density,
                                 .density_between = object.density_between,
                                 .ids = object.ids,
                                 .error_m = object.error_m});
    }
    for (const ReportedSighting& sighting : reported.sightings) found.sightings.insert(KeyOf(movie.name, sighting));
  }
  return found;
}

void Compare(const SettingFindings& baseline, SettingFindings& found) {
  std::vector<SightingKey> other;
  std::ranges::set_symmetric_difference(baseline.sightings, found.sightings, std::back_inserter(other));
  found.studied.changed_sightings = static_cast<int>(other.size());
  for (std::size_t i = 0; i < found.studied.objects.size(); ++i) {
    constexpr double kSameM = 1e-3;
    const std::optional<double>& before = baseline.studied.objects[i].error_m;
    const std::optional<double>& now = found.studied.objects[i].error_m;
    const bool same = before && now ? std::abs(*before - *now) < kSameM : before.has_value() == now.has_value();
    found.studied.changed_places += same ? 0 : 1;
  }
}

double ScaleValue(double value, double factor) { return value * factor; }

int ScaleValue(int value, double factor) {
  const int changed = static_cast<int>(std::lround(value * factor));
  if (changed != value) return changed;
  return factor < 1 ? value - 1 : value + 1;
}

// Returns a setting that owns its options, because the field references point into them.
StudySetting VaryParameter(const VariedParameter& parameter, double factor) {
  StudySetting setting{.name = {}, .of = parameter.of, .options = TrackingIndexOptions()};
  for (const FieldRef& field : CollectFields(setting.options)) {
    if (field.name != parameter.name) continue;
    if (auto* const* real = std::get_if<double*>(&field.value)) {
      **real = ScaleValue(**real, factor);
      setting.name = fmt::format("{} = {:.4g}", parameter.name, **real);
    } else if (auto* const* whole = std::get_if<int*>(&field.value)) {
      **whole = ScaleValue(**whole, factor);
      setting.name = fmt::format("{} = {}", parameter.name, **whole);
    }
  }
  VICTORIOUS_CHECK(!setting.name.empty());
  return setting;
}

}  // namespace

std::span<const VariedParameter> VariedParameters() {
  // `every` is the thesis's N and unconfirmed_frames its M; the thesis gives no values.
  static constexpr std::array kParameters = {
      VariedParameter{"features.contrast_threshold", "recogniser"},
      VariedParameter{"search.nearest", "recogniser"},
      VariedParameter{"detect.min_score", "recogniser"},
      VariedParameter{"every", "tracker"},
      VariedParameter{"follow.track.dilation_factor", "tracker"},
      VariedParameter{"follow.track.unconfirmed_frames", "tracker"},
      VariedParameter{"objects.merge_gate_sigma", "association"},
      VariedParameter{"objects.max_merge_distance_m", "association"},
      VariedParameter{"objects.min_inlier_fraction", "association"},
      VariedParameter{"objects.max_size_ratio", "association"},
      VariedParameter{"objects.locate.identity_radius_m", "geolocation"},
      VariedParameter{"objects.locate.distance_prior_allowance", "geolocation"},
      VariedParameter{"objects.locate.gate_sigma", "geolocation"},
      VariedParameter{"objects.locate.line.angle_deg", "geolocation"},
  };
  return kParameters;
}

std::vector<StudySetting> StudySettings() {
  std::vector<StudySetting> settings = {{.name = "default", .of = {}, .options = TrackingIndexOptions()}};
  for (const VariedParameter& parameter : VariedParameters()) {
    for (const double factor : {0.75, 1.25}) settings.push_back(VaryParameter(parameter, factor));
  }
  return settings;
}

double SettingResult::Recall() const { return findable > 0 ? static_cast<double>(found) / findable : 0; }

double SettingResult::Precision() const {
  const int reported = found + false_objects;
  return reported > 0 ? static_cast<double>(found) / reported : 0;
}

double SettingResult::IdsPerObject() const {
  double ids = 0;
  double shown = 0;
  for (const ObjectResult& object : objects) {
    ids += object.ids;
    shown += object.ids > 0 ? 1 : 0;
  }
  return shown > 0 ? ids / shown : 0;
}

Expected<Study> RunStudy(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<MovieWithTruth> movies,
                              SimulateScenes({"straight", "circle", "shaken"}, settings));
  return StudyMovies(std::move(movies), StudySettings(), settings);
}

Expected<Study> StudyMovies(std::vector<MovieWithTruth> movies, const std::vector<StudySetting>& wanted,
                            const ExperimentSettings& settings) {
  Study study{.movies = std::move(movies), .settings = {}};
  std::optional<SettingFindings> baseline;
  for (const StudySetting& setting : wanted) {
    settings.progress(fmt::format("{} of {} settings: {}", study.settings.size() + 1, wanted.size(), setting.name));
    VICTORIOUS_ASSIGN_OR_RETURN(SettingFindings found, EvaluateSetting(study.movies, setting, settings));
    if (!baseline) {
      baseline = found;
    } else {
      Compare(*baseline, found);
    }
    study.settings.push_back(std::move(found.studied));
  }
  return study;
}

std::vector<double> CollectValues(const Study& study,
                                  const std::function<std::optional<double>(const ObjectResult&)>& value) {
  std::vector<double> values;
  for (const SettingResult& setting : study.settings) {
    for (const ObjectResult& object : setting.objects) {
      if (const std::optional<double> one = value(object)) values.push_back(*one);
    }
  }
  return values;
}

std::string DescribeStudy(const Study& study) {
  return fmt::format(
      "Movies: {}; exact telemetry. Settings: the program's defaults except for a whole-frame search in every {}th "
      "frame, between which objects are tracked, and {} parameters of recogniser, tracker, association and "
      "geolocation, each times 0.75 and times 1.25 (integers by at least 1). Each setting runs its own search; only "
      "for the parameters objects.*, which take effect after the search, the data association runs again on the "
      "default's sightings.",
      DescribeMovies(study.movies), TrackingIndexOptions().every, VariedParameters().size());
}

}  // namespace victorious
