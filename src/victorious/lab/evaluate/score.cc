#include "victorious/lab/evaluate/score.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <functional>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/base/text.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/view_direction.h"
#include "victorious/lab/evaluate/place_score.h"

namespace victorious {
namespace {

constexpr double kClearVisible = 0.5;
constexpr double kClearSidePx = 24;
constexpr std::size_t kFindableRows = 10;
constexpr double kPairedOverlap = 0.4;

constexpr int kNoObject = -1;  // the object of a sighting without a pair

std::optional<double> Ratio(double part, double whole) {
  return whole > 0 ? std::optional(part / whole) : std::nullopt;
}

/// A true object.
struct TrueObject {
  std::string name;
  std::vector<std::int64_t> clear_frames;  ///< one per clear row

  [[nodiscard]] bool IsFindable() const { return clear_frames.size() >= kFindableRows; }
};

/// The truth with its objects numbered and its rows indexed by frame and model.
class TruthTable {
 public:
  explicit TruthTable(std::span<const TruthRow> rows)
      : rows_(rows), object_of_row_(rows.size()), slot_of_row_(rows.size()), by_frame_(rows.size()) {
    std::unordered_map<std::string_view, int> numbers;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto [at, added] = numbers.emplace(rows[i].object, static_cast<int>(objects_.size()));
      if (added) objects_.push_back({rows[i].object, {}});
      object_of_row_[i] = at->second;
      if (IsClear(rows[i])) objects_[at->second].clear_frames.push_back(rows[i].frame);
    }
    NumberSlots();
    std::iota(by_frame_.begin(), by_frame_.end(), std::size_t{0});
    std::ranges::stable_sort(by_frame_, {}, [&](std::size_t i) { return KeyOf(rows_[i]); });
  }

  [[nodiscard]] const std::vector<TrueObject>& objects() const { return objects_; }
  [[nodiscard]] const TruthRow& row(std::size_t i) const { return rows_[i]; }
  [[nodiscard]] int ObjectOf(std::size_t row) const { return object_of_row_[row]; }

  /// The object's row nearest in time to the place; its middle row without a place.
  [[nodiscard]] const TruthRow& RowAtTimeOf(int object, const std::optional<Geolocation>& place) const {
    std::vector<const TruthRow*> own;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (object_of_row_[i] == object) own.push_back(&rows_[i]);
    }
    if (!place) return *own[own.size() / 2];
    return **std::ranges::min_element(own, {},
                                      [&](const TruthRow* row) { return std::abs(row->time_s - place->time_s); });
  }

  /// Returns the unassigned row with the maximum overlap of at least kPairedOverlap, and marks it as assigned.
  std::optional<std::size_t> AssignRow(const ReportedSighting& sighting) {
    std::optional<std::size_t> best;
    double best_overlap = 0;
    for (const std::size_t i :
         std::ranges::equal_range(by_frame_, std::pair(sighting.frame, std::string_view(sighting.model)), {},
                                  [&](std::size_t row) { return KeyOf(rows_[row]); })) {
      const double overlap = IntersectionOverUnion(rows_[i].box, sighting.box);
      if (overlap < kPairedOverlap || overlap <= best_overlap || assigned_[slot_of_row_[i]]) continue;
      best = i;
      best_overlap = overlap;
    }
    if (best) assigned_[slot_of_row_[*best]] = true;
    return best;
  }

 private:
  static std::pair<std::int64_t, std::string_view> KeyOf(const TruthRow& row) { return {row.frame, row.model}; }

