#include "victorious/jobs/index/search_scale.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/Core>
#include <opencv2/imgproc.hpp>

#include "victorious/place/calibrate/sun_direction.h"
#include "victorious/search/follow/follower.h"
#include "victorious/types/frame_conditions.h"

namespace victorious {
namespace {

constexpr double kMinDown = 0.34;    // cosine of the off-nadir angle: views of models end at 70 degrees
constexpr double kMaxFactor = 0.85;  // saves too little above
constexpr int kMinSide_px = 640;     // of the longer side: keeps a wrong height or length from blinding the search
constexpr int kSamples = 3;          // of the cameras between two restarts of tracks
constexpr int kSamplesOfVideo = 64;
constexpr int kMinDivisor = 8;

// The pixels of a metre across the line of sight, at the ground that is farthest from the camera.
double PixelsPerMetre(const Vertical& vertical, double height_m, const cv::Size& size) {
  double min_down = 1;
  for (const auto& [x, y] :
       {std::pair(0, 0), std::pair(size.width, 0), std::pair(0, size.height), std::pair(size.width, size.height)}) {
    const Eigen::Vector3d ray = vertical.pinhole.Unproject({x, y});
    min_down = std::min(min_down, -vertical.up_in_camera.dot(ray.normalized()));
  }
  return vertical.pinhole.fx * std::max(min_down, kMinDown) / height_m;
}

// With the same ratio of the sides where that is possible with whole pixels.
cv::Size Shrunk(const cv::Size& filmed, double factor) {
  const int divisor = std::gcd(filmed.width, filmed.height);
  if (divisor < kMinDivisor) {
    return {static_cast<int>(std::lround(factor * filmed.width)),
            static_cast<int>(std::lround(factor * filmed.height))};
  }
  const int parts = static_cast<int>(std::ceil(factor * divisor));
  return {filmed.width / divisor * parts, filmed.height / divisor * parts};
}

Eigen::Vector2d RatioOf(const FrameSizes& sizes) {
  return {static_cast<double>(sizes.filmed.width) / sizes.searched.width,
          static_cast<double>(sizes.filmed.height) / sizes.searched.height};
}

}  // namespace

Box FrameSizes::ToFilmed(const Box& box) const {
  if (filmed == searched) return box;
  const Eigen::Vector2d ratio = RatioOf(*this);
  return {box.x * ratio.x(), box.y * ratio.y(), box.width * ratio.x(), box.height * ratio.y()};
}

Polygon FrameSizes::ToFilmed(const Polygon& outline) const {
  if (filmed == searched) return outline;
  Polygon larger = outline;
  for (Eigen::Vector2d& corner : larger) corner = corner.cwiseProduct(RatioOf(*this));
  return larger;
}

cv::Mat ShrinkTo(const cv::Size& searched, const cv::Mat& grey) {
  if (grey.size() == searched) return grey;
  cv::Mat small;
  cv::resize(grey, small, searched, 0, 0, cv::INTER_AREA);
  return small;
}

SearchScale::SearchScale(const Input& input, const VideoInfo& info)
    : input_(input),
      filmed_(info.width, info.height),
      frame_rate_(info.frame_rate),
      duration_s_(info.duration_s.value_or(0)) {
  if (!(input.object_px > 0) || info.live || info.of_images || !(frame_rate_ > 0)) return;
  if (!input.cameras.HasStates()) return;
  for (const ObjectModel& model : input.models) {
    if (!model.box_m) {
      smallest_m_.reset();
      return;
    }
    const double diagonal_m = model.box_m->diagonal().norm();
    smallest_m_ = std::min(smallest_m_.value_or(diagonal_m), diagonal_m);
  }
}

std::optional<double> SearchScale::FactorAt(double time_s) const {
  const std::optional<CameraState> camera = input_.cameras.At(time_s);
  const auto height_m = input_.cameras.HeightAboveGround(camera, input_.ground);
  const FrameConditions conditions = MakeFrameConditions(camera, filmed_, {});
  if (!height_m || !conditions.vertical) return std::nullopt;
  return input_.object_px / (*smallest_m_ * PixelsPerMetre(*conditions.vertical, *height_m, filmed_));
}

FrameSizes SearchScale::SizesAt(std::int64_t frame, const cv::Size& filmed) const {
  const FrameSizes as_filmed{filmed, filmed};
  if (!smallest_m_ || filmed != filmed_) return as_filmed;
  const bool restarts = input_.restart_interval_frames < kNoRestart;
  const double length_s = restarts ? static_cast<double>(input_.restart_interval_frames) / frame_rate_ : duration_s_;
  const double from_s = restarts ? static_cast<double>(frame / input_.restart_interval_frames) * length_s : 0.0;
  const int samples = restarts ? kSamples : kSamplesOfVideo;
  std::optional<double> largest;
  for (int i = 0; i < samples; ++i) {
    const double part = static_cast<double>(i) / samples;  // a part of a video has no states after its end
    const std::optional<double> factor = FactorAt(from_s + part * length_s);
    if (!factor) continue;
    largest = std::max(largest.value_or(0), *factor);
  }
  if (!largest) return as_filmed;
  const double min_factor = static_cast<double>(kMinSide_px) / std::max(filmed_.width, filmed_.height);
  const double factor = std::max(*largest, min_factor);
  return factor > kMaxFactor ? as_filmed : FrameSizes{filmed_, Shrunk(filmed_, factor)};
}

cv::Mat SearchScale::ShrinkNear(double time_s, const cv::Mat& grey) const {
  return ShrinkTo(SizesAt(std::llround(time_s * frame_rate_), grey.size()).searched, grey);
}

}  // namespace victorious
