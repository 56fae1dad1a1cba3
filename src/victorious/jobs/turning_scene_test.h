// A drawn video of objects that show another side in each frame: what the tests of learnt views share.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "testing/drawn_town.h"
#include "victorious/base/random.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/object/model/photo_model.h"

namespace victorious {

inline constexpr int kFrames = 80;
inline constexpr int kPhotoFrame = 40;
inline constexpr double kFrame_s = 0.5;

struct StandingObject {
  cv::Point2d at;  // centre, px of the town
  std::function<bool(int frame)> is_there = [](int) { return true; };
  cv::Point2d velocity = {0, 0};  // px of the town a frame
};

// Objects that stand on a town, from a camera that turns above it. Each shows a part of a strip that moves on with
// time, so that a view shares nothing with that of some 40 frames before: what a camera sees that circles around.
class TurningScene {
 public:
  // @param turn_px  by which the strip moves on from frame to frame
  explicit TurningScene(std::vector<StandingObject> objects = {StandingObject{.at = {450, 450}}}, int turn_px = 2)
      : objects_(std::move(objects)),
        turn_px_(turn_px),
        town_(testing::DrawTown({900, 900}, 6)),
        strip_(kHeight, turn_px * kFrames + kWidth, CV_8UC3) {
    Random random(3);
    const std::array<cv::Scalar, 4> colours = {cv::Scalar(40, 40, 200), cv::Scalar(20, 10, 110),
                                               cv::Scalar(90, 60, 240), cv::Scalar(60, 20, 160)};
    strip_.setTo(colours[0]);
    for (int i = 0; i < 3 * strip_.cols; ++i) {
      const cv::Rect patch(static_cast<int>(random.Below(static_cast<std::uint64_t>(strip_.cols))),
                           static_cast<int>(random.Below(kHeight)), 3 + static_cast<int>(random.Below(10)),
                           3 + static_cast<int>(random.Below(10)));
      cv::rectangle(strip_, patch, colours[random.Below(4)], cv::FILLED);
    }
    cv::GaussianBlur(strip_, strip_, {}, 0.7);
  }

  [[nodiscard]] cv::Mat Draw(int frame) const {
    cv::Mat town = town_.clone();
    for (const StandingObject& object : objects_) {
      const cv::Mat view = strip_.colRange(turn_px_ * frame, turn_px_ * frame + kWidth);
      if (object.is_there(frame)) view.copyTo(town(PlaceOf(object, frame)));
    }
    cv::Mat image;
    cv::warpAffine(town, image, MapOf(frame), {kImageWidth, kImageHeight});
    return image;
  }

  [[nodiscard]] Polygon OutlineOf(std::size_t object, int frame) const {
    const cv::Rect place = PlaceOf(objects_[object], frame);
    const cv::Matx23d map = MapOf(frame);
    Polygon outline = BoxCorners({static_cast<double>(place.x), static_cast<double>(place.y), kWidth, kHeight});
    for (Eigen::Vector2d& corner : outline) {
      const cv::Vec2d moved = map * cv::Vec3d(corner.x(), corner.y(), 1);
      corner = {moved[0], moved[1]};
    }
    return outline;
  }
  [[nodiscard]] Box BoxOf(std::size_t object, int frame) const { return BoundingBox(OutlineOf(object, frame)); }

  static inline constexpr int kImageWidth = 400;
  static inline constexpr int kImageHeight = 300;

 private:
  static inline constexpr int kWidth = 84;
  static inline constexpr int kHeight = 56;

  static cv::Rect PlaceOf(const StandingObject& object, int frame) {
    return {static_cast<int>(std::lround(object.at.x + frame * object.velocity.x)) - kWidth / 2,
            static_cast<int>(std::lround(object.at.y + frame * object.velocity.y)) - kHeight / 2, kWidth, kHeight};
  }
  static cv::Matx23d MapOf(int frame) {
    cv::Mat map = cv::getRotationMatrix2D({450, 450}, 0.7 * (frame - kPhotoFrame), 1 + 0.001 * frame);
    map.at<double>(0, 2) += kImageWidth / 2.0 - 450;
    map.at<double>(1, 2) += kImageHeight / 2.0 - 450;
    return map;
  }

  std::vector<StandingObject> objects_;
  int turn_px_;
  cv::Mat town_;
  cv::Mat strip_;
};

inline ObjectModel PhotoModelOf(const TurningScene& scene) {
  const Photo photo = PreparePhoto("photo", scene.Draw(kPhotoFrame), {}, scene.BoxOf(0, kPhotoFrame)).value();
  return MakePhotoModel("can", std::span(&photo, 1), std::nullopt, {}).value();
}

}  // namespace victorious
