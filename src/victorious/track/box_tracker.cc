#include "victorious/track/box_tracker.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>
#include <tbb/parallel_for.h>

#include "victorious/base/check.h"

namespace victorious {
Expected<BoxTracker> BoxTracker::Create(const BoxTrackOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  return BoxTracker(options);
}

std::vector<BoxStep> BoxTracker::Step(const Frame& frame) {
  scene_.image = Levels(frame.image);
  scene_.grey = frame.image;
  if (frame.image.channels() == 3) cv::cvtColor(frame.image, scene_.grey, cv::COLOR_BGR2GRAY);
  scene_.now_from_before = motion_.Step(scene_.grey).value_or(Similarity2{});
  std::vector<BoxStep> steps(targets_.size());
  tbb::parallel_for(std::size_t{0}, targets_.size(),
                    [&](std::size_t i) { steps[i] = Describe(i, targets_[i].Step(scene_)); });
  return steps;
}

Expected<BoxStep> BoxTracker::Start(const Box& box) {
  VICTORIOUS_CHECK(!scene_.image.empty());
  constexpr double kLeastSide_px = 4;
  const Box frame = FrameBox(scene_.grey.cols, scene_.grey.rows);
  const Box inside = Intersection(box, frame);
  const std::string told = fmt::format("box {:g},{:g},{:g},{:g}", box.x, box.y, box.width, box.height);
  const std::string right = fmt::format("give x,y,w,h inside {:g} x {:g} px, at least {:g} px to a side", frame.width,
                                        frame.height, kLeastSide_px);
  if (!(std::min(box.width, box.height) >= kLeastSide_px && std::isfinite(box.Area()))) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: too small: {}", told, right));
  }
  if (!(inside.Area() >= 0.5 * box.Area())) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: outside the frame: {}", told, right));
  }
  if (std::min(inside.width, inside.height) < kLeastSide_px) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: too little of it in the frame: {}", told, right));
  }
  targets_.emplace_back(scene_, inside, options_);
  return BoxStep{.target = targets_.size() - 1, .box = inside, .extent = inside, .trust = 1};
}

BoxStep BoxTracker::Resume(std::size_t target, const Box& box, double turn_rad, Evidence evidence) {
  VICTORIOUS_CHECK(target < targets_.size());
  const double least_trust = evidence == Evidence::kLook ? options_.lost_trust : options_.return_trust;
  return Describe(target, targets_[target].Resume(scene_, box, turn_rad, least_trust));
}

void BoxTracker::Lose(std::size_t target) {
  VICTORIOUS_CHECK(target < targets_.size());
  targets_[target].Lose();
}

BoxStep BoxTracker::Describe(std::size_t target, const BoxTarget::Sight& sight) const {
  BoxStep step{.target = target, .loss = sight.loss, .trust = sight.trust, .doubtful = sight.doubtful};
  if (!step.seen()) return step;
  step.extent = sight.box;
  step.box = Intersection(sight.box, FrameBox(scene_.grey.cols, scene_.grey.rows));
  return step;
}

void BoxTracker::ChangeVideo() {
  motion_ = {};
  for (BoxTarget& target : targets_) target.Lose();
}

}  // namespace victorious
