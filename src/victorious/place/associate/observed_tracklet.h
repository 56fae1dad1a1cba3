// A tracklet as data association sees it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/box.h"
#include "victorious/types/bearing_observation.h"
#include "victorious/types/index_records.h"

namespace victorious {

/// What association needs of the content of every tracklet.
struct TrackletSummary {
  double log_odds = 0;            ///< sum of the log odds of the recognised sightings
  std::int64_t recognitions = 0;  ///< their number
  std::int64_t by_shape = 0;      ///< those of them that were found by shape (DetectionCue)
  std::int64_t missed = 0;        ///< number of the tracked sightings that a search for their shape did not find
  double size_px = 0;             ///< median of the longer sides of all boxes
  std::int64_t observations = 0;  ///< number of bearing observations
  std::int64_t view_steps = 0;  ///< pairs of recognised sightings in a row, with views, less than kMaxViewStep_s apart
  std::int64_t view_jumps = 0;  ///< those of them whose views are more than kViewJump_rad apart
  /// Sum of the directions of view (unit vectors) of the recognised sightings: with their number it tells how far they
  /// spread.
  Eigen::Vector3d view_sum = Eigen::Vector3d::Zero();
  std::int64_t views = 0;  ///< number of recognised sightings with a view
};

/// The direction of view of a recognised sighting.
struct SightingView {
  double time_s = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit length, to the camera, in axes fixed to the object
  std::optional<double> sigma_rad;                       ///< SightingRecord::sigma_view_rad
};

/// No object turns so far before the camera in so short a time: one of two such views is wrong. Chosen: a car that
/// turns on the spot takes longer.
inline constexpr double kMaxViewStep_s = 2;
inline constexpr double kViewJump_rad = RadiansFromDegrees(50);

/// A tracklet with its observations. Category tracklets form objects in the same way, but are never rejected and reject
/// no other object: a category sighting does not identify an instance.
struct ObservedTracklet {
  TrackletRecord record;
  bool is_category = false;
  bool is_cad_model = false;  ///< of a CAD model: opaque, so it occludes what is behind it
  bool is_of_photos = false;  ///< its times are invented: no motion follows from them
  /// Its telemetry is that of a receiver that filters its rows, or may be: these say nothing of what is common to them.
  bool has_filtered_telemetry = true;
  double length_factor = 1;  ///< by which its model's length was found wrong (length_error.h): true over given
  std::optional<std::int64_t> start_utc_us;  ///< VideoRecord::start_utc_us of its video

  // The content. Of a tracklet with kept fits it is read only if another fit needs it (kept_fits.h).
  std::vector<std::int64_t> frames;              ///< ascending
  std::vector<Box> boxes;                        ///< one per frame
  std::vector<double> scores;                    ///< scores of the recognised (not tracked) sightings
  std::int64_t by_shape = 0;                     ///< number of the recognised sightings that were found by shape
  std::int64_t missed = 0;                       ///< number of the tracked ones that were searched for by shape in vain
  std::vector<SightingView> views;               ///< views of those that have one, by time
  std::vector<BearingObservation> observations;  ///< bearing observations, by time; only of sightings that have one
  std::vector<std::int64_t> observation_frames;  ///< one per observation, ascending

  TrackletSummary summary;
};

/// Adds the next sighting of the tracklet: its frame, box, and what it says of the search.
void AddSighting(const SightingRecord& sighting, ObservedTracklet& tracklet);

/// The summary of a tracklet with its content.
[[nodiscard]] TrackletSummary Summarise(const ObservedTracklet& tracklet);

}  // namespace victorious
