#include "victorious/track/region_tracker.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"
#include "victorious/geometry/robust/mlesac.h"
#include "victorious/geometry/robust/similarity_estimator.h"
#include "victorious/track/camera_motion.h"

namespace victorious {
namespace {

constexpr int kPatchSide_px = 13;     // of a point's patch: about that of a small keypoint's neighbourhood
constexpr double kPointNoise_px = 1;  // standard deviation of a tracked point's position
// Model error of the similarity for an object that rotates out of the image plane, as a fraction of its size (square
// root of its outline's area).
constexpr double kShapeFraction = 0.02;
constexpr int kMinPoints = 4;        // minimum number of inliers for the object to be seen; a similarity takes two
constexpr double kMinSupport = 0.2;  // minimum fraction of inliers among the template's points inside the frame
constexpr double kMinInView = 0.3;   // minimum fraction of the outline's area inside the frame; below it the object
                                     // has left the frame
constexpr double kMinInlierProbability = 0.5;  // of MLESAC: more probably an inlier than not
constexpr double kMinOutlierArea_px2 = 100;    // of the search region of a tiny outline, for MLESAC's outlier density
// Between two frames. An object does not change its scale so much; near-collinear points with pixel errors give such
// fits.
constexpr double kMaxScaleChange = 1.5;

Eigen::Vector2d Centroid(const Polygon& outline) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : outline) sum += corner;
  return outline.empty() ? sum : Eigen::Vector2d(sum / static_cast<double>(outline.size()));
}

Polygon Transformed(Polygon outline, const Similarity2& map) {
  for (Eigen::Vector2d& corner : outline) corner = map.Apply(corner);
  return outline;
}

Box Dilated(const Box& box, double factor) {
  const double width = box.width * factor;
  const double height = box.height * factor;
  return {box.x - (width - box.width) / 2, box.y - (height - box.height) / 2, width, height};
}

