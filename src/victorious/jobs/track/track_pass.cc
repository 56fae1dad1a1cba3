#include "victorious/jobs/track/track_pass.h"

#include <algorithm>
#include <iterator>

#include "victorious/input/image/image_file.h"
#include "victorious/input/image/impulse_noise.h"

namespace victorious {

std::optional<CameraState> BoxPlacePrior::CameraAt(const Frame& frame) const { return cameras_.At(frame.time_s); }

bool BoxPlacePrior::IsInconsistent(std::size_t box_index, const Box& box, const Frame& frame) const {
  const auto camera = CameraAt(frame);
  if (!static_boxes_[box_index] || !camera) return false;
  const auto observation = MakeBoxBearingObservation(box, frame.image.size(), *camera, nullptr, 0);
  return observation && !IsConsistentWithPlace(*observation, static_boxes_[box_index]->place, options_);
}

std::optional<PredictedBox> BoxPlacePrior::Predict(std::size_t box_index, const Frame& frame) const {
  const auto camera = CameraAt(frame);
  if (!static_boxes_[box_index] || !camera) return std::nullopt;
  const StaticBox& standing = *static_boxes_[box_index];
  return PredictBox(standing.place.point, standing.box, standing.camera, *camera, frame.image.size());
}

Expected<std::shared_ptr<const Recognizer>> MakeBoxRecognizer(const Frame& frame, const Box& box,
                                                              const std::string& name, const PhotoModelOptions& model,
                                                              const RecognizeOptions& recognize) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Photo photo, PreparePhoto(name, frame.image, {}, box));
  const Photo photos[] = {photo};
  VICTORIOUS_ASSIGN_OR_RETURN(ObjectModel made, MakePhotoModel(name, photos, std::nullopt, model));
  VICTORIOUS_ASSIGN_OR_RETURN(Recognizer recognizer,
                              Recognizer::Create({std::move(made)}, model.features.engine, recognize));
  return std::make_shared<const Recognizer>(std::move(recognizer));
}

Expected<Box> TrackPass::Start(const UserBoxTarget& target) {
  VICTORIOUS_ASSIGN_OR_RETURN(const BoxTrackStep step, tracker_.Start(target.box));
  targets_.push_back({.target = target, .last_box = step.box});
  if (impulse_fraction_) targets_.back().ground.emplace(FlowPyramid(CleanGrey(last_image_)), step.box);
  return step.box;
}

void TrackPass::SetRecognizer(std::shared_ptr<const Recognizer> recognizer) {
  targets_.back().target.recognizer = std::move(recognizer);
}

void TrackPass::ChangeVideo() {
  tracker_.ChangeVideo();
  impulse_fraction_.reset();
  for (TrackedTarget& followed : targets_) {
    followed.tentative.clear();
    followed.ground.reset();
  }
}

Status TrackPass::ProcessFrame(const Frame& frame, std::size_t video, const BoxPlacePrior* place_prior,
                               std::vector<BoxSighting>& sightings) {
  TrackGroundPoints(frame);
  std::vector<std::size_t> lost;
  for (const BoxTrackStep& step : tracker_.Step(frame)) {
    if (!HandleStep(step, frame, video, place_prior, nullptr, sightings)) lost.push_back(step.target);
  }
  ++seen_frames_;
  if (seen_frames_ % recognize_every_ != 0) return {};
  if (place_prior != nullptr) {
    std::erase_if(lost,
                  [&](std::size_t target) { return ResumeAtPlace(target, frame, video, *place_prior, sightings); });
  }
  std::erase_if(lost, [&](std::size_t target) { return targets_[target].target.recognizer == nullptr; });
  if (lost.empty()) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet scene, extractor_->Extract(GreyFromBgr(frame.image)));
  for (const std::size_t target : lost) {
    VICTORIOUS_RETURN_IF_ERROR(ResumeByRecognition(target, scene, frame, video, place_prior, sightings));
  }
  return {};
}

