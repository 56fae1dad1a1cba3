#include "victorious/search/recognize/shape_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"
#include "victorious/base/stage_time.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/homography.h"
#include "victorious/geometry/similarity.h"
#include "victorious/search/detect/detect.h"
#include "victorious/search/recognize/contour_track.h"
#include "victorious/search/recognize/model_shape_search.h"
#include "victorious/search/recognize/shape_templates.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kMaxPlaces = 8;  // of a model in a frame that are searched with fine templates
constexpr double kMinExamined = 6;     // response of fine templates: with less, evidence is not worth its cost
constexpr double kMinInFrame = 0.9;    // of a match that nothing was known of: lines that the border cuts look closed
constexpr double kSuppression = 0.4;   // distance of two matches over the smaller one's size

}  // namespace

std::vector<GradientCells> BackgroundCells(const cv::Mat& grey) {
  std::vector<GradientCells> cells;
  for (const double scale : {0.35, 0.5, 0.7, 1.0}) {
    cv::Mat scaled;
    cv::resize(grey, scaled, {}, scale, scale, cv::INTER_AREA);
    cells.push_back(MakeGradientCells(scaled));
  }
  return cells;
}

ShapeSearch::ShapeSearch(std::span<const ObjectModel> models,
                         std::span<const std::shared_ptr<const RelitTemplateSource>> surfaces,
                         std::span<const GradientCells> background)
    : models_(models), templates_(std::make_unique<Templates>(models, surfaces, background)) {}

ShapeSearch::~ShapeSearch() = default;

namespace {

void ParallelFor(std::size_t count, const std::function<void(std::size_t)>& work) {
  oneapi::tbb::this_task_arena::isolate([&] {  // else a waiting thread could start on another frame
    oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      const StageScope scope(Stage::kShape);
      work(i);
    });
  });
}

// The best places of each model over all parts of the frame. Error: the first one.
Expected<std::vector<Place>> BestOfEachModel(std::vector<Expected<std::vector<Place>>>& found, std::size_t parts) {
  std::vector<Place> best;
  for (std::size_t first = 0; first < found.size(); first += parts) {
    std::vector<Place> of_model;
    for (std::size_t i = first; i < first + parts; ++i) {
      if (!found[i]) return std::unexpected(std::move(found[i]).error());
      of_model.insert(of_model.end(), found[i]->begin(), found[i]->end());
    }
    std::ranges::stable_sort(of_model, std::greater{}, &Place::response);
    std::vector<Place> apart;
    for (const Place& place : of_model) {
      if (apart.size() == kMaxPlaces) break;
      const auto is_near = [&](const Place& other) {
        return (other.at_px - place.at_px).norm() < kSuppression / 2 * place.size_px;
      };
      if (std::ranges::none_of(apart, is_near)) apart.push_back(place);
    }
    best.insert(best.end(), apart.begin(), apart.end());
  }
  return best;
}

double NegLog10NfaOfResponse(const ShapeMatch& match) {
  const double of_paint =
      match.paint == TemplatePaint::kPlain ? kResponseOfOneFalseAlarmPlain : kResponseOfOneFalseAlarm;
  return kDecadesPerResponse * (match.response - of_paint);
}

}  // namespace

const FrameConditions* ShapeSearch::CameraOf(const FrameConditions& conditions) const {
  if (conditions.vertical && conditions.height_above_ground_m) return &conditions;
  return assumed_ ? &*assumed_ : nullptr;
}

ModelShapeSearch ShapeSearch::SearchFor(std::size_t model) const { return {model, models_[model], *templates_}; }

// The best places of each model, searched again with fine templates; of several matches in one place the most
// significant one, or one of each model where the camera is known.
// @param parts            results a model in `found`
// @param decades_assumed  what is lost by assuming the view or the camera; 0: it is known
Expected<std::vector<ShapeMatch>> ShapeSearch::RefineBest(const FramePyramid& frame, const FrameConditions& conditions,
                                                          std::vector<Expected<std::vector<Place>>>& found,
                                                          std::size_t parts, double decades_assumed,
                                                          double min_neg_log10_nfa) const {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Place> places, BestOfEachModel(found, parts));
  std::vector<Expected<std::optional<ShapeMatch>>> refined(places.size());
  ParallelFor(places.size(), [&](std::size_t i) {
    refined[i] = SearchFor(places[i].model).Refine(frame, conditions, places[i]);
    if (!refined[i] || !*refined[i]) return;
    refined[i] = Judge(frame, conditions, **refined[i], decades_assumed, min_neg_log10_nfa);
  });
  std::vector<ShapeMatch> all;
  for (Expected<std::optional<ShapeMatch>>& one : refined) {
    if (!one) return std::unexpected(std::move(one).error());
    if (*one) all.push_back(**one);
  }
  std::vector<ShapeMatch> kept = KeepApart(std::move(all), decades_assumed > 0);
  std::erase_if(kept, [&](const ShapeMatch& match) {
    return match.neg_log10_nfa < min_neg_log10_nfa || match.in_frame < kMinInFrame;
  });
  return kept;
}