  /// Numbers the slots: one per object and frame, also if several rows describe it.
  void NumberSlots() {
    std::vector<std::size_t> order(rows_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key = [&](std::size_t i) { return std::pair(rows_[i].frame, object_of_row_[i]); };
    std::ranges::sort(order, {}, key);
    for (std::size_t k = 0; k < order.size(); ++k) {
      if (k == 0 || key(order[k]) != key(order[k - 1])) assigned_.push_back(false);
      slot_of_row_[order[k]] = assigned_.size() - 1;
    }
  }

  std::span<const TruthRow> rows_;
  std::vector<TrueObject> objects_;
  std::vector<int> object_of_row_;
  std::vector<std::size_t> slot_of_row_;
  std::vector<std::size_t> by_frame_;  ///< rows sorted by frame and model (stable)
  std::vector<bool> assigned_;         ///< whether each slot is assigned
};

/// The true object that a sighting of a reported object shows, or kNoObject.
struct Vote {
  std::int64_t reported;
  int shown;
  auto operator<=>(const Vote&) const = default;
};

/// A frame in which a reported object shows a true object.
struct Hit {
  int shown;
  std::int64_t reported;
  std::int64_t frame;
  auto operator<=>(const Hit&) const = default;
};

/// The result of pairing sightings with truth. Votes and hits are sorted.
struct Pairing {
  std::vector<Vote> votes;  ///< one per sighting
  std::vector<Hit> hits;    ///< unique
  int right = 0;
  int wrong = 0;
  std::vector<double> view_errors_rad;
};

/// Pairs each sighting with a row, in the order of falling scores.
std::vector<std::optional<std::size_t>> AssignRows(TruthTable& truth, std::span<const ReportedSighting> sightings) {
  std::vector<std::size_t> order(sightings.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t i) { return sightings[i].score; });
  std::vector<std::optional<std::size_t>> rows(sightings.size());
  for (const std::size_t i : order) rows[i] = truth.AssignRow(sightings[i]);
  return rows;
}

Pairing PairWithTruth(TruthTable& truth, std::span<const ReportedSighting> sightings) {
  const std::vector<std::optional<std::size_t>> rows = AssignRows(truth, sightings);
  Pairing pairing;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const ReportedSighting& sighting = sightings[i];
    const auto taken = rows[i];
    const int shown = taken ? truth.ObjectOf(*taken) : kNoObject;
    pairing.votes.push_back({sighting.object, shown});
    if (!taken) {
      ++pairing.wrong;
      continue;
    }
    const TruthRow& row = truth.row(*taken);
    pairing.hits.push_back({shown, sighting.object, sighting.frame});
    if (IsClear(row)) ++pairing.right;
    if (sighting.view && row.view) pairing.view_errors_rad.push_back(AngleBetween(*sighting.view, *row.view));
  }
  std::ranges::sort(pairing.votes);
  std::ranges::sort(pairing.hits);
  const auto repeated = std::ranges::unique(pairing.hits);
  pairing.hits.erase(repeated.begin(), repeated.end());
  return pairing;
}

/// The true object that more than half of the reported object's sightings show; kNoObject if there is none. A majority
/// always includes the middle of the sorted votes.
int FindMajorityObject(std::int64_t reported, const std::vector<Vote>& votes) {
  const auto own = std::ranges::equal_range(votes, reported, {}, &Vote::reported);
  if (own.empty()) return kNoObject;
  const int middle = own[own.size() / 2].shown;
  const auto same = std::ranges::equal_range(own, middle, {}, &Vote::shown);
  return same.size() * 2 > own.size() ? middle : kNoObject;
}

/// Precision and recall after the first n reported objects that are not ignored.
struct CurvePoint {
  double recall;
  double precision;
};

double AveragePrecision(const std::vector<CurvePoint>& curve) {
  constexpr int kLevels = 100;
  double sum = 0;
  double best = 0;
  auto next = curve.rbegin();  // recall never falls along the curve
  for (int level = kLevels; level >= 0; --level) {
    for (; next != curve.rend() && next->recall >= static_cast<double>(level) / kLevels - 1e-9; ++next) {
      best = std::max(best, next->precision);
    }
    sum += best;
  }
  return sum / (kLevels + 1);
}

/// Assigns reported objects to true objects and fills the object counts of `score`. Returns the id of the reported
/// object that is assigned to each true object, by the number of the true object.
std::unordered_map<int, std::int64_t> ScoreObjects(const TruthTable& truth, std::span<const ReportedObject> objects,
                                                   const std::vector<Vote>& votes, Score& score,
                                                   std::map<std::string, PlaceError>& place_errors) {
  std::unordered_map<int, std::int64_t> assigned_ids;
  std::vector<CurvePoint> curve;
  for (const ReportedObject& object : objects) {
    const int shown = FindMajorityObject(object.id, votes);
    if (shown == kNoObject || !assigned_ids.emplace(shown, object.id).second) {
      ++score.false_objects;
    } else if (truth.objects()[shown].IsFindable()) {
      ++score.found;
      place_errors.emplace(truth.objects()[shown].name,
                           ComputePlaceError(object.place, object.heading_rad, truth.RowAtTimeOf(shown, object.place)));
    } else {
      continue;  // a true object that is not findable: ignored
    }
    const double counted = score.found + score.false_objects;
    curve.push_back(
        {score.findable > 0 ? score.found / static_cast<double>(score.findable) : 0.0, score.found / counted});
  }
  score.recall = Ratio(score.found, score.findable);
  score.precision = Ratio(score.found, score.found + score.false_objects);
  if (score.findable > 0) score.average_precision = AveragePrecision(curve);
  return assigned_ids;
}

