#include "victorious/jobs/index/frame_selector.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "victorious/base/stage_time.h"
#include "victorious/place/calibrate/sun_direction.h"

namespace victorious {
namespace {

// True if the interval of searches is not given, and the frames follow each other closely.
bool SelectsByMotion(const IndexPass& pass, const VideoInfo& info) {
  return pass.options.every == 0 && IsTrackingEnabled(pass) && !info.of_images && info.frame_rate > 0;
}

// Frames between two that are tracked. What categories are searched in is tracked, too: all frames.
int StepOfTracking(const IndexPass& pass) {
  return pass.categories == nullptr ? std::min(pass.intervals.tracked, pass.intervals.models) : 1;
}

}  // namespace

FrameSelector::FrameSelector(const IndexPass& pass, const VideoInfo& info, SearchPace& pace,
                             std::optional<std::int64_t> first_required_frame)
    : kept_frames_(pass.options.keep.interval_s),
      tracked_rate_(info.frame_rate / StepOfTracking(pass)),
      shape_frames_(ShapeSearchInterval(pass.options.shape, pass.follow, tracked_rate_, 1)),
      schedule_(pass.intervals.models, pass.follow, SelectsByMotion(pass, info)),
      scale_({.models = pass.recognizer.models(),
              .cameras = pass.cameras,
              .ground = pass.options.objects.ground.get(),
              .object_px = pass.categories == nullptr ? pass.options.resolution.object_px : 0,
              .restart_interval_frames = pass.follow.restart_interval_frames},
             info),
      pace_(pace),
      pass_(pass),
      next_frame_(pass.searches.front().next_frame) {
  follow_from_ = next_frame_;
  if ((IsTrackingEnabled(pass) || FollowsCategories(pass)) && !pace.IsLimited()) {
    follow_from_ -= next_frame_ % pass.follow.restart_interval_frames;
  }
  first_frame_ = std::min(follow_from_, first_required_frame.value_or(follow_from_));
  first_frame_ -= first_frame_ % pass.intervals.tracked;  // motion of the image is known between tracked frames
}

FrameSizes FrameSelector::SizesOf(const Frame& frame) {
  const std::int64_t interval = frame.index / pass_.follow.restart_interval_frames;
  if (!sizes_ || interval != sizes_interval_ || sizes_->filmed != frame.image.size()) {
    sizes_ = scale_.SizesAt(frame.index, frame.image.size());
    sizes_interval_ = interval;
  }
  return *sizes_;
}

// A frame before a restart is tracked, as tracks end there.
bool FrameSelector::IsBetweenTracked(std::int64_t index) const {
  return index % StepOfTracking(pass_) != 0 && !schedule_.MayBeSearched(index) &&
         (index + 1) % pass_.follow.restart_interval_frames != 0;
}

std::optional<FrameWork> FrameSelector::Select(Frame frame, std::optional<double> behind_s) {
  pace_.Enter(behind_s);
  if (pass_.job.from_s && frame.time_s < *pass_.job.from_s - kSameTime_s) return std::nullopt;
  const std::int64_t index = frame.index;
  const bool is_first_wanted =
      (pass_.job.from_s && !std::exchange(has_started_, true)) || (pace_.IsLimited() && index == next_frame_);
  const bool is_detector = pass_.categories != nullptr && pass_.categories->IsDetector();
  const bool may_be_classified =
      pass_.categories != nullptr &&
      (IsFullSearchFrame(index, pass_.intervals.categories, pass_.follow) || (is_detector && is_first_wanted));
  const bool classify = may_be_classified && (!is_detector || is_first_wanted || pace_.HasTimeForAll());
  const bool may_be_searched = is_first_wanted || IsFullSearchFrame(index, pass_.intervals.models, pass_.follow);
  // Selects by time, whatever the motion of the image.
  const bool keep = (may_be_searched || classify) && kept_frames_.IsSelected(frame.time_s);
  if (index < first_frame_) return std::nullopt;
  if (!may_be_searched && !classify && !IsTrackingEnabled(pass_) && !FollowsCategories(pass_)) return std::nullopt;
  FrameWork task;
  if (!may_be_searched && !classify && IsBetweenTracked(index)) {
    task.is_between = true;
    task.whole = false;
    task.already_stored = index < next_frame_;
    task.motion_only = index < follow_from_;
    frame.image.release();
    frame.bgr.release();
    task.now.frame = std::move(frame);
    return task;
  }
  {
    const StageScope scope(Stage::kTracking);
    task.now_from_before = motion_.Step(frame.image);
  }
  task.sizes = SizesOf(frame);
  const double spacing = SearchSpacing(task.sizes.searched);
  const bool is_due = schedule_.Enter(frame, task.now_from_before, spacing) || is_first_wanted;
  const bool whole = is_due && (is_first_wanted || pace_.HasTimeForAll());
  if (whole) task.views = schedule_.SetSearched(frame, index == 0 || is_first_wanted);
  task.camera = pass_.cameras.At(frame.time_s);
  task.now.conditions = MakeFrameConditions(pass_.cameras.ForSearch(frame.time_s), task.sizes.searched, pass_.sun);
  task.now.conditions.height_above_ground_m =
      pass_.cameras.HeightAboveGround(task.camera, pass_.options.objects.ground.get());
  task.now.frame = std::move(frame);
  task.already_stored = index < next_frame_;
  task.motion_only = index < follow_from_;
  task.whole = whole && !task.motion_only && !pass_.recognizer.models().empty();
  if (IsTrackingEnabled(pass_) && index % pass_.follow.restart_interval_frames == 0) {
    shape_frames_ =
        IntervalSelector(ShapeSearchInterval(pass_.options.shape, pass_.follow, tracked_rate_, std::sqrt(spacing)));
  }
  task.by_shape = task.whole && pass_.shapes != nullptr && shape_frames_.IsSelected(task.now.frame.time_s);
  task.has_time = pace_.HasTime();
  task.left_out = ((is_due && !whole) || (may_be_classified && !classify)) && !task.already_stored;
  task.classify = classify && !task.motion_only && (!task.already_stored || FollowsCategories(pass_));
  task.is_slow = task.whole || (task.classify && is_detector);
  if (task.is_slow) pace_.BeginFullSearch();
  task.keep = keep && !task.already_stored;
  return task;
}

}  // namespace victorious
