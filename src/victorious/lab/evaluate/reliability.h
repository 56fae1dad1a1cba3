// Whether the scores of reported objects can be believed. In: reported objects with their scores, and truth. Out: which
// objects are right, and how well the scores say so.
//
// An object is right if more than half of its sightings show one true object of its model (pairs as in score.h). A
// second report of the same true object is right, too: it is that model.
//
//   calibration error = sum_b n_b / n |mean score in b - fraction right in b|,  b: ten bins of equal width
//   Brier score       = mean (score - right)^2
//   separation        = P(a right object has a higher score than a wrong one), ties count one half (area under the ROC)
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "victorious/lab/evaluate/score.h"
#include "victorious/lab/evaluate/truth.h"

namespace victorious {

/// A reported object, its score, and whether it is right.
struct JudgedObject {
  std::int64_t id = 0;
  std::string model;
  double score = 0;
  bool is_right = false;
};

/// @param sightings  of one video; the model of an object is that of its sightings
/// @return one per object that has a sighting, in the order of `objects`
[[nodiscard]] std::vector<JudgedObject> JudgeObjects(std::span<const TruthRow> truth,
                                                     std::span<const ReportedObject> objects,
                                                     std::span<const ReportedSighting> sightings);

/// Values are std::nullopt where they need objects that there are not.
struct Reliability {
  int right = 0;
  int wrong = 0;
  std::optional<double> mean_score_right;
  std::optional<double> mean_score_wrong;
  std::optional<double> calibration_error;
  std::optional<double> brier;
  std::optional<double> separation;
};

[[nodiscard]] Reliability MeasureReliability(std::span<const JudgedObject> objects);

/// The keys are the names of the fields; `objects` lists the judged objects.
nlohmann::ordered_json ToJson(const Reliability& reliability, std::span<const JudgedObject> objects);

/// The same keys as aligned lines of text, then one line per object.
std::string ToText(const Reliability& reliability, std::span<const JudgedObject> objects);

}  // namespace victorious