// A match with its significance: by all that speaks for it, or where the camera is assumed, by its response alone,
// because sizes are known to some per cent then. std::nullopt if it promises nothing. Below `min_neg_log10_nfa` it may
// be less exact.
Expected<std::optional<ShapeMatch>> ShapeSearch::Judge(const FramePyramid& frame, const FrameConditions& conditions,
                                                       ShapeMatch match, double decades_assumed,
                                                       double min_neg_log10_nfa) const {
  match.neg_log10_nfa = NegLog10NfaOfResponse(match) - decades_assumed;
  if (decades_assumed > 0) return std::optional(match);
  if (match.response < kMinExamined) return std::optional<ShapeMatch>();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<ShapeMatch> examined,
                              SearchFor(match.model_index).Examine(frame, conditions, match, min_neg_log10_nfa));
  return examined.value_or(match);
}

// By falling significance; of several matches in one place the first one, or where models may share places, the first
// one of each.
std::vector<ShapeMatch> ShapeSearch::KeepApart(std::vector<ShapeMatch> all, bool is_place_of_one) const {
  std::ranges::stable_sort(all, std::greater{}, &ShapeMatch::neg_log10_nfa);
  std::vector<ShapeMatch> kept;
  for (const ShapeMatch& match : all) {
    const double size_px = templates_->diagonal_m(match.model_index) * match.pixels_per_m;
    const bool is_explained = std::ranges::any_of(kept, [&](const ShapeMatch& better) {
      const double other_px = templates_->diagonal_m(better.model_index) * better.pixels_per_m;
      if (!is_place_of_one && better.model_index != match.model_index) return false;
      return (better.centre_px - match.centre_px).norm() < kSuppression * std::min(size_px, other_px);
    });
    if (!is_explained) kept.push_back(match);
  }
  return kept;
}

Expected<std::vector<ShapeMatch>> ShapeSearch::Find(const cv::Mat& grey, const FrameConditions& given,
                                                    double min_neg_log10_nfa) const {
  VICTORIOUS_CHECK(grey.type() == CV_8UC1);
  const FrameConditions* conditions = CameraOf(given);
  if (conditions == nullptr) return FindContours(grey, min_neg_log10_nfa);
  const FramePyramid frame(grey);
  const std::vector<FrameTile> tiles = DivideFrame(*conditions->vertical, grey.size());
  std::vector<Expected<std::vector<Place>>> found(models_.size() * tiles.size());
  ParallelFor(found.size(), [&](std::size_t i) {
    const std::size_t m = i / tiles.size();
    if (templates_->surfaces(m) != nullptr)
      found[i] = SearchFor(m).FindPlaces(frame, *conditions, tiles[i % tiles.size()]);
  });
  if (conditions == &given) return RefineBest(frame, given, found, tiles.size(), 0, min_neg_log10_nfa);
  for (Expected<std::vector<Place>>& places : found) {
    if (places) std::erase_if(*places, [](const Place& place) { return place.size_px < kSmallestAssumed_px; });
  }
  return RefineBest(frame, *conditions, found, tiles.size(), kDecadesOfAssumedCamera, min_neg_log10_nfa);
}

Expected<std::vector<ShapeMatch>> ShapeSearch::FindInAnyView(const cv::Mat& grey, double min_neg_log10_nfa) const {
  VICTORIOUS_CHECK(grey.type() == CV_8UC1);
  const FramePyramid frame(grey);
  const FrameTile whole{cv::Rect({0, 0}, grey.size())};
  const std::vector<double> sizes_px = AssumedSizes(grey.size());
  if (sizes_px.empty()) return std::vector<ShapeMatch>{};
  std::vector<PreparedPart> prepared(sizes_px.size());
  ParallelFor(prepared.size(), [&](std::size_t i) {
    prepared[i] = PreparePart(frame, whole, sizes_px[i], 0, templates_->mean());
    prepared[i].cells = FilmedCells(prepared[i].part, grey.size(), templates_->mean());
  });
  constexpr std::size_t kAngles = kAssumedOffNadirs_deg.size();
  const std::size_t views = sizes_px.size() * kAngles;
  std::vector<Expected<std::vector<Place>>> found(models_.size() * views);
  ParallelFor(found.size(), [&](std::size_t i) {
    const std::size_t m = i / views;
    const std::size_t size = i % views / kAngles;
    if (templates_->surfaces(m) == nullptr) return;
    const LocalView view{.off_nadir_rad = RadiansFromDegrees(kAssumedOffNadirs_deg[i % kAngles]),
                         .pixels_per_m = sizes_px[size] / templates_->diagonal_m(m)};
    found[i] = SearchFor(m).FindAssumedPlaces(prepared[size], whole, view);
  });
  return RefineBest(frame, {}, found, views, std::log10(static_cast<double>(views)), min_neg_log10_nfa);
}

