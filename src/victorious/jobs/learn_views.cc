#include "victorious/jobs/learn_views.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/progress.h"
#include "victorious/geometry/box.h"
#include "victorious/input/image/image_file.h"
#include "victorious/jobs/known_views.h"
#include "victorious/jobs/stored_video.h"
#include "victorious/object/model/photo_model.h"
#include "victorious/search/recognize/recognizer.h"

namespace victorious {
namespace {

constexpr double kSpacing_s = 0.5;  // between two sightings that are looked at
constexpr double kSeek_s = 10;      // to the next one, from which on the video is not read but entered anew
constexpr double kMinScore = 0.5;
constexpr double kMinSide_px = 16;

class ViewLearner {
 public:
  static Expected<ViewLearner> Create(const ObjectModel& known) {
    ViewLearner learner(known);
    VICTORIOUS_ASSIGN_OR_RETURN(learner.options_, OptionsOf(known));
    VICTORIOUS_ASSIGN_OR_RETURN(learner.extractor_, MakeFeatureExtractor(learner.options_.features));
    VICTORIOUS_RETURN_IF_ERROR(learner.Prepare());
    return learner;
  }

  [[nodiscard]] bool IsFull() const { return result_.model.views.size() >= kMaxLearntViews; }

  Status Look(const SightingRecord& sighting, const cv::Mat& bgr, const std::string& source) {
    ++result_.looked_at;
    // A view matches its own frame far better than any other: that would be the most matches that it had.
    if (std::ranges::find(result_.model.views, source, &ModelView::source) != result_.model.views.end()) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(const bool is_known, IsKnown(sighting.box, bgr));
    if (is_known) return {};
    const Expected<Photo> photo = PreparePhoto(source, bgr, MaskOf(sighting, bgr.size()), {});
    if (!photo) return {};  // an outline without an area
    VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet features,
                                ExtractObjectFeatures(*photo, *extractor_, {.margin_px = options_.margin_px}));
    if (features.size() < std::max(kMinViewFeatures, static_cast<std::size_t>(options_.min_features))) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(result_.model, WithView(result_.model, *photo, features));
    ++result_.learnt;
    return Prepare();
  }

  [[nodiscard]] LearntViews TakeResult() && { return std::move(result_); }

 private:
  explicit ViewLearner(const ObjectModel& known) : result_{.model = known} {}

  Status Prepare() {
    if (result_.model.views.empty()) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(Recognizer recognizer, Recognizer::Create({result_.model}, result_.model.engine, {}));
    recognizer_.emplace(std::move(recognizer));
    return {};
  }

  // The object's outline. A sighting at the frame's border is not looked at: its outline lies within.
  static cv::Mat MaskOf(const SightingRecord& sighting, const cv::Size& size) {
    const Polygon outline = sighting.outline.size() >= 3 ? sighting.outline : BoxCorners(sighting.box);
    std::vector<cv::Point> corners;
    for (const Eigen::Vector2d& corner : outline)
      corners.emplace_back(static_cast<int>(std::lround(corner.x() - 0.5)),
                           static_cast<int>(std::lround(corner.y() - 0.5)));
    cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
    cv::fillPoly(mask, corners, 255);
    return mask;
  }

  Expected<bool> IsKnown(const Box& box, const cv::Mat& bgr) {
    if (!recognizer_) return false;
    VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet region, FeaturesAround(GreyFromBgr(bgr), box, *extractor_));
    if (region.keypoints.empty()) return false;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Detection> detections, recognizer_->Recognize(region));
    const Detection* const found = DetectionAt(detections, box);
    if (found == nullptr) return false;
    const auto matches = static_cast<double>(found->fit.inliers.size());
    double& max_matches = max_matches_[found->view];
    max_matches = std::max(max_matches, matches);
    return matches >= kWeakMatches * max_matches;
  }

  PhotoModelOptions options_;
  std::unique_ptr<const FeatureExtractor> extractor_;
  LearntViews result_;
  std::optional<Recognizer> recognizer_;
  std::map<std::size_t, double> max_matches_;  // by view
};

// The sightings that are looked at, by video and time.
std::map<std::int64_t, std::vector<SightingRecord>> ChooseSightings(std::vector<SightingRecord> sightings,
                                                                    const std::map<std::int64_t, VideoRecord>& videos) {
  std::ranges::stable_sort(sightings, {}, [](const SightingRecord& one) { return std::pair(one.video, one.frame); });
  std::map<std::int64_t, std::vector<SightingRecord>> chosen;
  for (SightingRecord& one : sightings) {
    const auto video = videos.find(one.video);
    if (video == videos.end() || one.score < kMinScore) continue;
    const Box frame = FrameBox(video->second.width, video->second.height);
    if (IsAtBorder(one.box, frame) || std::min(one.box.width, one.box.height) < kMinSide_px) continue;
    std::vector<SightingRecord>& of_video = chosen[one.video];
    if (!of_video.empty() && one.time_s < of_video.back().time_s + kSpacing_s) continue;
    of_video.push_back(std::move(one));
  }
  return chosen;
}

Status LookAtVideo(const VideoRecord& video, const std::vector<SightingRecord>& sightings, const CancelToken& cancel,
                   ViewLearner& learner) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, OpenStoredVideo(video, {.color = FrameColor::kBgr}, cancel));
  Progress progress(ShownName(video), std::ssize(sightings), "sightings");
  double now_s = 0;
  auto next = sightings.begin();
  while (next != sightings.end() && !learner.IsFull()) {
    if (cancel.IsCancelled()) return Fail(ErrorCode::kCancelled, "interrupted: nothing was written");
    if (next->time_s > now_s + kSeek_s && reader->SeekTo(next->time_s)) now_s = next->time_s;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Frame> frame, reader->NextFrame());
    if (!frame) return {};
    now_s = std::max(now_s, frame->time_s);
    while (next != sightings.end() && next->time_s < frame->time_s - kSameTime_s) ++next;  // it cannot be read again
    if (next == sightings.end() || next->time_s > frame->time_s + kSameTime_s) continue;
    VICTORIOUS_RETURN_IF_ERROR(
        learner.Look(*next, frame->image, fmt::format("{}, {:.2f} s", ShownName(video), frame->time_s)));
    ++next;
    progress.Update(next - sightings.begin());
  }
  return {};
}

}  // namespace

Expected<LearntViews> LearnViews(const ObjectModel& known, std::int64_t object, IndexStore& store,
                                 const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(ViewLearner learner, ViewLearner::Create(known));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> all, store.Videos());
  std::map<std::int64_t, VideoRecord> videos;
  for (const VideoRecord& video : all) videos[video.id] = video;
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<SightingRecord> sightings, store.Sightings({.object = object}));
  const auto chosen = ChooseSightings(std::move(sightings), videos);
  for (const auto& [video, of_video] : chosen)
    VICTORIOUS_RETURN_IF_ERROR(LookAtVideo(videos.at(video), of_video, cancel, learner));
  return std::move(learner).TakeResult();
}

}  // namespace victorious
