#include "victorious/track/box_target.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "victorious/track/cut_out.h"

namespace victorious {
namespace {

constexpr int kWindowCells = 48;
constexpr double kLeastSide_px = 4;

TurnedBox WindowAbout(const TurnedBox& box, double factor) {
  const double side = factor * std::sqrt(box.Area());
  return {box.centre, side, side, box.turn_rad};
}

FilterShape ShapeFor(const Box& box, double window_factor) {
  const double cells_per_px = kWindowCells / (window_factor * std::sqrt(box.Area()));
  const auto cells = [&](double length_px) {
    return static_cast<float>(std::clamp(length_px * cells_per_px, 3.0, static_cast<double>(kWindowCells)));
  };
  return {{kWindowCells, kWindowCells}, {cells(box.width), cells(box.height)}};
}

double ShareInView(const Levels& picture, const TurnedBox& turned) {
  const cv::Mat& image = picture.image();
  return ShareInside(CornersOf(turned.Upright()), FrameBox(image.cols, image.rows));
}

cv::Mat GreyLook(const Levels& image, const TurnedBox& box) {
  const auto side = [](double length_px) { return static_cast<int>(std::lround(std::max(kLeastSide_px, length_px))); };
  cv::Mat look = CutOut(image, box, {side(box.width), side(box.height)});
  if (look.channels() == 3) cv::cvtColor(look, look, cv::COLOR_BGR2GRAY);
  return look;
}

}  // namespace

BoxTarget::BoxTarget(const BoxScene& scene, const Box& box, const BoxTrackOptions& options)
    : options_(options),
      box_(Unturned(box)),
      lost_at_(box_),
      filter_(ShapeFor(box, options.window_factor)),
      scale_(box_),
      appearance_(scene.image, box_),
      sure_look_(GreyLook(scene.image, box_)) {
  filter_.Learn(Look(scene.image, box_), options_.stay);
  scale_.Learn(scene.image, box_, 1);
}

// The feature window around a box, the input of the correlation filter.
CellFeatures BoxTarget::Look(const Levels& image, const TurnedBox& box) const {
  constexpr double kColourShare = 0.5;  // gives colours roughly the energy of the gradients
  const cv::Mat cut =
      CutOut(image, WindowAbout(box, options_.window_factor), {kWindowCells * kCell_px, kWindowCells * kCell_px});
  CellFeatures channels = GradientCells(cut);
  for (const cv::Mat& colour : ColourCells(cut)) channels.emplace_back((colour - cv::mean(colour)[0]) * kColourShare);
  return channels;
}

// Applies the filter to the window around a box and moves the box to the response's peak.
BoxTarget::Answer BoxTarget::Ask(const Levels& image, const TurnedBox& about) const {
  const FilterResponse response = filter_.Respond(Look(image, about));
  const double px_per_cell = WindowAbout(about, options_.window_factor).width / kWindowCells;
  TurnedBox box = about;
  const Eigen::Vector2d moved(response.peak.x * px_per_cell, response.peak.y * px_per_cell);
  box.centre += Eigen::Rotation2Dd(about.turn_rad) * moved;
  return {box, response.sharpness};
}

// The geometric mean of sharpness and NCC, each relative to its running mean and clipped to 1.
double BoxTarget::Trust(const Levels& image, const Answer& answer) const {
  if (learnt_frames_ == 0) return 1;
  constexpr double kLeastSharpness = 1e-6;  // below: a uniform window, without information
  const double sharpness = std::clamp(answer.sharpness / std::max(kLeastSharpness, usual_sharpness_), 0.0, 1.0);
  const double likeness = std::clamp(appearance_.Likeness(image, answer.box) / usual_likeness_, 0.0, 1.0);
  return std::sqrt(sharpness * likeness);
}

// Localises the object. If the camera has rotated by 0.1 rad since the last test, also localises with that rotation and
// returns the result with the higher sharpness times NCC: a camera that flies past shears the image, and the fitted
// similarity then has a rotation that the object does not make.
BoxTarget::Answer BoxTarget::AskTurned(const Levels& image) {
  constexpr double kWorthAsking_rad = 0.1;
  const Answer as_before = Ask(image, box_);
  if (std::abs(pending_turn_rad_) < kWorthAsking_rad) return as_before;
  TurnedBox with_camera = box_;
  with_camera.turn_rad += std::exchange(pending_turn_rad_, 0.0);
  const Answer turned = Ask(image, with_camera);
  const auto merit = [&](const Answer& answer) {
    return answer.sharpness * std::max(0.0, appearance_.Likeness(image, answer.box));
  };
  return merit(turned) >= merit(as_before) ? turned : as_before;
}

BoxTarget::Sight BoxTarget::Step(const BoxScene& scene) {
  const Eigen::Vector2d carried = scene.now_from_before.Apply(box_.centre);
  box_.centre = carried + velocity_px_;
  pending_turn_rad_ += scene.now_from_before.rotation_rad;
  if (lost()) {
    constexpr double kSlowing = 0.9;  // an occluded object may have stopped
    velocity_px_ *= kSlowing;
    // Far outside the frame the estimated ground motion does not apply.
    const Eigen::Vector2d size(scene.grey.cols, scene.grey.rows);
    box_.centre = box_.centre.cwiseMax(-size).cwiseMin(2 * size);
    return Seek(scene);
  }
  const bool should_have_left = ShareInView(scene.image, box_) < options_.least_in_view;
  const Answer answer = AskTurned(scene.image);
  const double trust = Trust(scene.image, answer);
  const bool left = ShareInView(scene.image, answer.box) < options_.least_in_view;
  if (left || trust < (doubtful_ ? options_.return_trust : options_.lost_trust)) {
    Lose();
    return {.loss = left ? TrackLoss::kLeftFrame : TrackLoss::kOccluded};
  }
  box_ = answer.box;
  // A box cut by the frame's edge supports the confidence by its visible fraction only.
  doubtful_ = doubtful_ && trust * ShareInView(scene.image, box_) < options_.learn_trust;
  if (trust >= options_.learn_trust) {
    velocity_px_ += options_.velocity_rate * (box_.centre - carried - velocity_px_);
    Learn(scene, answer, trust);
  }
  // At the edge the filter has a peak inside the frame even if the object is outside.
  if (should_have_left && trust < options_.learn_trust) return {.loss = TrackLoss::kLeftFrame};
  return {.box = box_.Upright(), .trust = trust, .doubtful = doubtful_};
}

void BoxTarget::Learn(const BoxScene& scene, const Answer& answer, double trust) {
  const TurnedBox grown = box_.Scaled(scale_.Growth(scene.image, box_));
  if (std::min(grown.width, grown.height) >= kLeastSide_px) box_ = grown;
  ++learnt_frames_;
  constexpr double kUsualRate = 0.02;  // running mean over roughly the last 50 frames
  const double rate = std::max(kUsualRate, 1.0 / learnt_frames_);
  usual_sharpness_ += rate * (answer.sharpness - usual_sharpness_);
  usual_likeness_ += rate * (std::max(0.1, appearance_.Likeness(scene.image, box_)) - usual_likeness_);
  filter_.Learn(Look(scene.image, box_), options_.stay);
  scale_.Learn(scene.image, box_, options_.scale_rate);
  if (trust < options_.sure_trust) return;
  appearance_.Remember(scene.image, box_);
  sure_look_ = GreyLook(scene.image, box_);
}

// The predicted box, every second frame the box where the object was lost, and the best matches (NCC) of the last
// confident template in the whole frame; the template's scale cycles through three values from frame to frame.
std::vector<TurnedBox> BoxTarget::PlacesToSeek(const BoxScene& scene) const {
  constexpr double kSmall_px = 16;  // smallest side that still discriminates; the frame is scaled down to it
  constexpr std::array kSizes = {1.0, 0.8, 1.25};
  constexpr double kLeastLikeness = 0.3;
  constexpr int kMostPlaces = 4;
  std::vector<TurnedBox> places = {box_};
  if (lost_frames_ % 2 == 0) places.push_back(lost_at_);

  const double size = kSizes[static_cast<std::size_t>(lost_frames_) % kSizes.size()];
  const double shrink = std::min(1.0, kSmall_px / std::sqrt(box_.Area()));
  const double small_from_frame = shrink / size;
  const auto shrunk = [&](int length_px) {
    return std::max(1, static_cast<int>(std::lround(length_px * small_from_frame)));
  };
  cv::Mat small;
  cv::resize(scene.grey, small, {shrunk(scene.grey.cols), shrunk(scene.grey.rows)}, 0, 0, cv::INTER_AREA);
  // The template with the rotation of the current frame.
  const Box upright = box_.Upright();
  const auto side = [&](double length_px) {
    return static_cast<int>(std::lround(std::max(kLeastSide_px, length_px * shrink)));
  };
  const double own_from_frame = std::sqrt(static_cast<double>(sure_look_.total()) / box_.Area());
  const cv::Mat look = CutOut(Levels(sure_look_),
                              {{sure_look_.cols / 2.0, sure_look_.rows / 2.0},
                               upright.width * own_from_frame,
                               upright.height * own_from_frame,
                               -box_.turn_rad},
                              {side(upright.width), side(upright.height)});
  if (small.cols < look.cols || small.rows < look.rows) return places;
  cv::Mat likeness;
  cv::matchTemplate(small, look, likeness, cv::TM_CCOEFF_NORMED);
  for (int i = 0; i < kMostPlaces; ++i) {
    double height = 0;
    cv::Point peak;
    cv::minMaxLoc(likeness, nullptr, &height, nullptr, &peak);
    if (!(height >= kLeastLikeness)) break;
    const Eigen::Vector2d centre(peak.x + look.cols / 2.0, peak.y + look.rows / 2.0);
    places.push_back({centre / small_from_frame, box_.width * size, box_.height * size, box_.turn_rad});
    const cv::Rect taken(peak.x - look.cols / 2, peak.y - look.rows / 2, look.cols, look.rows);
    likeness(taken & cv::Rect({0, 0}, likeness.size())) = -1;
  }
  return places;
}

BoxTarget::Sight BoxTarget::Seek(const BoxScene& scene) {
  TurnedBox found;
  Sight best{.loss = TrackLoss::kOccluded};
  for (const TurnedBox& place : PlacesToSeek(scene)) {
    const Answer answer = Ask(scene.image, place);
    const double trust = Trust(scene.image, answer);
    if (trust < options_.return_trust || trust <= best.trust) continue;
    if (ShareInView(scene.image, answer.box) < options_.least_in_view) continue;
    found = answer.box;
    best = {.box = found.Upright(), .trust = trust, .doubtful = true};
  }
  if (best.loss == TrackLoss::kNone) {
    box_ = found;
    lost_frames_ = 0;
    doubtful_ = true;
  } else {
    ++lost_frames_;
    if (ShareInView(scene.image, box_) < options_.least_in_view) best.loss = TrackLoss::kLeftFrame;
  }
  return best;
}

BoxTarget::Sight BoxTarget::Resume(const BoxScene& scene, const Box& box, double turn_rad, double least_trust) {
  TurnedBox around = Unturned(box);
  around.turn_rad = turn_rad;
  const Answer answer = Ask(scene.image, around);
  const double trust = Trust(scene.image, answer);
  if (trust < least_trust || ShareInView(scene.image, answer.box) < options_.least_in_view) {
    return {.loss = TrackLoss::kOccluded};
  }
  box_ = answer.box;
  lost_frames_ = 0;
  doubtful_ = false;
  return {.box = box_.Upright(), .trust = trust};
}

void BoxTarget::Lose() {
  lost_frames_ = 1;
  lost_at_ = box_;
}

}  // namespace victorious
