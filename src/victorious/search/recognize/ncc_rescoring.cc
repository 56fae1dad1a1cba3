#include "victorious/search/recognize/ncc_rescoring.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {

namespace {

// A pose hypothesis in weak perspective, relative to the camera of a view.
struct RescoredPose {
  double x = 0;          // projection of the samples' centroid into the scene, px
  double y = 0;          // px
  double log_scale = 0;  // ln of scene pixels per metre
  double turn_rad = 0;   // in-plane rotation
  double yaw_rad = 0;    // rotation of the object about its up axis
  double tip_rad = 0;    // rotation of the camera about the image's x axis
};

using PoseParameter = double RescoredPose::*;

// The constants below are chosen, not fitted; docs/adr/0014 describes the method they belong to.

// Minimum fraction of the surface samples inside the frame: an object that is mostly outside is not rescored.
constexpr double kMinSampleFraction = 0.4;
// Grey levels squared, added to both variances as regularisation: sensor noise alone does not correlate.
constexpr double kVarianceFloor = 4;
// Bound of the correlation before the Fisher transform, which diverges at 1.
constexpr double kMaxCorrelation = 0.99;

// The first steps of the hill climbing: about the error of a pose by votes. With the rounds and halvings below the
// climb reaches 5.25 steps in each parameter, 24 degrees in yaw, and so the views between the rings of views.
constexpr double kPositionStep_px = 4;
constexpr double kLogScaleStep = 0.06;
constexpr double kTurnStep_rad = 0.05;
constexpr double kYawStep_rad = 0.08;
constexpr double kTipStep_rad = 0.05;
constexpr int kStepSizes = 3;      // step sizes tried, each half of the one before
constexpr int kRoundsPerSize = 3;  // maximum number of rounds over all parameters with one step size

// Views whose off-nadir angles differ by less belong to one ring of the view sphere.
constexpr double kSameRing_rad = 0.01;
// Bound of the difference in size between view and scene, for which surface samples are made: a factor of 16.
constexpr double kMaxHalfOctaves = 8;
// Random poses for the null distribution: its standard deviation is known to about 11 %.
constexpr int kNullSamples = 40;
// Random poses tried per null sample that is wanted: a pose at the object, or mostly outside the frame, gives none.
constexpr int kTriesPerNullSample = 4;
// Bound of the null distribution's standard deviation from below, in a frame without texture.
constexpr double kMinNullDeviation = 0.02;

// Weak perspective of hypotheses that differ in few parameters: the rotation by an angle is computed only when it
// changes.
class Projector {
 public:
  explicit Projector(const Eigen::Quaterniond& camera_from_model) : camera_from_model_(camera_from_model) {}

  // From positions relative to the samples' centroid, m, to the scene relative to its projection, px.
  // @param scale  exp(hypothesis.log_scale), px / m
  Eigen::Matrix<float, 2, 3> At(const RescoredPose& hypothesis, double scale) {
    turn_.Set(hypothesis.turn_rad, Eigen::Vector3d::UnitZ());
    tip_.Set(hypothesis.tip_rad, Eigen::Vector3d::UnitX());
    yaw_.Set(hypothesis.yaw_rad, Eigen::Vector3d::UnitZ());
    const Eigen::Matrix3d turned =
        (turn_.rotation * tip_.rotation * camera_from_model_ * yaw_.rotation).toRotationMatrix();
    return (scale * turned.topRows<2>()).cast<float>();
  }

 private:
  struct Turn {
    double angle_rad = 0;
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();

    void Set(double new_angle_rad, const Eigen::Vector3d& axis) {
      if (new_angle_rad == angle_rad) return;
      angle_rad = new_angle_rad;
      rotation = Eigen::AngleAxisd(angle_rad, axis);
    }
  };

  Eigen::Quaterniond camera_from_model_;
  Turn turn_;
  Turn tip_;
  Turn yaw_;
};

// The sums of a correlation between brightness a of the samples and b of the scene.
struct Correlation {
  double n = 0;
  double sum_a = 0;
  double sum_b = 0;
  double sum_aa = 0;
  double sum_bb = 0;
  double sum_ab = 0;

