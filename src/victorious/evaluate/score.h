// evaluate/, in: what was reported (objects best first, and their sightings) and what is true. Out: how good it is.
//
// A true object is findable when at least 10 of its rows are clear: visible >= 0.5 and a shorter box side >= 24 px.
// Sightings are paired with truth one to one within a frame and a model, best score first, at an overlap (IoU) >= 0.4.
// A paired sighting of a clear row is right; an unpaired one is wrong; one of a row that is not clear counts neither
// way. A reported object claims the true object that more than half of its sightings show. It is found when nothing
// ranked better claimed the same and that object is findable; it is false when it claims nothing, or what is claimed
// already. Its place is compared with the truth at the time nearest to the place's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "victorious/evaluate/truth.h"
#include "victorious/geometry/box.h"
#include "victorious/types/object_model.h"
#include "victorious/types/place.h"

namespace victorious {

/// A sighting that the program reports.
struct ReportedSighting {
  std::int64_t object = 0;  ///< the reported object's id
  std::int64_t frame = 0;
  std::string model;
  Box box;  ///< px
  double score = 0;
  std::optional<ViewAngles> view;
};

/// An object that the program reports.
struct ReportedObject {
  std::int64_t id = 0;
  std::optional<Place> place;
  std::optional<double> heading_rad;  ///< of its front, clockwise from north
};

/// Whether a row can be asked for: enough of the object is in view, and large enough. Others count neither way.
[[nodiscard]] bool IsClear(const TruthRow& row);

/// The row that each sighting shows, an index into `truth`, one to one; nothing: the sighting is wrong.
[[nodiscard]] std::vector<std::optional<std::size_t>> PairSightings(std::span<const TruthRow> truth,
                                                                    std::span<const ReportedSighting> sightings);

/// The angle between two directions to the camera.
[[nodiscard]] double AngleBetween(const ViewAngles& a, const ViewAngles& b);

/// Interpolated between the nearest two of the sorted values; nothing for none.
[[nodiscard]] std::optional<double> Percentile(std::vector<double> values, double percent);

/// Ratios are 0 to 1, and not there where nothing was asked for (their divisor is 0).
struct Score {
  int findable = 0;       ///< true objects
  int found = 0;          ///< of these
  int false_objects = 0;  ///< reported ones, duplicates included
  std::optional<double> recall;
  std::optional<double> precision;
  std::optional<double>
      average_precision;                  ///< mean over 101 recall levels of the best precision at that recall or more
  std::optional<double> sighting_recall;  ///< clear rows of findable objects that any reported object shows
  std::optional<double> sighting_precision;  ///< right over right and wrong
  /// Of a findable object: its clear rows shown by the reported object that claimed it, over all of them. Quartiles.
  std::optional<double> density_p25;
  std::optional<double> density_p50;
  std::optional<double> density_p75;
  std::optional<double> ids_per_object;  ///< mean number of reported objects that show a findable one, of those shown
  /// The angle between the true direction to the camera and the reported one, over the paired sightings that know both.
  std::optional<double> view_error_p50_rad;
  std::optional<double> view_error_p90_rad;

  int located = 0;  ///< found objects whose place is reported and known
  /// Of these, the error along the ground that holds so many percent.
  std::optional<double> cep50_m;
  std::optional<double> cep75_m;
  std::optional<double> cep90_m;
  std::optional<double> error3d_p50_m;
  std::optional<double> inside_90_ellipsoid;  ///< the share whose truth is in the 90 % ellipsoid
  std::optional<double> inside_ce90;          ///< the share whose truth is within CE90 along the ground
  std::optional<double> heading_error_p50_rad;

  struct Object {
    bool found = false;
    double density = 0;
    double density_between = 0;  ///< the same of its clear rows from the first to the last frame so shown
    int ids = 0;
    std::optional<double> error_m;  ///< along the ground
  };
  std::map<std::string, Object> per_object;  ///< the findable ones
};

/// @param objects    the reported objects, best first
/// @param sightings  of one video, in any order (of two equally scored on one object, the first given is paired)
/// O(n log n) in sightings and truth rows, for a bounded number of objects of one model in a frame.
Score ScoreIndex(std::span<const TruthRow> truth, std::span<const ReportedObject> objects,
                 std::span<const ReportedSighting> sightings);

/// The keys of the acceptance scorer in its order; what is not known as null.
nlohmann::ordered_json ToJson(const Score& score);

/// The same keys as aligned lines, then a line a findable object.
std::string ToText(const Score& score);

}  // namespace victorious
