#include "victorious/tracker.h"

#include <utility>

#include <fmt/format.h>

#include "victorious/apps/library/facade.h"
#include "victorious/jobs/track/track_job.h"
#include "victorious/track/box_tracker.h"

namespace libvictorious {
namespace {

static_assert(static_cast<int>(TrackLoss::kUnconfirmed) == static_cast<int>(victorious::TrackLoss::kUnconfirmed));

TrackStep StepOf(const victorious::BoxTrackStep& step) {
  return {step.target, static_cast<TrackLoss>(step.loss), BoxOf(step.box), step.confidence, step.tentative};
}

}  // namespace

struct Tracker::Impl {
  victorious::BoxTracker tracker;
  victorious::Frame current;  // its image is a copy: the tracker keeps it
};

Tracker::Tracker(const TrackerSettings& settings) {
  Guard([&] {
    victorious::TrackBoxesOptions options;
    Unwrap(ApplyParams(settings.params, options));
    impl_ = std::make_unique<Impl>(Impl{.tracker = Unwrap(victorious::BoxTracker::Create(options.box)), .current = {}});
  });
}

Tracker::Tracker(Tracker&& other) noexcept = default;
Tracker& Tracker::operator=(Tracker&& other) noexcept = default;
Tracker::~Tracker() = default;

std::vector<TrackStep> Tracker::Step(const ImageView& image) {
  return Guard([&] {
    const bool is_grey = image.format == PixelFormat::kGrey;
    const cv::Mat pixels = Unwrap(is_grey ? GreyOf(image) : BgrOf(image)).clone();
    const cv::Mat& before = impl_->current.image;
    if (!before.empty() && (before.size() != pixels.size() || before.type() != pixels.type())) {
      throw Error(
          ErrorCode::kInvalidArgument,
          fmt::format("frame of {} x {} px after one of {} x {} px: give frames of one size, all grey or all in "
                      "colour",
                      pixels.cols, pixels.rows, before.cols, before.rows));
    }
    impl_->current = {.index = impl_->current.index + 1, .time_s = 0, .image = pixels};
    std::vector<TrackStep> steps;
    for (const victorious::BoxTrackStep& step : impl_->tracker.Step(impl_->current)) steps.push_back(StepOf(step));
    return steps;
  });
}

TrackStep Tracker::Start(const Box& box) {
  return Guard([&] {
    if (impl_->current.image.empty()) {
      throw Error(ErrorCode::kInvalidArgument, "no current frame: call Step with it before Start");
    }
    return StepOf(Unwrap(impl_->tracker.Start({box.x, box.y, box.width, box.height})));
  });
}

void Tracker::ChangeVideo() {
  Guard([&] {
    impl_->tracker.ChangeVideo();
    impl_->current = {};
  });
}

}  // namespace libvictorious