  [[nodiscard]] double Fisher() const {
    const double variance_a = sum_aa / n - sum_a * sum_a / (n * n) + kVarianceFloor;
    const double variance_b = sum_bb / n - sum_b * sum_b / (n * n) + kVarianceFloor;
    const double r = (sum_ab / n - sum_a * sum_b / (n * n)) / std::sqrt(variance_a * variance_b);
    return std::atanh(std::clamp(r, -kMaxCorrelation, kMaxCorrelation));
  }
};

class NccEvaluator {
 public:
  // @param min_samples  minimum number of samples in the frame
  NccEvaluator(const cv::Mat& scene, const ViewAppearance& appearance, double min_samples)
      : scene_(scene), appearance_(appearance), min_samples_(min_samples), projector_(appearance.camera_from_model) {
    float radius2_m2 = 0;
    for (const SurfaceSample& point : appearance.points) {
      all_.n += 1;
      all_.sum_a += point.brightness;
      all_.sum_aa += static_cast<double>(point.brightness) * point.brightness;
      radius2_m2 = std::max(radius2_m2, point.position_m.squaredNorm());
    }
    radius_m_ = std::sqrt(static_cast<double>(radius2_m2));
  }

  // The samples that project into the frame.
  [[nodiscard]] std::vector<SurfaceSample> SamplesInFrame(const RescoredPose& hypothesis) {
    const Eigen::Matrix<float, 2, 3> project = projector_.At(hypothesis, std::exp(hypothesis.log_scale));
    const Eigen::Vector2f middle = Centre(hypothesis);
    std::vector<SurfaceSample> samples_in_frame;
    for (const SurfaceSample& point : appearance_.points) {
      if (IsInFrame(project * point.position_m + middle)) samples_in_frame.push_back(point);
    }
    return samples_in_frame;
  }

  // atanh of the correlation; std::nullopt if too few samples are in the frame.
  [[nodiscard]] std::optional<double> ScoreAt(const RescoredPose& hypothesis) {
    const double scale = std::exp(hypothesis.log_scale);
    const Eigen::Matrix<float, 2, 3> project = projector_.At(hypothesis, scale);
    const Eigen::Vector2f middle = Centre(hypothesis);
    Correlation sums;
    if (AreAllInFrame(hypothesis, scale)) {
      sums = all_;
      for (const SurfaceSample& point : appearance_.points) {
        const double b = SceneAt(project * point.position_m + middle);
        sums.sum_b += b;
        sums.sum_bb += b * b;
        sums.sum_ab += point.brightness * b;
      }
    } else {
      for (const SurfaceSample& point : appearance_.points) {
        const Eigen::Vector2f at = project * point.position_m + middle;
        if (!IsInFrame(at)) continue;
        const double a = point.brightness;
        const double b = SceneAt(at);
        sums.n += 1;
        sums.sum_a += a;
        sums.sum_b += b;
        sums.sum_aa += a * a;
        sums.sum_bb += b * b;
        sums.sum_ab += a * b;
      }
    }
    if (sums.n < min_samples_) return std::nullopt;
    return sums.Fisher();
  }

  // The maximum NCC score by hill climbing from a hypothesis.
  [[nodiscard]] std::optional<double> MaximiseScore(RescoredPose hypothesis) {
    std::optional<double> best = ScoreAt(hypothesis);
    if (!best) return std::nullopt;
    std::array<Step, 6> steps = {
        Step{&RescoredPose::x, kPositionStep_px},      Step{&RescoredPose::y, kPositionStep_px},
        Step{&RescoredPose::log_scale, kLogScaleStep}, Step{&RescoredPose::turn_rad, kTurnStep_rad},
        Step{&RescoredPose::yaw_rad, kYawStep_rad},    Step{&RescoredPose::tip_rad, kTipStep_rad}};
    for (int size = 0; size < kStepSizes; ++size) {
      for (int round = 0; round < kRoundsPerSize && TryImprovingSteps(steps, hypothesis, *best); ++round) {
      }
      for (Step& step : steps) step.size /= 2;
    }
    return best;
  }

