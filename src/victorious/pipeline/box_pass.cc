#include "victorious/pipeline/box_pass.h"

#include <algorithm>
#include <iterator>

#include "victorious/image/impulse_noise.h"
#include "victorious/image/image_file.h"

namespace victorious {

std::optional<CameraState> BoxGuide::CameraAt(const Frame& frame) const {
  return cameras_ ? cameras_->At(frame.time_s) : std::nullopt;
}

bool BoxGuide::Contradicts(std::size_t drawn, const Box& box, const Frame& frame) const {
  const auto camera = CameraAt(frame);
  if (!standing_[drawn] || !camera) return false;
  const auto sight = SightOfBox(box, frame.image.size(), *camera, nullptr, 0, options_);
  return sight && !GoesBy(*sight, standing_[drawn]->place, options_);
}

std::optional<SeenBox> BoxGuide::Expect(std::size_t drawn, const Frame& frame) const {
  const auto camera = CameraAt(frame);
  if (!standing_[drawn] || !camera) return std::nullopt;
  const StandingBox& standing = *standing_[drawn];
  return ExpectBox(standing.place.point, standing.box, standing.camera, *camera, frame.image.size());
}

Expected<std::shared_ptr<const Recognizer>> LearnBox(const Frame& frame, const Box& box, const std::string& name,
                                                     const PhotoModelOptions& model,
                                                     const RecognizeOptions& recognize) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Photo photo, PreparePhoto(name, frame.image, {}, box));
  const Photo photos[] = {photo};
  VICTORIOUS_ASSIGN_OR_RETURN(ObjectModel made, MakePhotoModel(name, photos, std::nullopt, model));
  VICTORIOUS_ASSIGN_OR_RETURN(Recognizer recognizer,
                              Recognizer::Create({std::move(made)}, model.features.engine, recognize));
  return std::make_shared<const Recognizer>(std::move(recognizer));
}

Expected<Box> BoxPass::Start(const DrawnTarget& target) {
  VICTORIOUS_ASSIGN_OR_RETURN(const BoxStep step, tracker_.Start(target.box));
  followed_.push_back({.target = target, .last_box = step.box});
  if (impulse_share_) followed_.back().ground.emplace(FlowPyramid(Clean(last_image_), {}), step.box);
  return step.box;
}

void BoxPass::Equip(std::shared_ptr<const Recognizer> recognizer) {
  followed_.back().target.recognizer = std::move(recognizer);
}

void BoxPass::ChangeVideo() {
  tracker_.ChangeVideo();
  impulse_share_.reset();
  for (Followed& followed : followed_) {
    followed.doubtful.clear();
    followed.ground.reset();
  }
}

Status BoxPass::See(const Frame& frame, std::size_t video, const BoxGuide* guide, std::vector<BoxSighting>& sightings) {
  SeeGround(frame);
  std::vector<std::size_t> lost;
  for (const BoxStep& step : tracker_.Step(frame)) {
    if (!Take(step, frame, video, guide, nullptr, sightings)) lost.push_back(step.target);
  }
  ++seen_frames_;
  if (seen_frames_ % recognize_every_ != 0) return {};
  if (guide != nullptr) {
    std::erase_if(lost, [&](std::size_t target) { return LookWhereItStands(target, frame, video, *guide, sightings); });
  }
  std::erase_if(lost, [&](std::size_t target) { return followed_[target].target.recognizer == nullptr; });
  if (lost.empty()) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet scene, extractor_->Extract(GreyFromBgr(frame.image)));
  for (const std::size_t target : lost) Recognise(target, scene, frame, video, guide, sightings);
  return {};
}

bool BoxPass::Take(const BoxStep& step, const Frame& frame, std::size_t video, const BoxGuide* guide,
                   const Detection* recognised, std::vector<BoxSighting>& sightings) {
  Followed& followed = followed_[step.target];
  const std::size_t drawn = followed.target.drawn;
  const bool elsewhere = step.seen() && guide != nullptr && guide->Contradicts(drawn, step.extent, frame);
  if (elsewhere) tracker_.Lose(step.target);
  followed.last_box.reset();
  if (elsewhere || !step.seen()) {
    followed.doubtful.clear();
    return false;
  }
  followed.last_box = step.box;
  BoxSighting sighting{.drawn = drawn,
                       .video = video,
                       .frame = frame.index,
                       .time_s = frame.time_s,
                       .box = step.box,
                       .extent = step.extent,
                       .score = step.trust};
  if (recognised != nullptr) {
    sighting.score = recognised->score;
    sighting.matches = recognised->pose.inliers.size();
  }
  followed.doubtful.push_back(sighting);
  if (!step.doubtful) {
    std::ranges::move(followed.doubtful, std::back_inserter(sightings));
    followed.doubtful.clear();
  }
  return true;
}

cv::Mat BoxPass::Clean(const cv::Mat& image) const { return WithoutImpulses(GreyFromBgr(image), *impulse_share_); }

void BoxPass::SeeGround(const Frame& frame) {
  if (!impulse_share_) return;
  last_image_ = frame.image;
  if (std::ranges::none_of(followed_, [](const Followed& one) { return one.ground.has_value(); })) return;
  const FlowPyramid clean(Clean(frame.image), {});
  for (Followed& followed : followed_) {
    if (!followed.ground) continue;
    if (const auto place = followed.ground->Step(clean, followed.last_box)) {
      spots_.push_back({followed.target.drawn, {frame.index, frame.time_s, *place}});
    } else {
      followed.ground.reset();
    }
  }
}

bool BoxPass::LookWhereItStands(std::size_t target, const Frame& frame, std::size_t video, const BoxGuide& guide,
                                std::vector<BoxSighting>& sightings) {
  const auto expected = guide.Expect(followed_[target].target.drawn, frame);
  if (!expected) return false;
  const Box inside = Intersection(expected->box, FrameBox(frame.image.cols, frame.image.rows));
  constexpr double kLeastInView = 0.5;
  if (!(inside.Area() > kLeastInView * expected->box.Area())) return false;
  const BoxStep step = tracker_.Resume(target, expected->box, expected->turn_rad, BoxTracker::Evidence::kPlace);
  return Take(step, frame, video, &guide, nullptr, sightings);
}

void BoxPass::Recognise(std::size_t target, const FeatureSet& scene, const Frame& frame, std::size_t video,
                        const BoxGuide* guide, std::vector<BoxSighting>& sightings) {
  const DrawnTarget& drawn = followed_[target].target;
  const std::vector<Detection> detections = drawn.recognizer->Recognize(scene);
  if (detections.empty()) return;
  const Detection& best = detections.front();
  // Keeps the shape of the user box at any rotation: a box around the rotated outline would be too large.
  const Box around = BoundingBox(best.outline);
  const double scale = best.pose.scene_from_template.scale;
  const double width = drawn.box.width * scale;
  const double height = drawn.box.height * scale;
  const Box box{around.x + (around.width - width) / 2, around.y + (around.height - height) / 2, width, height};
  const BoxStep step =
      tracker_.Resume(target, box, best.pose.scene_from_template.rotation_rad, BoxTracker::Evidence::kLook);
  Take(step, frame, video, guide, &best, sightings);
}

}  // namespace victorious