bool TrackPass::HandleStep(const BoxTrackStep& step, const Frame& frame, std::size_t video,
                           const BoxPlacePrior* place_prior, const Detection* recognised,
                           std::vector<BoxSighting>& sightings) {
  TrackedTarget& followed = targets_[step.target];
  const std::size_t box_index = followed.target.box_index;
  const bool elsewhere =
      step.seen() && place_prior != nullptr && place_prior->IsInconsistent(box_index, step.extent, frame);
  if (elsewhere) tracker_.MarkLost(step.target);
  followed.last_box.reset();
  if (elsewhere || !step.seen()) {
    followed.tentative.clear();
    return false;
  }
  followed.last_box = step.box;
  BoxSighting sighting{.box_index = box_index,
                       .video = video,
                       .frame = frame.index,
                       .time_s = frame.time_s,
                       .box = step.box,
                       .extent = step.extent,
                       .score = step.confidence};
  if (recognised != nullptr) {
    sighting.score = recognised->score;
    sighting.matches = recognised->fit.inliers.size();
  }
  followed.tentative.push_back(sighting);
  if (!step.tentative) {
    std::ranges::move(followed.tentative, std::back_inserter(sightings));
    followed.tentative.clear();
  }
  return true;
}

cv::Mat TrackPass::CleanGrey(const cv::Mat& image) const {
  return RemoveImpulses(GreyFromBgr(image), *impulse_fraction_);
}

void TrackPass::TrackGroundPoints(const Frame& frame) {
  if (!impulse_fraction_) return;
  last_image_ = frame.image;
  if (std::ranges::none_of(targets_, [](const TrackedTarget& one) { return one.ground.has_value(); })) return;
  const FlowPyramid clean(CleanGrey(frame.image));
  for (TrackedTarget& followed : targets_) {
    if (!followed.ground) continue;
    if (const auto position_px = followed.ground->Step(clean, followed.last_box)) {
      ground_points_.push_back({followed.target.box_index, {frame.index, frame.time_s, *position_px}});
    } else {
      followed.ground.reset();
    }
  }
}

bool TrackPass::ResumeAtPlace(std::size_t target, const Frame& frame, std::size_t video,
                              const BoxPlacePrior& place_prior, std::vector<BoxSighting>& sightings) {
  const auto expected = place_prior.Predict(targets_[target].target.box_index, frame);
  if (!expected) return false;
  const Box inside = Intersection(expected->box, FrameBox(frame.image.cols, frame.image.rows));
  constexpr double kMinInView = 0.5;
  if (!(inside.Area() > kMinInView * expected->box.Area())) return false;
  const BoxTrackStep step =
      tracker_.Resume(target, expected->box, expected->turn_rad, BoxTracker::ResumeBasis::kPredicted);
  return HandleStep(step, frame, video, &place_prior, nullptr, sightings);
}

Status TrackPass::ResumeByRecognition(std::size_t target, const FeatureSet& scene, const Frame& frame,
                                      std::size_t video, const BoxPlacePrior* place_prior,
                                      std::vector<BoxSighting>& sightings) {
  const UserBoxTarget& user_box = targets_[target].target;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Detection> detections, user_box.recognizer->Recognize(scene));
  if (detections.empty()) return {};
  const Detection& best = detections.front();
  // Keeps the shape of the user box at any rotation: a box around the rotated outline would be too large.
  const Box around = BoundingBox(best.outline);
  const double scale = best.fit.scene_from_template.scale;
  const double width = user_box.box.width * scale;
  const double height = user_box.box.height * scale;
  const Box box{around.x + (around.width - width) / 2, around.y + (around.height - height) / 2, width, height};
  const BoxTrackStep step =
      tracker_.Resume(target, box, best.fit.scene_from_template.rotation_rad, BoxTracker::ResumeBasis::kRecognised);
  HandleStep(step, frame, video, place_prior, &best, sightings);
  return {};
}

}  // namespace victorious