/// Scores the frames in which the findable objects are shown: density, sighting recall and ids.
void ScoreCoverage(const TruthTable& truth, const std::unordered_map<int, std::int64_t>& assigned_ids,
                   const std::vector<Hit>& hits, Score& score) {
  std::vector<double> densities;
  double clear_rows = 0;
  double shown = 0;
  double ids = 0;
  double shown_objects = 0;
  for (int number = 0; number < static_cast<int>(truth.objects().size()); ++number) {
    const TrueObject& object = truth.objects()[number];
    if (!object.IsFindable()) continue;
    const auto own = std::ranges::equal_range(hits, number, {}, &Hit::shown);
    Score::Object entry;
    std::unordered_set<std::int64_t> frames;
    std::unordered_set<std::int64_t> assigned_frames;
    std::unordered_set<std::int64_t> reported;
    const auto assigned_id = assigned_ids.find(number);
    entry.found = assigned_id != assigned_ids.end();
    for (const Hit& hit : own) {
      frames.insert(hit.frame);
      reported.insert(hit.reported);
      if (entry.found && hit.reported == assigned_id->second) assigned_frames.insert(hit.frame);
    }
    const auto covered = [&](const std::unordered_set<std::int64_t>& by) {
      return static_cast<double>(
          std::ranges::count_if(object.clear_frames, [&](std::int64_t frame) { return by.contains(frame); }));
    };
    entry.density = covered(assigned_frames) / static_cast<double>(object.clear_frames.size());
    if (!assigned_frames.empty()) {
      const auto [first, last] = std::ranges::minmax(assigned_frames);
      const auto between = std::ranges::count_if(object.clear_frames,
                                                 [&](std::int64_t frame) { return frame >= first && frame <= last; });
      if (between > 0) entry.density_between = covered(assigned_frames) / static_cast<double>(between);
    }
    entry.ids = static_cast<int>(reported.size());
    densities.push_back(entry.density);
    clear_rows += static_cast<double>(object.clear_frames.size());
    shown += covered(frames);
    ids += entry.ids;
    shown_objects += entry.ids > 0;
    score.per_object.emplace(object.name, entry);
  }
  score.sighting_recall = Ratio(shown, clear_rows);
  score.density_p25 = Percentile(densities, 25);
  score.density_p50 = Percentile(densities, 50);
  score.density_p75 = Percentile(densities, 75);
  score.ids_per_object = Ratio(ids, shown_objects);
}

/// Scores the places of the found objects.
void ScorePlaces(const std::map<std::string, PlaceError>& errors, Score& score) {
  std::vector<double> horizontal_error_m;
  std::vector<double> spatial_error_m;
  std::vector<double> headings_rad;
  double in_ellipsoid = 0;
  double in_ce90 = 0;
  for (const auto& [name, error] : errors) {
    if (error.heading_rad) headings_rad.push_back(*error.heading_rad);
    if (!error.horizontal_error_m) continue;
    score.per_object.at(name).error_m = error.horizontal_error_m;
    horizontal_error_m.push_back(*error.horizontal_error_m);
    spatial_error_m.push_back(*error.spatial_error_m);
    in_ellipsoid += error.in_ellipsoid ? 1 : 0;
    in_ce90 += error.in_ce90 ? 1 : 0;
  }
  score.located = static_cast<int>(horizontal_error_m.size());
  score.cep50_m = Percentile(horizontal_error_m, 50);
  score.cep75_m = Percentile(horizontal_error_m, 75);
  score.cep90_m = Percentile(horizontal_error_m, 90);
  score.error3d_p50_m = Percentile(spatial_error_m, 50);
  score.inside_90_ellipsoid = Ratio(in_ellipsoid, score.located);
  score.inside_ce90 = Ratio(in_ce90, score.located);
  score.heading_error_p50_rad = Percentile(headings_rad, 50);
}

std::optional<double> ToDegrees(const std::optional<double>& radians) {
  return radians ? std::optional(DegreesFromRadians(*radians)) : std::nullopt;
}

/// Rounds to the decimal value that is printed.
double ToThreeDecimals(double value) { return ParseNumber(fmt::format("{:.3f}", value)).value_or(value); }

}  // namespace

