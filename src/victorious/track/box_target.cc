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

// Set by hand unless a source is given; bench/accuracy/box_tracking.py measures the tracker.

// Side of the search window relative to the object's size (square root of its area), as in Galoogahi 2017: half of it,
// minus half the object, is the largest motion between frames relative to the camera's motion.
constexpr double kWindowFactor = 5;
constexpr int kWindowCells = 48;       // along the window's side: about 10 cells on the object
constexpr double kMinSide_px = 4;      // of a box and of a crop
constexpr double kColourWeight = 0.5;  // gives colours roughly the energy of the gradients
// Weight of the temporal regularisation of the correlation filter, in units of the window's energy: larger values adapt
// more slowly.
constexpr double kTemporalWeight = 8;
constexpr double kScaleLearningRate = 0.025;   // Danelljan 2017
constexpr double kVelocityLearningRate = 0.3;  // of the object's own velocity, which with the camera's motion predicts
                                               // its position
constexpr double kVelocityDecay = 0.9;         // per frame while lost: an occluded object may have stopped
constexpr double kMeanRate = 0.02;             // running means over roughly the last 50 frames
constexpr int kMaxUnseenFrames = 10;           // of another object, which is then forgotten
constexpr double kMinSharpness = 1e-6;         // below: a uniform window, without information
constexpr double kMinMeanNcc = 0.1;            // of a sample for the running mean, which is a divisor
// Minimum confidence to store a template of a frame.
constexpr double kTemplateConfidence = 0.85;
// Rotation of the camera after which the box is tested with that rotation: a smaller one hardly changes the features.
constexpr double kMinRotation_rad = 0.1;

// Re-detection by template matching in the whole frame.
constexpr double kSearchSide_px = 16;  // smallest side that still discriminates; the frame is scaled down to it
constexpr std::array kScaleCycle = {1.0, 0.8, 1.25};  // of the template, from frame to frame
constexpr double kMinNcc = 0.3;                       // of a candidate
constexpr int kMaxCandidates = 4;

// Reach of a lost object, in units of its size (square root of the box's area): how far from its predicted or its last
// position it may be by its own motion and the errors of the camera's. Beyond the reach, only its appearance speaks for
// it, and other objects look similar: the templates must fit almost as well as they usually do, and better than they
// fit any other object that was in view together with the target. The sharpness of the response does not tell two
// objects apart, since it depends on the surroundings.
constexpr double kReach = 3;
constexpr double kReachPerFrame = 0.15;
constexpr double kFarNcc = 0.8;       // of its running mean
constexpr double kRivalMargin = 0.1;  // between the target's relative NCC and that of a similar object
constexpr int kRivalInterval = 8;     // updates between two searches for similar objects, which search the whole frame
constexpr double kRivalDecay = 0.9;   // per such search: a similar object may be hidden for a while

RotatedBox MakeWindow(const RotatedBox& box) {
  const double side = kWindowFactor * std::sqrt(box.Area());
  return {box.centre, side, side, box.rotation_rad};
}

FilterShape MakeFilterShape(const Box& box) {
  const double cells_per_px = kWindowCells / (kWindowFactor * std::sqrt(box.Area()));
  const auto cells = [&](double length_px) {
    return static_cast<float>(std::clamp(length_px * cells_per_px, 3.0, static_cast<double>(kWindowCells)));
  };
  return {{kWindowCells, kWindowCells}, {cells(box.width), cells(box.height)}};
}

double FractionInView(const ImagePyramid& pyramid, const RotatedBox& turned) {
  const cv::Mat& image = pyramid.image();
  return FractionInside(BoxCorners(turned.EllipseBounds()), FrameBox(image.cols, image.rows));
}

cv::Mat CropGrey(const ImagePyramid& image, const RotatedBox& box) {
  const auto side = [](double length_px) { return static_cast<int>(std::lround(std::max(kMinSide_px, length_px))); };
  cv::Mat grey_template = CropRotated(image, box, {side(box.width), side(box.height)});
  if (grey_template.channels() == 3) cv::cvtColor(grey_template, grey_template, cv::COLOR_BGR2GRAY);
  return grey_template;
}

}  // namespace

BoxTarget::BoxTarget(const FrameContext& context, const Box& box, const BoxTrackOptions& options)
    : options_(options),
      box_(ToRotatedBox(box)),
      last_seen_box_(box_),
      filter_(MakeFilterShape(box)),
      scale_(box_),
      appearance_(context.image, box_),
      confident_template_(CropGrey(context.image, box_)) {
  filter_.Update(ExtractWindow(context.image, box_), kTemporalWeight);
  scale_.Update(context.image, box_, 1);
}

