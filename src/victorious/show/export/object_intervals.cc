#include "victorious/show/export/object_intervals.h"

#include <optional>

namespace victorious {

Status VisitIntervals(const ExportRequest& request, std::int64_t object,
                      const std::function<void(const SightingRecord& sighting, bool begins)>& visit) {
  SightingFilter filter = request.filter;
  filter.object = object;
  std::optional<double> last_s;
  return request.store.VisitSightings(filter, [&](SightingRecord&& sighting) {
    if (request.catalogue.Video(sighting.video) == nullptr) return true;
    visit(sighting, !last_s || sighting.time_s - *last_s > kMaxGap_s);
    last_s = sighting.time_s;
    return true;
  });
}

}  // namespace victorious