ShapeMatch ShapeMatchOf(const ContourMatch& match, std::size_t model_index, const cv::Size& frame) {
  const ContourPose& pose = match.pose;
  const Vector3d& centre = pose.centre_in_camera_m;
  // Seen along the line of sight, as in the middle of a frame.
  const Eigen::Matrix3d turned =
      Eigen::Quaterniond::FromTwoVectors(centre, Vector3d::UnitZ()).toRotationMatrix() * pose.camera_from_model;
  ShapeMatch found{.model_index = model_index, .to_camera = DirectionFromVector(-turned.row(2).transpose())};
  const Eigen::Matrix3d roll = turned * CameraFromModel(found.to_camera).toRotationMatrix().transpose();
  found.centre_px = pose.focal_px * centre.head<2>() / centre.z() + Vector2d(frame.width / 2.0, frame.height / 2.0);
  found.pixels_per_m = pose.focal_px / centre.z();
  found.lean_rad = std::atan2(roll(1, 0), roll(0, 0));
  found.response = match.evidence.decades;
  found.neg_log10_nfa = match.neg_log10_nfa;
  return found;
}

std::vector<ShapeMatch> ShapeSearch::FindContours(const cv::Mat& grey, double min_neg_log10_nfa) const {
  std::vector<ShapeMatch> all;
  for (const auto& [number, contours] : contours_) {
    std::optional<ContourMatch> match = FindByContours(contours, grey);
    if (!match) continue;
    match->neg_log10_nfa += decades_of_other_frames_;
    if (match->neg_log10_nfa >= min_neg_log10_nfa) all.push_back(ShapeMatchOf(*match, number, grey.size()));
  }
  return KeepApart(std::move(all), true);
}

Expected<bool> ShapeSearch::SearchByContours(std::span<const cv::Mat> frames, const CancelToken& cancel) {
  contours_.clear();
  if (frames.empty()) return false;
  const bool has_others = frames.size() > 1;
  decades_of_other_frames_ = has_others ? kDecadesOfOtherFrames : 0;
  const double needed = has_others ? kDecadesToSearchByContours : 0;
  const std::size_t needed_frames = std::min(kFramesToSearchByContours, frames.size());
  for (std::size_t m = 0; m < models_.size(); ++m) {
    if (templates_->surfaces(m) == nullptr) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(ContourModel contours, ReadContourModel(models_[m], *templates_->surfaces(m)));
    double decades = 0;
    std::size_t found = 0;
    const auto is_decided = [&] { return decades >= needed && found >= needed_frames; };
    for (std::size_t i = 0; i < frames.size() && !is_decided() && found + frames.size() - i >= needed_frames; ++i) {
      if (cancel.IsCancelled()) return Fail(ErrorCode::kCancelled, "cancelled");
      const std::optional<ContourMatch> match = FindByContours(contours, frames[i]);
      if (!match) continue;
      decades += match->neg_log10_nfa;
      ++found;
    }
    if (is_decided()) contours_.emplace_back(m, std::move(contours));
  }
  return !contours_.empty();
}

namespace {

// The pose of a detection, moved in the frame; to some per cent, because the focal length is assumed.
ContourPose PoseOf(const Detection& detection, const ObjectModel& model, const RenderedSurface& rendered,
                   const Vector2d& shift_px, const cv::Size& frame) {
  const Similarity2& map = detection.fit.scene_from_template;
  const Vector2d at_px = map.Apply(rendered.centre_px) + shift_px - Vector2d(frame.width / 2.0, frame.height / 2.0);
  const double focal_px = AssumedFocalPx(frame);
  const Vector3d ray(at_px.x() / focal_px, at_px.y() / focal_px, 1);
  const double distance_m = focal_px / (map.scale * rendered.pixels_per_m);
  const Eigen::Matrix3d turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), ray).toRotationMatrix() *
                               Eigen::AngleAxisd(map.rotation_rad, Vector3d::UnitZ()).toRotationMatrix();
  return {turn * CameraFromModel(*model.views[detection.view].angles).toRotationMatrix(), distance_m * ray, focal_px};
}

}  // namespace