// The feature window around a box, the input of the correlation filter.
CellFeatures BoxTarget::ExtractWindow(const ImagePyramid& image, const RotatedBox& box) const {
  const cv::Mat cut = CropRotated(image, MakeWindow(box), {kWindowCells * kCell_px, kWindowCells * kCell_px});
  CellFeatures channels = ComputeHogCells(cut);
  for (const cv::Mat& colour : ComputeColourCells(cut))
    channels.emplace_back((colour - cv::mean(colour)[0]) * kColourWeight);
  return channels;
}

// Applies the filter to the window around a box and moves the box to the response's peak.
BoxTarget::Localisation BoxTarget::Localise(const ImagePyramid& image, const RotatedBox& search_box) const {
  const FilterResponse response = filter_.ComputeResponse(ExtractWindow(image, search_box));
  const double px_per_cell = MakeWindow(search_box).width / kWindowCells;
  RotatedBox box = search_box;
  const Eigen::Vector2d moved(response.peak.x * px_per_cell, response.peak.y * px_per_cell);
  box.centre += Eigen::Rotation2Dd(search_box.rotation_rad) * moved;
  return {box, response.sharpness};
}

// The NCC with the best template relative to its running mean, clipped to [0, 1].
double BoxTarget::RelativeNcc(const ImagePyramid& image, const RotatedBox& box) const {
  return std::clamp(appearance_.NccScore(image, box) / mean_ncc_, 0.0, 1.0);
}

// The geometric mean of sharpness and NCC, each relative to its running mean and clipped to 1.
double BoxTarget::ComputeConfidence(const ImagePyramid& image, const Localisation& localisation) const {
  if (num_updates_ == 0) return 1;
  const double sharpness = std::clamp(localisation.sharpness / std::max(kMinSharpness, mean_sharpness_), 0.0, 1.0);
  return std::sqrt(sharpness * RelativeNcc(image, localisation.box));
}

// Localises the object. If the camera has rotated by 0.1 rad since the last test, also localises with that rotation and
// returns the result with the higher sharpness times NCC: a camera that flies past shears the image, and the fitted
// similarity then has a rotation that the object does not make.
BoxTarget::Localisation BoxTarget::LocaliseWithRotation(const ImagePyramid& image) {
  const Localisation as_before = Localise(image, box_);
  if (std::abs(pending_rotation_rad_) < kMinRotation_rad) return as_before;
  RotatedBox with_camera = box_;
  with_camera.rotation_rad += std::exchange(pending_rotation_rad_, 0.0);
  const Localisation turned = Localise(image, with_camera);
  const auto score = [&](const Localisation& localisation) {
    return localisation.sharpness * std::max(0.0, appearance_.NccScore(image, localisation.box));
  };
  return score(turned) >= score(as_before) ? turned : as_before;
}

BoxTarget::TargetObservation BoxTarget::Step(const FrameContext& context) {
  const Similarity2 camera = context.now_from_before.value_or(Similarity2{});
  const Eigen::Vector2d carried = camera.Apply(box_.centre);
  box_.centre = carried + velocity_px_;
  pending_rotation_rad_ += camera.rotation_rad;
  if (lost()) {
    PredictLost(context);
    return Redetect(context);
  }
  const bool predicted_outside = FractionInView(context.image, box_) < options_.min_in_view;
  const Localisation localisation = LocaliseWithRotation(context.image);
  const double confidence = ComputeConfidence(context.image, localisation);
  const bool left = FractionInView(context.image, localisation.box) < options_.min_in_view;
  if (left || confidence < (tentative_ ? options_.redetect_confidence : options_.lost_confidence)) {
    MarkLost(/*position_known=*/true);
    return {.loss = left ? TrackLoss::kLeftFrame : TrackLoss::kOccluded};
  }
  box_ = localisation.box;
  // A box cut by the frame's edge supports the confidence by its visible fraction only.
  tentative_ = tentative_ && confidence * FractionInView(context.image, box_) < options_.update_confidence;
  if (confidence >= options_.update_confidence) {
    velocity_px_ += kVelocityLearningRate * (box_.centre - carried - velocity_px_);
    Update(context, localisation, confidence);
  }
  // At the edge the filter has a peak inside the frame even if the object is outside.
  if (predicted_outside && confidence < options_.update_confidence) return {.loss = TrackLoss::kLeftFrame};
  return {.box = box_.EllipseBounds(), .confidence = confidence, .tentative = tentative_};
}