cv::Mat ToGrey(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace

Expected<RegionTracker> RegionTracker::Create(const TrackOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  return RegionTracker(options);
}

std::vector<TrackStep> RegionTracker::Step(const Frame& frame) {
  now_ = std::make_shared<FlowPyramid>(ToGrey(frame.image), options_.flow);
  frame_ = frame.index;
  time_s_ = frame.time_s;
  image_motions_.clear();
  for (const Track& track : tracks_) {
    if (track.velocity_px_s || !options_.predict_motion || image_motions_.contains(track.last.get())) continue;
    ImageMotionEstimator motion;
    motion.Step(track.last->grey());
    image_motions_[track.last.get()] = motion.Step(now_->grey()).value_or(Similarity2{});
  }
  std::vector<TrackStep> steps;
  std::vector<Track> active;
  for (Track& track : tracks_) {
    steps.push_back(Advance(track));
    if (steps.back().state == TrackState::kActive) active.push_back(std::move(track));
  }
  tracks_ = std::move(active);
  return steps;
}

TrackStep RegionTracker::Start(const Polygon& outline, std::span<const TrackPoint> points) {
  VICTORIOUS_CHECK(now_ != nullptr);
  Track track{
      .id = next_id_++, .outline = outline, .points = MakeTemplate(points), .last = now_, .last_time_s = time_s_};
  const bool accepted = track.points.size() >= static_cast<std::size_t>(kMinPoints);
  TrackStep step = MakeStep(track, accepted ? TrackLoss::kNone : TrackLoss::kLostPoints);
  if (accepted) {
    tracks_.push_back(std::move(track));
  } else {
    step.state = TrackState::kInactive;
  }
  return step;
}

TrackStep RegionTracker::Confirm(std::uint64_t id, const Polygon& outline, std::span<const TrackPoint> points) {
  const auto track = std::ranges::find(tracks_, id, &Track::id);
  VICTORIOUS_CHECK(track != tracks_.end());
  track->outline = outline;
  track->points = MakeTemplate(points);
  track->last_from_template = {};
  track->last = now_;
  track->last_time_s = time_s_;
  track->missed_frames = 0;
  track->unconfirmed_frames = 0;
  return MakeStep(*track, TrackLoss::kNone);
}

void RegionTracker::Stop(std::uint64_t id) {
  std::erase_if(tracks_, [id](const Track& track) { return track.id == id; });
}

std::vector<RegionTracker::TemplatePoint> RegionTracker::MakeTemplate(std::span<const TrackPoint> points) const {
  const Box frame = FrameBox(now_->grey().cols, now_->grey().rows);
  std::vector<TemplatePoint> usable;
  for (const TrackPoint& point : points) {
    if (!frame.Contains(point.position_px.x(), point.position_px.y())) continue;
    Patch patch(now_->grey(), point.position_px, kPatchSide_px, Eigen::Matrix2d::Identity());
    if (!patch.IsFlat()) usable.push_back({point, std::move(patch), point.position_px});
  }
  return usable;
}

// The predicted shift, px, since the object was last seen: by its velocity, or else by the global image motion.
Eigen::Vector2d RegionTracker::PredictShift(const Track& track) const {
  if (!options_.predict_motion) return Eigen::Vector2d::Zero();
  if (track.velocity_px_s) return *track.velocity_px_s * (time_s_ - track.last_time_s);
  const auto move = image_motions_.find(track.last.get());
  if (move == image_motions_.end()) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d before = Centroid(Transformed(track.outline, track.last_from_template));
  return move->second.Apply(before) - before;
}

// Tracks the points from the frame where the object was last seen, starting `drift` px off, and fits the similarity.
RegionTracker::MotionEstimate RegionTracker::EstimateMotion(const Track& track, const Eigen::Vector2d& drift) const {
  std::vector<std::size_t> indices;
  std::vector<Eigen::Vector2d> from;
  std::vector<Eigen::Vector2d> guesses;
  for (std::size_t i = 0; i < track.points.size(); ++i) {
    if (!track.points[i].is_tracked) continue;
    indices.push_back(i);
    from.push_back(track.points[i].position_px);
    guesses.emplace_back(track.points[i].position_px + drift);
  }
  const std::vector<std::optional<Eigen::Vector2d>> followed =
      TrackPointsForwardBackward(*track.last, *now_, from, guesses);

  MotionEstimate estimate;
  const Eigen::Matrix2d linear = track.last_from_template.Linear();
  std::vector<PointPair> pairs;
  std::vector<std::size_t> point_index;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    if (!followed[k]) continue;
    const TemplatePoint& point = track.points[indices[k]];
    const Patch seen(now_->grey(), *followed[k], kPatchSide_px, linear);
    if (point.patch.NccScore(seen) < options_.min_ncc) continue;
    pairs.push_back({point.origin.position_px, *followed[k]});
    point_index.push_back(indices[k]);
  }

  const double size_px = std::sqrt(std::abs(SignedArea(track.outline)));
  const SimilarityEstimator estimator(pairs, {.noise_px = kPointNoise_px, .shape_px = kShapeFraction * size_px});
  const Box search =
      Dilated(BoundingBox(Transformed(track.outline, track.last_from_template)), options_.dilation_factor);
  const auto result = Mlesac(estimator, {.outlier_area_px2 = std::max(kMinOutlierArea_px2, search.Area())});
  if (!result) return estimate;
  estimate.now_from_template = result->model;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (result->probabilities[k] > kMinInlierProbability)
      estimate.inliers.emplace_back(point_index[k], pairs[k].target);
  }
  // Only points inside the frame count.
  const Box frame = FrameBox(now_->grey().cols, now_->grey().rows);
  const auto in_view = std::ranges::count_if(track.points, [&](const TemplatePoint& point) {
    const Eigen::Vector2d position_px = result->model.Apply(point.origin.position_px);
    return frame.Contains(position_px.x(), position_px.y());
  });
  const double growth = std::abs(std::log(result->model.scale / track.last_from_template.scale));
  const auto agreeing = static_cast<double>(estimate.inliers.size());
  estimate.accepted = agreeing >= kMinPoints && agreeing >= kMinSupport * static_cast<double>(in_view) &&
                      growth < std::log(kMaxScaleChange);
  return estimate;
}

void RegionTracker::ApplyMotion(Track& track, const MotionEstimate& estimate) const {
  const Eigen::Vector2d before = Centroid(Transformed(track.outline, track.last_from_template));
  const Eigen::Vector2d after = Centroid(Transformed(track.outline, estimate.now_from_template));
  const double elapsed_s = time_s_ - track.last_time_s;
  if (elapsed_s != 0) track.velocity_px_s = (after - before) / elapsed_s;
  track.last_from_template = estimate.now_from_template;
  track.last = now_;
  track.last_time_s = time_s_;
  track.missed_frames = 0;
  for (TemplatePoint& point : track.points) point.is_tracked = false;
  for (const auto& [index, position_px] : estimate.inliers) {
    track.points[index].position_px = position_px;
    track.points[index].is_tracked = true;
  }
  ReacquirePoints(track);
}