 private:
  static Eigen::Vector2f Centre(const RescoredPose& hypothesis) {
    return {static_cast<float>(hypothesis.x), static_cast<float>(hypothesis.y)};
  }
  [[nodiscard]] bool IsInFrame(const Eigen::Vector2f& at) const {
    return at.x() >= 0 && at.y() >= 0 && at.x() < static_cast<float>(scene_.cols) &&
           at.y() < static_cast<float>(scene_.rows);
  }
  // True only if all samples project into the frame: no projection is longer than the position.
  [[nodiscard]] bool AreAllInFrame(const RescoredPose& hypothesis, double scale) const {
    constexpr double kRounding_px = 1;
    const double reach_px = scale * radius_m_ + kRounding_px;
    return hypothesis.x >= reach_px && hypothesis.y >= reach_px && hypothesis.x + reach_px < scene_.cols &&
           hypothesis.y + reach_px < scene_.rows;
  }
  [[nodiscard]] double SceneAt(const Eigen::Vector2f& at) const {
    return scene_.at<float>(static_cast<int>(at.y()), static_cast<int>(at.x()));
  }

  struct Step {
    PoseParameter parameter;
    double size;
  };

  // Tries each step in both directions and accepts improvements; false if there is none.
  bool TryImprovingSteps(const std::array<Step, 6>& steps, RescoredPose& hypothesis, double& best) {
    bool any = false;
    for (const Step& step : steps) {
      for (const double sign : {-1.0, 1.0}) {
        RescoredPose next = hypothesis;
        next.*step.parameter += sign * step.size;
        const std::optional<double> found = ScoreAt(next);
        if (!found || *found <= best) continue;
        best = *found;
        hypothesis = next;
        any = true;
      }
    }
    return any;
  }

  const cv::Mat& scene_;
  const ViewAppearance& appearance_;
  double min_samples_;
  Projector projector_;
  Correlation all_;  // without sum_b, sum_bb and sum_ab
  double radius_m_;  // of the samples around their centroid
};

// The surface samples of a view, and its in-plane rotation relative to the matched view.
struct NeighbourAppearance {
  std::shared_ptr<const ViewAppearance> appearance;
  Eigen::Vector2d centre_px;  // centre of the view's image: projection of the bounding sphere's centre
  double turn_rad;            // in-plane rotation of the object from the matched view to this view
  double min_samples;         // minimum number of samples inside the frame
};

// The matched view first, then its neighbours of the same ring; empty if the matched view has no surface samples.
Expected<std::vector<NeighbourAppearance>> GatherAppearances(const ObjectModel& model,
                                                             const RelitTemplateSource& appearances, std::size_t view,
                                                             int half_octaves) {
  const ModelView& matched = model.views[view];
  std::vector<std::size_t> numbers = {view};
  for (const std::uint32_t neighbour : matched.neighbours) {
    const ModelView& other = model.views[neighbour];
    if (!matched.angles || !other.angles) continue;
    if (std::abs(other.angles->off_nadir_rad - matched.angles->off_nadir_rad) < kSameRing_rad) {
      numbers.push_back(neighbour);
    }
  }
  std::vector<NeighbourAppearance> all;
  for (const std::size_t number : numbers) {
    VICTORIOUS_ASSIGN_OR_RETURN(std::shared_ptr<const ViewAppearance> appearance,
                                appearances.GetAppearance(number, half_octaves));
    if (appearance->points.empty()) {
      if (all.empty()) return all;  // the matched view itself
      continue;
    }
    double turn_rad = 0;
    if (!all.empty()) {
      const Eigen::Quaterniond turn =
          appearance->camera_from_model * all.front().appearance->camera_from_model.conjugate();
      turn_rad = WrapAngle(2 * std::atan2(turn.z(), turn.w()));
    }
    const double min_samples = kMinSampleFraction * static_cast<double>(appearance->points.size());
    all.push_back({std::move(appearance),
                   {model.views[number].width / 2.0, model.views[number].height / 2.0},
                   turn_rad,
                   min_samples});
  }
  return all;
}

// The position of the matched view in the scene.
struct ViewPlacement {
  Eigen::Vector2d centre_px;  // of the view's image centre, in the scene
  double scale;
  double turn_rad;
};

RescoredPose HypothesisAt(const ViewPlacement& place, const NeighbourAppearance& beside) {
  const Similarity2 about_centre{place.scale, place.turn_rad - beside.turn_rad, place.centre_px};
  const Eigen::Vector2d middle = about_centre.Apply(beside.appearance->centre_px - beside.centre_px);
  return {.x = middle.x(),
          .y = middle.y(),
          .log_scale = std::log(place.scale * beside.appearance->pixels_per_m),
          .turn_rad = about_centre.rotation_rad};
}

// Drops the samples outside the frame at the tested pose, for all poses: few samples correlate by chance more easily
// than many, so the null distribution must use the same samples.
void KeepSamplesInFrame(const cv::Mat& scene, const ViewPlacement& place,
                        std::vector<NeighbourAppearance>& appearances) {
  for (NeighbourAppearance& beside : appearances) {
    auto samples_in_frame =
        NccEvaluator(scene, *beside.appearance, beside.min_samples).SamplesInFrame(HypothesisAt(place, beside));
    if (samples_in_frame.size() == beside.appearance->points.size()) continue;
    auto rest = std::make_shared<ViewAppearance>(*beside.appearance);
    rest->points = std::move(samples_in_frame);
    beside.appearance = std::move(rest);
  }
}

// @param evaluators  of the appearances
std::optional<double> MaxNccScore(std::span<NccEvaluator> evaluators, std::span<const NeighbourAppearance> appearances,
                                  const ViewPlacement& place) {
  std::optional<double> highest;
  for (std::size_t i = 0; i < appearances.size(); ++i) {
    const std::optional<double> found = evaluators[i].MaximiseScore(HypothesisAt(place, appearances[i]));
    if (found && (!highest || *found > *highest)) highest = found;
  }
  return highest;
}

// Mean distance of the samples from their centroid, in scene px.
double MeanRadiusPx(const ViewAppearance& appearance, double scale) {
  double sum_m = 0;
  for (const SurfaceSample& point : appearance.points) sum_m += point.position_m.norm();
  return scale * appearance.pixels_per_m * sum_m / static_cast<double>(appearance.points.size());
}

}  // namespace