// Where a lost target, and what was found not to be it, are by now.
void BoxTarget::PredictLost(const FrameContext& context) {
  velocity_px_ *= kVelocityDecay;
  // Far outside the frame the estimated ground motion does not apply: a target that it brings back is only near there.
  const Eigen::Vector2d size(context.grey.cols, context.grey.rows);
  const Eigen::Vector2d near = box_.centre.cwiseMax(-size).cwiseMin(2 * size);
  const bool is_far = near != box_.centre;
  box_.centre = near;
  if (!context.now_from_before) {
    others_.clear();
    if (whereabouts_ != Whereabouts::kUnknown) whereabouts_ = Whereabouts::kGuessed;
    return;
  }
  if (is_far && whereabouts_ == Whereabouts::kPredicted) whereabouts_ = Whereabouts::kFarOutside;
  if (whereabouts_ == Whereabouts::kFarOutside && FractionInView(context.image, box_) >= options_.min_in_view)
    whereabouts_ = Whereabouts::kGuessed;
  for (Other& other : others_) other.centre_px = context.now_from_before->Apply(other.centre_px);
  std::erase_if(others_, [](Other& other) { return ++other.unseen_frames > kMaxUnseenFrames; });
}

void BoxTarget::Update(const FrameContext& context, const Localisation& localisation, double confidence) {
  const RotatedBox grown = box_.Scaled(scale_.EstimateScaleChange(context.image, box_));
  if (std::min(grown.width, grown.height) >= kMinSide_px) box_ = grown;
  ++num_updates_;
  const double rate = std::max(kMeanRate, 1.0 / num_updates_);
  mean_sharpness_ += rate * (localisation.sharpness - mean_sharpness_);
  mean_ncc_ += rate * (std::max(kMinMeanNcc, appearance_.NccScore(context.image, box_)) - mean_ncc_);
  filter_.Update(ExtractWindow(context.image, box_), kTemporalWeight);
  scale_.Update(context.image, box_, kScaleLearningRate);
  if (confidence < kTemplateConfidence) return;
  appearance_.AddTemplate(context.image, box_);
  confident_template_ = CropGrey(context.image, box_);
  if (num_updates_ % kRivalInterval == 1) {
    rival_ncc_ = std::max(kRivalDecay * rival_ncc_, MeasureRival(context));
  }
}

// The relative NCC of the most similar object elsewhere in the frame; 0 if there is none.
double BoxTarget::MeasureRival(const FrameContext& context) const {
  const double size_px = std::sqrt(box_.Area());
  double rival = 0;
  for (const RotatedBox& candidate : FindSimilarPlaces(context)) {
    const RotatedBox found = Localise(context.image, candidate).box;
    if ((found.centre - box_.centre).norm() < size_px) continue;
    if (FractionInView(context.image, found) < options_.min_in_view) continue;
    rival = std::max(rival, RelativeNcc(context.image, found));
  }
  return rival;
}

// The best matches (NCC) of the last confident template in the whole frame; the template's scale cycles through three
// values from frame to frame while the object is lost.
std::vector<RotatedBox> BoxTarget::FindSimilarPlaces(const FrameContext& context) const {
  std::vector<RotatedBox> candidates;
  const double size = kScaleCycle[static_cast<std::size_t>(lost_frames_) % kScaleCycle.size()];
  const double shrink = std::min(1.0, kSearchSide_px / std::sqrt(box_.Area()));
  const double small_from_frame = shrink / size;
  const auto shrunk = [&](int length_px) {
    return std::max(1, static_cast<int>(std::lround(length_px * small_from_frame)));
  };
  cv::Mat small;
  cv::resize(context.grey, small, {shrunk(context.grey.cols), shrunk(context.grey.rows)}, 0, 0, cv::INTER_AREA);
  // The template with the rotation of the current frame.
  const Box upright = box_.EllipseBounds();
  const auto side = [&](double length_px) {
    return static_cast<int>(std::lround(std::max(kMinSide_px, length_px * shrink)));
  };
  const double own_from_frame = std::sqrt(static_cast<double>(confident_template_.total()) / box_.Area());
  const cv::Mat grey_template = CropRotated(ImagePyramid(confident_template_),
                                            {{confident_template_.cols / 2.0, confident_template_.rows / 2.0},
                                             upright.width * own_from_frame,
                                             upright.height * own_from_frame,
                                             -box_.rotation_rad},
                                            {side(upright.width), side(upright.height)});
  if (small.cols < grey_template.cols || small.rows < grey_template.rows) return candidates;
  cv::Mat ncc;
  cv::matchTemplate(small, grey_template, ncc, cv::TM_CCOEFF_NORMED);
  for (int i = 0; i < kMaxCandidates; ++i) {
    double height = 0;
    cv::Point peak;
    cv::minMaxLoc(ncc, nullptr, &height, nullptr, &peak);
    if (!(height >= kMinNcc)) break;
    const Eigen::Vector2d centre(peak.x + grey_template.cols / 2.0, peak.y + grey_template.rows / 2.0);
    candidates.push_back({centre / small_from_frame, box_.width * size, box_.height * size, box_.rotation_rad});
    const cv::Rect suppressed(peak.x - grey_template.cols / 2, peak.y - grey_template.rows / 2, grey_template.cols,
                              grey_template.rows);
    ncc(suppressed & cv::Rect({0, 0}, ncc.size())) = -1;
  }
  return candidates;
}

