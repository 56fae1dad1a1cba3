#include "victorious/place/associate/search_counts.h"

#include <algorithm>
#include <set>

namespace victorious {
namespace {

constexpr double kHour_s = 3600;

}  // namespace

void SearchCounts::Add(std::int64_t video, std::int64_t searches, std::optional<double> duration_s) {
  Video& counted = of_video_[video];
  counted.searches += searches;
  counted.duration_s = std::max(counted.duration_s, duration_s.value_or(0));
}

double SearchCounts::TestsOf(const ObjectHypothesis& hypothesis) const {
  std::set<std::int64_t> videos;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) videos.insert(tracklet->record.video);
  double searches = 0;
  double duration_s = 0;
  for (const std::int64_t video : videos) {
    const auto counted = of_video_.find(video);
    if (counted == of_video_.end()) continue;
    searches += static_cast<double>(counted->second.searches);
    duration_s += counted->second.duration_s;
  }
  return duration_s > kHour_s ? searches * kHour_s / duration_s : searches;
}

}  // namespace victorious
