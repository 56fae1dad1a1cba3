#include "victorious/lab/evaluate/reliability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"

namespace victorious {
namespace {

constexpr std::size_t kBins = 10;

std::optional<double> Mean(double sum, int count) { return count > 0 ? std::optional(sum / count) : std::nullopt; }

double CalibrationError(std::span<const JudgedObject> objects) {
  struct Bin {
    double scores = 0;
    double right = 0;
  };
  std::array<Bin, kBins> bins;
  for (const JudgedObject& object : objects) {
    Bin& bin = bins[std::min(static_cast<std::size_t>(object.score * kBins), kBins - 1)];
    bin.scores += object.score;
    bin.right += object.is_right ? 1 : 0;
  }
  double error = 0;
  for (const Bin& bin : bins) error += std::abs(bin.scores - bin.right);
  return error / static_cast<double>(objects.size());
}

// By ranks (Mann and Whitney); O(n log n).
double Separation(std::span<const JudgedObject> objects, int right, int wrong) {
  std::vector<double> of_right;
  std::vector<double> of_wrong;
  for (const JudgedObject& object : objects) (object.is_right ? of_right : of_wrong).push_back(object.score);
  std::ranges::sort(of_wrong);
  double higher = 0;
  for (const double score : of_right) {
    const auto [below, not_above] = std::ranges::equal_range(of_wrong, score);
    higher += static_cast<double>(below - of_wrong.begin()) + static_cast<double>(not_above - below) / 2;
  }
  return higher / (static_cast<double>(right) * wrong);
}

}  // namespace

std::vector<JudgedObject> JudgeObjects(std::span<const TruthRow> truth, std::span<const ReportedObject> objects,
                                       std::span<const ReportedSighting> sightings) {
  struct Votes {
    std::string_view model;
    int sightings = 0;
    std::map<std::string_view, int> of_true_object;
  };
  std::map<std::int64_t, Votes> votes;  // by reported object
  const std::vector<std::optional<std::size_t>> rows = PairSightings(truth, sightings);
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    Votes& own = votes[sightings[i].object];
    own.model = sightings[i].model;
    ++own.sightings;
    if (rows[i]) ++own.of_true_object[truth[*rows[i]].object];
  }
  std::vector<JudgedObject> judged;
  for (const ReportedObject& object : objects) {
    const auto found = votes.find(object.id);
    if (found == votes.end()) continue;
    const Votes& own = found->second;
    const bool is_right =
        std::ranges::any_of(own.of_true_object, [&](const auto& shown) { return 2 * shown.second > own.sightings; });
    judged.push_back({object.id, std::string(own.model), object.score, is_right});
  }
  return judged;
}

Reliability MeasureReliability(std::span<const JudgedObject> objects) {
  Reliability reliability;
  double score_right = 0;
  double score_wrong = 0;
  double squares = 0;
  for (const JudgedObject& object : objects) {
    ++(object.is_right ? reliability.right : reliability.wrong);
    (object.is_right ? score_right : score_wrong) += object.score;
    squares += std::pow(object.score - (object.is_right ? 1 : 0), 2);
  }
  reliability.mean_score_right = Mean(score_right, reliability.right);
  reliability.mean_score_wrong = Mean(score_wrong, reliability.wrong);
  reliability.brier = Mean(squares, reliability.right + reliability.wrong);
  if (!objects.empty()) reliability.calibration_error = CalibrationError(objects);
  if (reliability.right > 0 && reliability.wrong > 0)
    reliability.separation = Separation(objects, reliability.right, reliability.wrong);
  return reliability;
}

nlohmann::ordered_json ToJson(const Reliability& reliability, std::span<const JudgedObject> objects) {
  nlohmann::ordered_json json = {{"right", reliability.right},
                                 {"wrong", reliability.wrong},
                                 {"mean_score_right", OrNull(reliability.mean_score_right)},
                                 {"mean_score_wrong", OrNull(reliability.mean_score_wrong)},
                                 {"calibration_error", OrNull(reliability.calibration_error)},
                                 {"brier", OrNull(reliability.brier)},
                                 {"separation", OrNull(reliability.separation)},
                                 {"objects", nlohmann::ordered_json::array()}};
  for (const JudgedObject& object : objects) {
    json["objects"].push_back(
        {{"object_id", object.id}, {"model", object.model}, {"score", object.score}, {"right", object.is_right}});
  }
  return json;
}

std::string ToText(const Reliability& reliability, std::span<const JudgedObject> objects) {
  std::string text;
  const auto add = [&](std::string_view name, const std::optional<double>& value) {
    text += fmt::format("{:24} {:>8}\n", name, value ? fmt::format("{:.4f}", *value) : "-");
  };
  text += fmt::format("{:24} {:>8}\n{:24} {:>8}\n", "right", reliability.right, "wrong", reliability.wrong);
  add("mean_score_right", reliability.mean_score_right);
  add("mean_score_wrong", reliability.mean_score_wrong);
  add("calibration_error", reliability.calibration_error);
  add("brier", reliability.brier);
  add("separation", reliability.separation);
  for (const JudgedObject& object : objects) {
    text += fmt::format("  {:>5} {:22} {:>8.3f}   {}\n", object.id, object.model, object.score,
                        object.is_right ? "right" : "wrong");
  }
  return text;
}

}  // namespace victorious