bool BoxTarget::IsInReach(const RotatedBox& box, const RotatedBox& from) const {
  return (box.centre - from.centre).norm() <= (kReach + kReachPerFrame * lost_frames_) * std::sqrt(box_.Area());
}

// Whether what looks like the target can be it. What is seen in the frame while the target is outside is another
// object, and stays so as long as it is seen there.
bool BoxTarget::MayBeAt(const FrameContext& context, const RotatedBox& box) {
  if (whereabouts_ == Whereabouts::kUnknown) return true;
  const double size_px = std::sqrt(box_.Area());
  const auto other =
      std::ranges::find_if(others_, [&](const Other& one) { return (box.centre - one.centre_px).norm() <= size_px; });
  if (other != others_.end()) {
    *other = {box.centre};
    return false;
  }
  if (IsInReach(box, box_)) return true;
  const bool has_left =
      whereabouts_ != Whereabouts::kGuessed && FractionInView(context.image, box_) < options_.min_in_view;
  if (has_left) {
    others_.push_back({box.centre});
    return false;
  }
  return IsInReach(box, last_seen_box_) ||
         RelativeNcc(context.image, box) >= std::max(kFarNcc, rival_ncc_ + kRivalMargin);
}

// The predicted box, every second frame the box where the object was lost, and the similar places.
BoxTarget::TargetObservation BoxTarget::Redetect(const FrameContext& context) {
  std::vector<RotatedBox> candidates = FindSimilarPlaces(context);
  if (lost_frames_ % 2 == 0) candidates.insert(candidates.begin(), last_seen_box_);
  candidates.insert(candidates.begin(), box_);
  RotatedBox found;
  TargetObservation best{.loss = TrackLoss::kOccluded};
  for (const RotatedBox& candidate : candidates) {
    const Localisation localisation = Localise(context.image, candidate);
    const double confidence = ComputeConfidence(context.image, localisation);
    if (confidence < options_.redetect_confidence || confidence <= best.confidence) continue;
    if (FractionInView(context.image, localisation.box) < options_.min_in_view) continue;
    if (!MayBeAt(context, localisation.box)) continue;
    found = localisation.box;
    best = {.box = found.EllipseBounds(), .confidence = confidence, .tentative = true};
  }
  if (best.loss == TrackLoss::kNone) {
    box_ = found;
    lost_frames_ = 0;
    tentative_ = true;
  } else {
    ++lost_frames_;
    if (FractionInView(context.image, box_) < options_.min_in_view) best.loss = TrackLoss::kLeftFrame;
  }
  return best;
}

BoxTarget::TargetObservation BoxTarget::Resume(const FrameContext& context, const Box& box, double rotation_rad,
                                               double min_confidence, bool is_place_known) {
  RotatedBox around = ToRotatedBox(box);
  around.rotation_rad = rotation_rad;
  const Localisation localisation = Localise(context.image, around);
  const double confidence = ComputeConfidence(context.image, localisation);
  if (confidence < min_confidence || FractionInView(context.image, localisation.box) < options_.min_in_view) {
    return {.loss = TrackLoss::kOccluded};
  }
  if (!is_place_known && !MayBeAt(context, localisation.box)) return {.loss = TrackLoss::kOccluded};
  box_ = localisation.box;
  lost_frames_ = 0;
  tentative_ = false;
  return {.box = box_.EllipseBounds(), .confidence = confidence};
}

void BoxTarget::MarkLost(bool position_known) {
  lost_frames_ = 1;
  last_seen_box_ = box_;
  whereabouts_ = position_known ? Whereabouts::kPredicted : Whereabouts::kUnknown;
  others_.clear();
}

}  // namespace victorious
