#include "victorious/show/export/object_moments.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "victorious/base/utc.h"

namespace victorious {
namespace {

constexpr int kDecimalsOfUtc = 3;

Json UtcJson(std::optional<std::int64_t> utc_us) { return utc_us ? Json(FormatUtc(*utc_us, kDecimalsOfUtc)) : Json(); }

}  // namespace

std::optional<std::int64_t> ObjectMoment::UtcOf(double time_s) const {
  if (!start_utc_us) return std::nullopt;
  return *start_utc_us + std::llround(time_s * 1e6);
}

Expected<MomentsByObject> ReadMoments(IndexStore& store, const Catalogue& videos) {
  MomentsByObject moments;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> tracklets, store.Tracklets());
  for (const TrackletRecord& tracklet : tracklets) {
    const VideoRecord* video = videos.Video(tracklet.video);
    if (video == nullptr) continue;  // added by another process since
    std::vector<ObjectMoment>& of_object = moments[tracklet.object];
    const auto at = std::ranges::lower_bound(of_object, tracklet.video, {}, &ObjectMoment::video);
    if (at == of_object.end() || at->video != tracklet.video) {
      of_object.insert(at, {.video = tracklet.video,
                            .video_name = ShownName(*video),
                            .first_time_s = tracklet.first_time_s,
                            .last_time_s = tracklet.last_time_s,
                            .frames = tracklet.frames,
                            .start_utc_us = video->start_utc_us});
      continue;
    }
    at->first_time_s = std::min(at->first_time_s, tracklet.first_time_s);
    at->last_time_s = std::max(at->last_time_s, tracklet.last_time_s);
    at->frames += tracklet.frames;
  }
  return moments;
}

std::optional<UtcSpan> SpanOf(const std::vector<ObjectMoment>& moments) {
  std::optional<UtcSpan> span;
  for (const ObjectMoment& one : moments) {
    const std::optional<std::int64_t> begin_us = one.UtcOf(one.first_time_s);
    const std::optional<std::int64_t> end_us = one.UtcOf(one.last_time_s);
    if (!begin_us || !end_us) return std::nullopt;
    if (!span) span = {*begin_us, *end_us};
    span = {std::min(span->begin_us, *begin_us), std::max(span->end_us, *end_us)};
  }
  return span;
}

Json MomentsJson(const std::vector<ObjectMoment>& moments) {
  Json rows = Json::array();
  for (const ObjectMoment& one : moments) {
    rows.push_back({{"video", one.video_name},
                    {"first_time_s", TimeJson(one.first_time_s)},
                    {"last_time_s", TimeJson(one.last_time_s)},
                    {"first_utc", UtcJson(one.UtcOf(one.first_time_s))},
                    {"last_utc", UtcJson(one.UtcOf(one.last_time_s))},
                    {"frames", one.frames}});
  }
  return rows;
}

}  // namespace victorious
