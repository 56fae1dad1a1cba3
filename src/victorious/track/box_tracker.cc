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

std::vector<BoxTrackStep> BoxTracker::Step(const Frame& frame) {
  context_.image = ImagePyramid(frame.image);
  context_.grey = frame.image;
  if (frame.image.channels() == 3) cv::cvtColor(frame.image, context_.grey, cv::COLOR_BGR2GRAY);
  context_.now_from_before = motion_.Step(context_.grey);
  std::vector<BoxTrackStep> steps(targets_.size());
  tbb::parallel_for(std::size_t{0}, targets_.size(),
                    [&](std::size_t i) { steps[i] = MakeStep(i, targets_[i].Step(context_)); });
  return steps;
}

Expected<Box> BoxTracker::ClipToFrame(const Box& box, cv::Size frame_size) {
  constexpr double kMinSide_px = 4;
  const Box frame = FrameBox(frame_size.width, frame_size.height);
  const Box inside = Intersection(box, frame);
  const std::string given = fmt::format("box {:g},{:g},{:g},{:g}", box.x, box.y, box.width, box.height);
  const std::string remedy = fmt::format("give x,y,w,h inside {:g} x {:g} px, at least {:g} px to a side", frame.width,
                                         frame.height, kMinSide_px);
  if (!(std::min(box.width, box.height) >= kMinSide_px && std::isfinite(box.Area()))) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: too small: {}", given, remedy));
  }
  if (!(inside.Area() >= 0.5 * box.Area())) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: outside the frame: {}", given, remedy));
  }
  if (std::min(inside.width, inside.height) < kMinSide_px) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: too little of it in the frame: {}", given, remedy));
  }
  return inside;
}

Expected<BoxTrackStep> BoxTracker::Start(const Box& box) {
  VICTORIOUS_CHECK(!context_.image.empty());
  VICTORIOUS_ASSIGN_OR_RETURN(const Box inside, ClipToFrame(box, context_.grey.size()));
  targets_.emplace_back(context_, inside, options_);
  return BoxTrackStep{.target = targets_.size() - 1, .box = inside, .extent = inside, .confidence = 1};
}

BoxTrackStep BoxTracker::Resume(std::size_t target, const Box& box, double rotation_rad, ResumeBasis basis) {
  VICTORIOUS_CHECK(target < targets_.size());
  const double min_confidence =
      basis == ResumeBasis::kRecognised ? options_.lost_confidence : options_.redetect_confidence;
  return MakeStep(target, targets_[target].Resume(context_, box, rotation_rad, min_confidence,
                                                  /*is_place_known=*/basis == ResumeBasis::kPredicted));
}

void BoxTracker::MarkLost(std::size_t target) {
  VICTORIOUS_CHECK(target < targets_.size());
  targets_[target].MarkLost(/*position_known=*/false);
}

BoxTrackStep BoxTracker::MakeStep(std::size_t target, const BoxTarget::TargetObservation& observation) const {
  BoxTrackStep step{.target = target,
                    .loss = observation.loss,
                    .confidence = observation.confidence,
                    .tentative = observation.tentative};
  if (!step.seen()) return step;
  step.extent = observation.box;
  step.box = Intersection(observation.box, FrameBox(context_.grey.cols, context_.grey.rows));
  return step;
}

void BoxTracker::ChangeVideo() {
  motion_ = {};
  for (BoxTarget& target : targets_) target.MarkLost(/*position_known=*/false);
}

}  // namespace victorious