bool IsClear(const TruthRow& row) {
  return row.visible >= kClearVisible && std::min(row.box.width, row.box.height) >= kClearSidePx;
}

std::optional<double> Percentile(std::vector<double> values, double percent) {
  if (values.empty()) return std::nullopt;
  std::ranges::sort(values);
  const double at = static_cast<double>(values.size() - 1) * percent / 100;
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (values[above] - values[below]) * (at - static_cast<double>(below));
}

std::vector<std::optional<std::size_t>> PairSightings(std::span<const TruthRow> truth,
                                                      std::span<const ReportedSighting> sightings) {
  TruthTable table(truth);
  return AssignRows(table, sightings);
}

Score ScoreIndex(std::span<const TruthRow> truth, std::span<const ReportedObject> objects,
                 std::span<const ReportedSighting> sightings) {
  TruthTable table(truth);
  const Pairing pairing = PairWithTruth(table, sightings);
  Score score;
  score.findable = static_cast<int>(std::ranges::count_if(table.objects(), &TrueObject::IsFindable));
  std::map<std::string, PlaceError> place_errors;
  const auto assigned_ids = ScoreObjects(table, objects, pairing.votes, score, place_errors);
  ScoreCoverage(table, assigned_ids, pairing.hits, score);
  ScorePlaces(place_errors, score);
  score.sighting_precision = Ratio(pairing.right, pairing.right + pairing.wrong);
  score.view_error_p50_rad = Percentile(pairing.view_errors_rad, 50);
  score.view_error_p90_rad = Percentile(pairing.view_errors_rad, 90);
  return score;
}

nlohmann::ordered_json ToJson(const Score& score) {
  nlohmann::ordered_json json;
  json["findable"] = score.findable;
  json["found"] = score.found;
  json["false_objects"] = score.false_objects;
  json["recall"] = OrNull(score.recall);
  json["precision"] = OrNull(score.precision);
  json["average_precision"] = OrNull(score.average_precision);
  json["sighting_recall"] = OrNull(score.sighting_recall);
  json["sighting_precision"] = OrNull(score.sighting_precision);
  json["density_p25"] = OrNull(score.density_p25);
  json["density_p50"] = OrNull(score.density_p50);
  json["density_p75"] = OrNull(score.density_p75);
  json["ids_per_object"] = OrNull(score.ids_per_object);
  json["located"] = score.located;
  json["cep50_m"] = OrNull(score.cep50_m);
  json["cep75_m"] = OrNull(score.cep75_m);
  json["cep90_m"] = OrNull(score.cep90_m);
  json["error3d_p50_m"] = OrNull(score.error3d_p50_m);
  json["inside_90_ellipsoid"] = OrNull(score.inside_90_ellipsoid);
  json["inside_ce90"] = OrNull(score.inside_ce90);
  json["heading_error_p50_deg"] = OrNull(ToDegrees(score.heading_error_p50_rad));
  json["view_error_p50_deg"] = OrNull(ToDegrees(score.view_error_p50_rad));
  json["view_error_p90_deg"] = OrNull(ToDegrees(score.view_error_p90_rad));
  json["per_object"] = nlohmann::ordered_json::object();
  for (const auto& [name, object] : score.per_object) {
    json["per_object"][name] = {{"found", object.found},
                                {"density", ToThreeDecimals(object.density)},
                                {"ids", object.ids},
                                {"error_m", object.error_m ? nlohmann::ordered_json(ToThreeDecimals(*object.error_m))
                                                           : nlohmann::ordered_json(nullptr)}};
  }
  return json;
}

std::string ToText(const Score& score) {
  std::string text;
  const nlohmann::ordered_json json = ToJson(score);
  for (const auto& [key, value] : json.items()) {
    if (value.is_object()) continue;
    const std::string shown = value.is_null()           ? "-"
                              : value.is_number_float() ? fmt::format("{:.4f}", value.get<double>())
                                                        : DumpJson(value);
    text += fmt::format("{:24} {:>8}\n", key, shown);
  }
  for (const auto& [name, object] : score.per_object) {
    const std::string error = object.error_m ? fmt::format("   error {:.2f} m", *object.error_m) : "";
    text += fmt::format("  {:22} {:>8}   density {:.3f}   ids {}{}\n", name, object.found ? "found" : "missed",
                        object.density, object.ids, error);
  }
  return text;
}

}  // namespace victorious