cv::Mat PrepareSceneForNcc(const cv::Mat& grey) {
  cv::Mat scene;
  grey.convertTo(scene, CV_32F);
  cv::GaussianBlur(scene, scene, {}, kAppearanceBlur_px);
  return scene;
}

Expected<std::optional<double>> ComputeNccZScore(const cv::Mat& scene, const ObjectModel& model,
                                                 const RelitTemplateSource& appearances, std::size_t view,
                                                 const Similarity2& scene_from_template) {
  const double half_octaves =
      std::clamp(std::round(-2 * std::log2(scene_from_template.scale)), -kMaxHalfOctaves, kMaxHalfOctaves);
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<NeighbourAppearance> beside,
                              GatherAppearances(model, appearances, view, static_cast<int>(half_octaves)));
  if (beside.empty()) return std::nullopt;
  const ViewPlacement hypothesis{
      .centre_px = scene_from_template.Apply(Eigen::Vector2d(model.views[view].width, model.views[view].height) / 2),
      .scale = scene_from_template.scale,
      .turn_rad = scene_from_template.rotation_rad};
  const double min_distance_px = MeanRadiusPx(*beside.front().appearance, hypothesis.scale);
  KeepSamplesInFrame(scene, hypothesis, beside);
  std::vector<NccEvaluator> evaluators;
  for (const NeighbourAppearance& one : beside) evaluators.emplace_back(scene, *one.appearance, one.min_samples);
  const std::optional<double> score = MaxNccScore(evaluators, beside, hypothesis);
  if (!score) return std::nullopt;

  Random random(1);
  std::vector<double> elsewhere;
  for (int tries = 0; std::ssize(elsewhere) < kNullSamples && tries < kTriesPerNullSample * kNullSamples; ++tries) {
    ViewPlacement other = hypothesis;
    other.centre_px.x() = random.Uniform(0, scene.cols);
    other.centre_px.y() = random.Uniform(0, scene.rows);
    other.turn_rad = random.Uniform(-kPi, kPi);
    if ((other.centre_px - hypothesis.centre_px).norm() < min_distance_px) continue;
    if (const std::optional<double> found = MaxNccScore(evaluators, beside, other)) elsewhere.push_back(*found);
  }
  if (std::ssize(elsewhere) < kNullSamples / 2) return std::nullopt;
  const auto n = static_cast<double>(elsewhere.size());
  double sum = 0;
  double sum2 = 0;
  for (const double one : elsewhere) {
    sum += one;
    sum2 += one * one;
  }
  const double deviation = std::sqrt(std::max(0.0, sum2 / n - sum * sum / (n * n)));
  return (*score - sum / n) / std::max(kMinNullDeviation, deviation);
}

}  // namespace victorious