void RegionTracker::ReacquirePoints(Track& track) const {
  const Box frame = FrameBox(now_->grey().cols, now_->grey().rows);
  const Eigen::Matrix2d linear = track.last_from_template.Linear();
  for (TemplatePoint& point : track.points) {
    if (point.is_tracked) continue;
    point.position_px = track.last_from_template.Apply(point.origin.position_px);
    if (!frame.Contains(point.position_px.x(), point.position_px.y())) continue;
    const Patch seen(now_->grey(), point.position_px, kPatchSide_px, linear);
    point.is_tracked = point.patch.NccScore(seen) >= options_.min_ncc;
  }
}

// kOccluded if at more than half of the predicted points the patch is textured but does not match; else kLostPoints.
TrackLoss RegionTracker::ClassifyLoss(const Track& track) const {
  const Eigen::Vector2d drift = PredictShift(track);
  std::size_t num_mismatches = 0;
  for (const TemplatePoint& point : track.points) {
    const Eigen::Vector2d position_px = track.last_from_template.Apply(point.origin.position_px) + drift;
    const Patch seen(now_->grey(), position_px, kPatchSide_px, track.last_from_template.Linear());
    if (!seen.IsFlat() && point.patch.NccScore(seen) < options_.min_ncc) ++num_mismatches;
  }
  return 2 * num_mismatches > track.points.size() ? TrackLoss::kOccluded : TrackLoss::kLostPoints;
}

TrackStep RegionTracker::Advance(Track& track) const {
  ++track.unconfirmed_frames;
  const Box frame = FrameBox(now_->grey().cols, now_->grey().rows);
  MotionEstimate estimate = EstimateMotion(track, PredictShift(track));
  // An object that the camera follows keeps its image position while the background moves.
  if (!estimate.accepted && !track.velocity_px_s) estimate = EstimateMotion(track, Eigen::Vector2d::Zero());
  if (estimate.accepted) ApplyMotion(track, estimate);

  TrackLoss loss = TrackLoss::kNone;
  if (!estimate.accepted) {
    ++track.missed_frames;
    loss = ClassifyLoss(track);
  }
  if (track.unconfirmed_frames > options_.unconfirmed_frames) loss = TrackLoss::kUnconfirmed;
  TrackStep step = MakeStep(track, loss);
  if (FractionInside(step.outline, frame) < kMinInView) step = MakeStep(track, TrackLoss::kLeftFrame);
  const bool given_up = track.missed_frames > options_.missed_frames || step.loss == TrackLoss::kUnconfirmed ||
                        step.loss == TrackLoss::kLeftFrame;
  if (given_up) step.state = TrackState::kInactive;
  return step;
}

TrackStep RegionTracker::MakeStep(const Track& track, TrackLoss loss) const {
  const Box frame = FrameBox(now_->grey().cols, now_->grey().rows);
  TrackStep step{.track = track.id,
                 .frame = frame_,
                 .time_s = time_s_,
                 .loss = loss,
                 .now_from_template = track.last_from_template,
                 .unconfirmed_frames = track.unconfirmed_frames};
  if (track.last != now_) step.now_from_template.translation += PredictShift(track);
  step.outline = Transformed(track.outline, step.now_from_template);
  step.search_box = Intersection(Dilated(BoundingBox(step.outline), options_.dilation_factor), frame);
  if (!step.seen()) return step;
  step.box = BoundingBox(ClipToBox(step.outline, frame));
  for (const TemplatePoint& point : track.points) {
    if (point.is_tracked) step.points.push_back({point.position_px, point.origin.inlier});
  }
  step.support =
      static_cast<double>(step.points.size()) / static_cast<double>(std::max<std::size_t>(1, track.points.size()));
  return step;
}

std::vector<TrackPoint> MatchedPoints(const Detection& detection, const FeatureSet& scene) {
  std::vector<TrackPoint> points;
  points.reserve(detection.fit.inliers.size());
  for (const FitInlier& inlier : detection.fit.inliers) {
    const Keypoint& keypoint = scene.keypoints[inlier.scene_keypoint];
    points.push_back({{keypoint.x, keypoint.y}, static_cast<std::uint32_t>(points.size())});
  }
  return points;
}

std::string_view Name(TrackState state) { return state == TrackState::kActive ? "active" : "inactive"; }

std::string_view Name(TrackLoss loss) {
  switch (loss) {
    case TrackLoss::kNone:
      return "none";
    case TrackLoss::kLostPoints:
      return "lost-points";
    case TrackLoss::kLeftFrame:
      return "left-frame";
    case TrackLoss::kOccluded:
      return "occluded";
    case TrackLoss::kUnconfirmed:
      return "unconfirmed";
  }
  return "";
}

}  // namespace victorious
