#include "victorious/category/finder/review_marks.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "victorious/input/video/video_reader.h"

namespace victorious {

Expected<std::vector<ReviewMark>> ListReviewMarks(IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, store.Models());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store.Videos());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ReviewedObject> reviews, store.Reviews());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, store.Objects({.include_rejected = true}));
  std::map<std::int64_t, const ModelRecord*> category_of;  // by object
  for (const ObjectRecord& object : objects) {
    const auto model = std::ranges::find(models, object.model, &ModelRecord::id);
    if (model != models.end() && model->IsCategory()) category_of[object.id] = &*model;
  }
  std::vector<ReviewMark> marks;
  for (const ReviewedObject& one : reviews) {
    const auto category = category_of.find(one.object);
    if (!one.review.verdict || category == category_of.end()) continue;
    std::optional<SightingRecord> best;
    VICTORIOUS_RETURN_IF_ERROR(store.VisitSightings({.object = one.object}, [&](SightingRecord&& sighting) {
      if (!best || sighting.score > best->score) best = std::move(sighting);
      return true;
    }));
    if (!best) continue;
    const auto video = std::ranges::find(videos, best->video, &VideoRecord::id);
    if (video == videos.end()) continue;
    marks.push_back({.category = category->second->name,
                     .is_right = *one.review.verdict == Verdict::kAccepted,
                     .video = *video,
                     .time_s = best->time_s});
  }
  std::ranges::sort(marks, {}, [](const ReviewMark& one) { return std::tie(one.video.id, one.time_s, one.category); });
  return marks;
}

Expected<cv::Mat> ReadMarkedFrame(const ReviewMark& mark, const FileRoots& roots, const CancelToken& cancel) {
  constexpr double kTimeTolerance_s = 1e-4;
  const std::string path = FindVideoFile(mark.video);
  if (path.find("://") != std::string::npos) {
    return Fail(ErrorCode::kUnsupported, path + ": a live source: its frames are not kept");
  }
  VICTORIOUS_RETURN_IF_ERROR(roots.Check(path));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(path, {.color = FrameColor::kGrey}));
  reader->SeekTo(mark.time_s);  // if it cannot, the frames are read from the beginning
  while (!cancel.IsCancelled()) {
    VICTORIOUS_ASSIGN_OR_RETURN(std::optional<Frame> frame, reader->NextFrame());
    if (!frame) return Fail(ErrorCode::kNotFound, fmt::format("{}: no frame at {:.3f} s", path, mark.time_s));
    if (frame->time_s >= mark.time_s - kTimeTolerance_s) return std::move(frame->image);
  }
  return Fail(ErrorCode::kCancelled, path + ": cancelled");
}

}  // namespace victorious
