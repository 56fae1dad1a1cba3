#include "victorious/jobs/index/between_frames.h"

#include <algorithm>
#include <cmath>

#include "victorious/geometry/box.h"

namespace victorious {
namespace {

Box Between(const Box& from, const Box& to, double part) {
  return {std::lerp(from.x, to.x, part), std::lerp(from.y, to.y, part), std::lerp(from.width, to.width, part),
          std::lerp(from.height, to.height, part)};
}

// The outline in another box, at the same place of it.
Polygon Moved(Polygon outline, const Box& from, const Box& to) {
  for (Eigen::Vector2d& corner : outline) {
    const Eigen::Vector2d place((corner.x() - from.x) / std::max(from.width, 1e-9),
                                (corner.y() - from.y) / std::max(from.height, 1e-9));
    corner = {to.x + place.x() * to.width, to.y + place.y() * to.height};
  }
  return outline;
}

}  // namespace

Similarity2 PartOfMotion(const Similarity2& motion, double part) {
  return {std::pow(motion.scale, part), part * motion.rotation_rad, part * motion.translation};
}

std::vector<SightingRecord> SightingsBetween(std::span<const SightingRecord> before,
                                             std::span<const SightingRecord> after, std::int64_t frame, double time_s) {
  std::vector<SightingRecord> sightings;
  for (const SightingRecord& first : before) {
    const auto last = std::ranges::find_if(after, [&](const SightingRecord& one) {
      return first.track && one.track == first.track && one.model == first.model;
    });
    if (last == after.end() || !(last->time_s > first.time_s)) continue;
    const double part = std::clamp((time_s - first.time_s) / (last->time_s - first.time_s), 0.0, 1.0);
    const SightingRecord& nearer = part < 0.5 ? first : *last;
    SightingRecord sighting = nearer;
    sighting.frame = frame;
    sighting.time_s = time_s;
    sighting.box = Between(first.box, last->box, part);
    sighting.outline = Moved(nearer.outline, nearer.box, sighting.box);
    sighting.score = std::min(first.score, last->score);
    sighting.source = SightingSource::kTracked;
    sighting.is_missed = false;
    sighting.matches = std::min(first.matches, last->matches);
    sighting.distance_m.reset();
    sighting.sigma_distance_m.reset();
    sighting.observation.reset();
    sightings.push_back(std::move(sighting));
  }
  return sightings;
}

}  // namespace victorious
