#include "victorious/jobs/index/view_chain.h"

#include <algorithm>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "victorious/jobs/known_views.h"
#include "victorious/object/model/model_builder.h"

namespace victorious {
namespace {

constexpr std::size_t kRecentViews = 8;  // learnt views that are searched for, beside the photos
constexpr double kMinProbability = 0.5;  // of a view that is learnt

FeatureSet FeaturesOn(const FeatureSet& features, const Polygon& outline) {
  FeatureSet inside{.keypoints = {},
                    .descriptors = {},
                    .image_width = features.image_width,
                    .image_height = features.image_height,
                    .part = {}};
  std::vector<cv::Point2f> corners;
  for (const Eigen::Vector2d& corner : outline)
    corners.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Keypoint& keypoint = features.keypoints[i];
    if (cv::pointPolygonTest(corners, {keypoint.x, keypoint.y}, false) >= 0)
      AppendFeature(keypoint, features, i, inside);
  }
  return inside;
}

ModelView ViewOf(const LearntView& view, const FeatureSet& features) {
  return {.source = {},
          .width = features.image_width,
          .height = features.image_height,
          .outline = view.outline,
          .angles = {},
          .neighbours = {},
          .thumbnail = {},
          .surface = {}};
}

// A model of these views alone, which stands for `model`.
ObjectModel FinishAs(const ObjectModel& model, ModelBuilder views) {
  ObjectModel other = model;
  other.id = {};
  return std::move(views).Finish(std::move(other));
}

}  // namespace

Expected<std::optional<ViewChain::Found>> ViewChain::Find(const FeatureSet& region, const Box& box) {
  if (region.keypoints.empty()) return std::nullopt;
  VICTORIOUS_RETURN_IF_ERROR(Prepare());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Detection> detections, recognizer_->Recognize(region));
  const Detection* const found = DetectionAt(detections, box);
  if (found == nullptr) return std::nullopt;
  const std::size_t photos = model_->views.size();
  return Found{.matches = static_cast<int>(found->fit.inliers.size()),
               .view = found->view < photos ? std::nullopt : std::optional(first_ + found->view - photos),
               .score = found->score};
}

Expected<double> ViewChain::ScoreIn(const FeatureSet& witness, const Box& witness_box, const LearntView& view,
                                    const FeatureSet& region) const {
  const FeatureSet features = FeaturesOn(region, view.outline);
  if (features.size() < kMinViewFeatures) return 0;
  ModelBuilder alone;
  alone.AddWithoutThumbnail(ViewOf(view, features), features.View());
  VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer,
                              Recognizer::Create({FinishAs(*model_, std::move(alone))}, model_->engine, *options_));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Detection> detections, recognizer.Recognize(witness));
  const bool is_there =
      !detections.empty() && IntersectionOverUnion(detections.front().box, witness_box) >= kMinViewOverlap;
  return is_there ? detections.front().score : 0;
}

bool ViewChain::Learn(const LearntView& view, const FeatureSet& region) {
  FeatureSet features = FeaturesOn(region, view.outline);
  if (features.size() < kMinViewFeatures || views_.size() >= kMaxLearntViews) return false;
  if (view.probability < kMinProbability) return false;
  views_.push_back(view);
  features_.push_back(std::move(features));
  Rest();
  return true;
}

void ViewChain::Forget(std::size_t count) {
  if (count >= views_.size()) return;
  views_.resize(count);
  features_.resize(count);
  Rest();
}

Status ViewChain::Prepare() {
  if (recognizer_) return {};
  ModelBuilder all;
  for (std::size_t view = 0; view < model_->views.size(); ++view)
    all.AddWithoutThumbnail(model_->views[view], model_->ViewFeatures(view));
  first_ = views_.size() - std::min(views_.size(), kRecentViews);
  for (std::size_t i = first_; i < views_.size(); ++i)
    all.AddWithoutThumbnail(ViewOf(views_[i], features_[i]), features_[i].View());
  VICTORIOUS_ASSIGN_OR_RETURN(Recognizer made,
                              Recognizer::Create({FinishAs(*model_, std::move(all))}, model_->engine, *options_));
  recognizer_.emplace(std::move(made));
  return {};
}

}  // namespace victorious
