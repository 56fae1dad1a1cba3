#include "victorious/jobs/index/category_sightings.h"

#include <fmt/format.h>

#include "victorious/place/observe/bearing_observation.h"
#include "victorious/place/observe/object_pose.h"

namespace victorious {

SightingRecord CategorySighting(const IndexPass& pass, const Frame& frame, const std::optional<CameraState>& camera,
                                const FoundCategory& found) {
  const CameraState known = camera.value_or(CameraState{});
  const auto object_pose = EstimateBoxDirection(found.box, frame.image.size(), known, kCategoryCentreFraction);
  return {.video = pass.video.id,
          .model = *pass.category_ids[found.category],
          .frame = frame.index,
          .time_s = frame.time_s,
          .box = found.box,
          .score = found.probability,
          .source = found.is_tracked ? SightingSource::kTracked : SightingSource::kRecognised,
          .track = found.track,
          .observation = object_pose ? MakeBearingObservation(*object_pose, known) : std::nullopt};
}

void TellOfDetector(const IndexPass& pass, const VideoInfo& info) {
  if (!pass.job.inform || pass.categories == nullptr || !pass.categories->IsDetector()) return;
  const int interval = pass.intervals.categories;
  const std::string searched = interval == 1
                                   ? "every frame is searched"
                                   : fmt::format("one of {} frames is searched, {} in between", interval,
                                                 FollowsCategories(pass) ? "and what is found is tracked" : "nothing");
  pass.job.inform(fmt::format("{}; {}", pass.categories->DescribeSearch({info.width, info.height}), searched));
}

}  // namespace victorious
