// jobs/, how much smaller than filmed the frames of a pass are searched. Where telemetry and the height of the
// ground fix how large objects appear, more pixels than a search needs cost time and find nothing: a frame is shrunk as
// far as the smallest CAD model keeps a given size in it (docs/adr/0043-resolution-of-the-search.md).
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <opencv2/core/mat.hpp>

#include "victorious/geometry/ground.h"
#include "victorious/geometry/polygon.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/place/cameras/camera_states.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// Of a frame as filmed, and of the image of it that is searched.
struct FrameSizes {
  cv::Size filmed;
  cv::Size searched;

  /// From the searched image to the frame, px.
  [[nodiscard]] Box ToFilmed(const Box& box) const;
  [[nodiscard]] Polygon ToFilmed(const Polygon& outline) const;
};

/// The searched image of a frame; the frame's own where the sizes are equal. @param grey  of the filmed size
[[nodiscard]] cv::Mat ShrinkTo(const cv::Size& searched, const cv::Mat& grey);

class SearchScale {
 public:
  /// What decides the scale. The references outlive the object.
  struct Input {
    std::span<const ObjectModel> models;
    const CameraStates& cameras;
    const Ground* ground = nullptr;  ///< that the user gave; null: the estimate of `cameras`
    double object_px = 0;            ///< that the diagonal of the smallest model keeps; 0: frames are never shrunk
    /// Tracks restart at multiples of it (FollowOptions::restart_interval_frames); the scale changes only there.
    std::int64_t restart_interval_frames = 1;
  };

  /// Frames are searched as filmed if a model's size is unknown, as of photos, for a live source, and in
  /// a folder of images, each of which may be taken from elsewhere.
  SearchScale(const Input& input, const VideoInfo& info);

  /// The same for all frames between two restarts of tracks, and in each part of a video that is searched apart: it
  /// depends on the frame's number, the frame rate and the cameras of that time only.
  /// @param filmed  size of the frame: one that is not that of the video is not shrunk
  [[nodiscard]] FrameSizes SizesAt(std::int64_t frame, const cv::Size& filmed) const;

  /// The searched image of a frame whose number is not known, only its time.
  [[nodiscard]] cv::Mat ShrinkNear(double time_s, const cv::Mat& grey) const;

 private:
  [[nodiscard]] std::optional<double> FactorAt(double time_s) const;

  Input input_;
  cv::Size filmed_;
  double frame_rate_ = 0;
  double duration_s_ = 0;
  std::optional<double> smallest_m_;  // diagonal; std::nullopt: never shrunk
};

}  // namespace victorious
