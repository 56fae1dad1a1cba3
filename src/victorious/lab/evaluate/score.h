// Scores an index against ground truth. In: reported objects (best first) with their sightings, and truth rows. Out:
// precision, recall, average precision, frame density, and the errors of place, heading and view.
//
// Definitions:
// - A truth row is clear if visible >= 0.5 and the shorter side of its box is >= 24 px.
// - A true object is findable if at least 10 of its rows are clear.
// - Sightings are paired with truth rows greedily, one to one, within a frame and a model, best score first, at an
//   overlap (IoU) >= 0.4. A pair with a clear row is a true positive. An unpaired sighting is a false positive. A pair
//   with a row that is not clear is ignored.
// - A reported object is assigned to the true object that more than half of its sightings show. A true object is found
//   by its best-ranked reported object. A reported object is false if it has no assignment or if a better-ranked
//   object has the same one. Objects that are assigned to a true object that is not findable are ignored.
// - A reported place is compared with the truth row nearest in time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "victorious/geometry/box.h"
#include "victorious/lab/evaluate/truth.h"
#include "victorious/types/geolocation.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// One reported detection of a model in a frame.
struct ReportedSighting {
  std::int64_t object = 0;  ///< the reported object's id
  std::int64_t frame = 0;
  std::string model;
  Box box;  ///< px
  double score = 0;
  std::optional<ViewDirection> view;
};

/// One reported object.
struct ReportedObject {
  std::int64_t id = 0;
  std::optional<Geolocation> place;
  std::optional<double> heading_rad;  ///< of its front, clockwise from north
  double score = 0;                   ///< only reliability.h reads it: the order of objects is that of the list
};

/// Whether enough of the object is visible (>= 0.5) and its box is large enough (shorter side >= 24 px). Other rows are
/// ignored in the scores of sightings.
[[nodiscard]] bool IsClear(const TruthRow& row);

/// Returns for each sighting the index of its paired row in `truth`, one to one; std::nullopt: a false positive.
[[nodiscard]] std::vector<std::optional<std::size_t>> PairSightings(std::span<const TruthRow> truth,
                                                                    std::span<const ReportedSighting> sightings);

/// Linear interpolation between the two nearest sorted values; std::nullopt for an empty vector.
/// @param percent  0 to 100
[[nodiscard]] std::optional<double> Percentile(std::vector<double> values, double percent);

/// Ratios are 0 to 1; std::nullopt if the divisor is 0.
struct Score {
  int findable = 0;       ///< findable true objects
  int found = 0;          ///< findable true objects that are found
  int false_objects = 0;  ///< false reported objects, duplicates included
  std::optional<double> recall;
  std::optional<double> precision;
  std::optional<double>
      average_precision;  ///< mean over 101 recall levels of the maximum precision at that recall or higher (COCO)
  std::optional<double> sighting_recall;  ///< fraction of the clear rows of findable objects paired with any sighting
  std::optional<double> sighting_precision;  ///< true positives over true and false positives
  /// Density of a findable object: the fraction of its clear rows that its assigned reported object shows. Quartiles
  /// over the findable objects.
  std::optional<double> density_p25;
  std::optional<double> density_p50;
  std::optional<double> density_p75;
  std::optional<double> ids_per_object;  ///< mean number of reported objects per findable object that any shows
  /// The angle between the true and the reported direction to the camera, over the paired sightings that have both.
  std::optional<double> view_error_p50_rad;
  std::optional<double> view_error_p90_rad;

  int located = 0;  ///< found objects that have both a reported and a true place
  /// Circular error probable: percentiles of the horizontal error of the located objects.
  std::optional<double> cep50_m;
  std::optional<double> cep75_m;
  std::optional<double> cep90_m;
  std::optional<double> error3d_p50_m;
  std::optional<double> inside_90_ellipsoid;  ///< fraction whose truth lies in the 90 % ellipsoid
  std::optional<double> inside_ce90;          ///< fraction whose horizontal error is at most CE90
  std::optional<double> heading_error_p50_rad;

  struct Object {
    bool found = false;
    double density = 0;
    double density_between = 0;     ///< the same over its clear rows from the first to the last frame so shown
    int ids = 0;                    ///< reported objects that show it
    std::optional<double> error_m;  ///< horizontal
  };
  std::map<std::string, Object> per_object;  ///< the findable objects, by name
};

/// Scores the index of one video.
/// @param objects    the reported objects, best first
/// @param sightings  of one video, in any order; of two with the same score on one object, the first one is paired
/// Cost: O(n log n) in sightings and truth rows, for a bounded number of objects of one model in a frame.
Score ScoreIndex(std::span<const TruthRow> truth, std::span<const ReportedObject> objects,
                 std::span<const ReportedSighting> sightings);

/// Returns the keys of the acceptance scorer (tools/score.py of the data), in its order; unknown values are null.
/// Angles are in degrees.
nlohmann::ordered_json ToJson(const Score& score);

/// Returns the same keys as aligned lines of text, then one line per findable object.
std::string ToText(const Score& score);

}  // namespace victorious
