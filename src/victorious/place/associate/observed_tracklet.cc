#include "victorious/place/associate/observed_tracklet.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "victorious/base/median.h"
#include "victorious/place/associate/object_rejection.h"

namespace victorious {

void AddSighting(const SightingRecord& sighting, ObservedTracklet& tracklet) {
  tracklet.frames.push_back(sighting.frame);
  tracklet.boxes.push_back(sighting.box);
  if (sighting.is_missed) ++tracklet.missed;
  if (sighting.source != SightingSource::kRecognised) return;
  tracklet.scores.push_back(sighting.score);
  if (tracklet.is_cad_model && sighting.matches == 0) ++tracklet.by_shape;
  if (!sighting.view) return;
  const double level = std::sin(sighting.view->off_nadir_rad);
  tracklet.views.push_back(
      {.time_s = sighting.time_s,
       .direction = {level * std::cos(sighting.view->azimuth_rad), level * std::sin(sighting.view->azimuth_rad),
                     std::cos(sighting.view->off_nadir_rad)},
       .sigma_rad = sighting.sigma_view_rad});
}

TrackletSummary Summarise(const ObservedTracklet& tracklet) {
  std::vector<double> sizes_px;
  for (const Box& box : tracklet.boxes) sizes_px.push_back(std::max(box.width, box.height));
  TrackletSummary summary{.log_odds = SumLogOdds(tracklet.scores),
                          .recognitions = static_cast<std::int64_t>(tracklet.scores.size()),
                          .by_shape = tracklet.by_shape,
                          .missed = tracklet.missed,
                          .size_px = sizes_px.empty() ? 0 : Median(std::move(sizes_px)),
                          .observations = static_cast<std::int64_t>(tracklet.observations.size()),
                          .views = static_cast<std::int64_t>(tracklet.views.size())};
  for (std::size_t i = 0; i < tracklet.views.size(); ++i) {
    const SightingView& view = tracklet.views[i];
    summary.view_sum += view.direction;
    if (i == 0 || tracklet.is_of_photos || view.time_s - tracklet.views[i - 1].time_s > kMaxViewStep_s) continue;
    ++summary.view_steps;
    if (view.direction.dot(tracklet.views[i - 1].direction) < std::cos(kViewJump_rad)) ++summary.view_jumps;
  }
  return summary;
}

}  // namespace victorious
