// A tracklet as data association sees it.
#pragma once

#include <cstdint>
#include <vector>

#include "victorious/geometry/box.h"
#include "victorious/store/index_store.h"
#include "victorious/types/bearing_observation.h"

namespace victorious {

/// What association needs of the content of every tracklet.
struct TrackletSummary {
  double log_odds = 0;            ///< sum of the log odds of the recognised sightings
  std::int64_t recognitions = 0;  ///< their number
  std::int64_t observations = 0;  ///< number of bearing observations
};

/// A tracklet with its observations. Category tracklets form objects in the same way, but are never rejected and reject
/// no other object: a category sighting does not identify an instance.
struct ObservedTracklet {
  TrackletRecord record;
  bool is_category = false;
  bool is_cad_model = false;  ///< of a CAD model: opaque, so it occludes what is behind it
  bool is_of_photos = false;  ///< its times are invented: no motion follows from them

  // The content. Of a tracklet with kept fits it is read only if another fit needs it (kept_fits.h).
  std::vector<std::int64_t> frames;              ///< ascending
  std::vector<Box> boxes;                        ///< one per frame
  std::vector<double> scores;                    ///< scores of the recognised (not tracked) sightings
  std::vector<BearingObservation> observations;  ///< bearing observations, by time; only of sightings that have one

  TrackletSummary summary;
};

/// The summary of a tracklet with its content.
[[nodiscard]] TrackletSummary Summarise(const ObservedTracklet& tracklet);

}  // namespace victorious