Expected<std::optional<ShapeMatch>> ShapeSearch::FindAgain(const cv::Mat& grey, const FrameConditions& given,
                                                           const Detection& last, const Vector2d& shift_px) const {
  const std::size_t m = last.model_index;
  const FrameConditions* conditions = CameraOf(given);
  if (templates_->surfaces(m) == nullptr) return std::optional<ShapeMatch>();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const RenderedSurface> rendered,
                              templates_->GetSurface(m, last.view));
  if (conditions == nullptr) {
    const auto contours = std::ranges::find(contours_, m, &std::pair<std::size_t, ContourModel>::first);
    if (contours == contours_.end()) return std::optional<ShapeMatch>();
    const ContourPose start = PoseOf(last, models_[m], *rendered, shift_px, grey.size());
    std::optional<ContourMatch> again = FindContoursNear(contours->second, grey, start);
    if (!again) return std::optional<ShapeMatch>();
    again->neg_log10_nfa += decades_of_other_frames_;
    return ShapeMatchOf(*again, m, grey.size());
  }
  const double azimuth_deg = DegreesFromRadians(models_[m].views[last.view].angles->azimuth_rad);
  const Place place{
      .model = m,
      .at_px = last.fit.scene_from_template.Apply(rendered->centre_px) + shift_px,
      .azimuth_deg = static_cast<int>(std::lround(azimuth_deg / kFineHeadingStep_deg)) * kFineHeadingStep_deg,
      .assumed = {}};
  const FramePyramid pyramid(grey);
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<ShapeMatch> match,
                              SearchFor(m).Match(pyramid, *conditions, place, kFineHeadings));
  if (!match) return match;
  VICTORIOUS_ASSIGN_OR_RETURN(match,
                              Judge(pyramid, *conditions, *match, conditions == &given ? 0 : kDecadesOfAssumedCamera,
                                    kMinDecadesInOnePlace - kDecadesOfOnePlace));
  if (!match) return match;
  match->neg_log10_nfa += kDecadesOfOnePlace;
  if (match->neg_log10_nfa < (match->is_examined ? kMinDecadesInOnePlace : kMinDecadesUnexamined)) match.reset();
  return match;
}

Expected<Detection> ShapeSearch::MakeDetection(const ShapeMatch& match, FeatureSet& features) const {
  const ObjectModel& model = models_[match.model_index];
  const std::size_t view = templates_->NearestView(match.model_index, match.to_camera);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const RenderedSurface> rendered,
                              templates_->GetSurface(match.model_index, view));
  const Eigen::Matrix3d camera_from_model = CameraFromModel(match.to_camera).toRotationMatrix();
  const Eigen::Matrix3d camera_from_view =
      camera_from_model * CameraFromModel(*model.views[view].angles).toRotationMatrix().transpose();
  Similarity2 scene_from_view{
      .scale = match.pixels_per_m / rendered->pixels_per_m,
      .rotation_rad = WrapAngle(match.lean_rad + std::atan2(camera_from_view(1, 0), camera_from_view(0, 0)))};
  scene_from_view.translation = match.centre_px - scene_from_view.Linear() * rendered->centre_px;

  Detection detection{.model_index = match.model_index, .view = view, .cue = DetectionCue::kShape};
  detection.neg_log10_nfa = match.neg_log10_nfa;
  PlanarFit& fit = detection.fit;
  fit.scene_from_template = scene_from_view;
  fit.scene_from_template_plane = scene_from_view.Matrix();
  fit.extent = 1;
  fit.neg_log10_nfa = match.neg_log10_nfa;
  fit.sigma_px = 1;
  const Similarity2 turned{.scale = match.pixels_per_m, .rotation_rad = match.lean_rad};
  const FeatureView keypoints = model.ViewFeatures(view);
  const std::span<const Point3> points = model.ViewPoints(view);
  const Box frame = FrameBox(features.image_width, features.image_height);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d from_centre =
        Eigen::Vector3d(points[i].x, points[i].y, points[i].z) - rendered->centre_in_model_m;
    const Eigen::Vector3d in_camera = camera_from_model * from_centre;
    const Vector2d at_px = match.centre_px + turned.Apply(in_camera.head<2>());
    if (at_px.x() < frame.x || at_px.y() < frame.y || at_px.x() >= frame.x + frame.width ||
        at_px.y() >= frame.y + frame.height) {
      continue;
    }
    Keypoint keypoint = keypoints.keypoints[i];
    fit.inliers.push_back({.scene_keypoint = static_cast<std::uint32_t>(features.size()),
                           .keypoint_in_template = keypoint,
                           .point_in_model = points[i]});
    keypoint.x = static_cast<float>(at_px.x());
    keypoint.y = static_cast<float>(at_px.y());
    keypoint.scale_px *= static_cast<float>(scene_from_view.scale);
    features.keypoints.push_back(keypoint);
    features.descriptors.resize(features.descriptors.size() + kDescriptorSize);
  }
  fit.distinct_inliers = fit.inliers.size();
  detection.outline = ProjectPolygon(fit.scene_from_template_plane, model.views[view].outline);
  detection.box = BoundingBox(ClipToBox(detection.outline, frame));
  detection.score = ComputeScore(detection.neg_log10_nfa);
  return detection;
}

}  // namespace victorious
