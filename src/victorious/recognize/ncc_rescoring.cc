#include "victorious/recognize/ncc_rescoring.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/image/impulse_noise.h"

namespace victorious {

void NccOptions::ListFields(FieldList& fields) {
  fields.Add(
      "max_poses", max_poses,
      {.min = 0, .max = 1000, .reason = "maximum number of rescored poses per model and frame, best first; 0: none"});
  fields.Add("max_poses_per_frame", max_poses_per_frame,
             {.min = 0,
              .max = 100000,
              .reason = "maximum number of rescored poses per frame, over all models: bounds the time"});
  fields.Add("min_neg_log10_nfa", min_neg_log10_nfa,
             {.min = -100,
              .max = 1000,
              .unit = "decades",
              .reason = "minimum -log10 NFA of a rescored pose: below it hardly any pose is true"});
  fields.Add("max_neg_log10_nfa", max_neg_log10_nfa,
             {.min = -100,
              .max = 1000,
              .unit = "decades",
              .reason = "maximum -log10 NFA of a rescored pose: above it a pose is certain, also if partly occluded"});
  fields.Add("null_samples", null_samples,
             {.min = 10, .max = 10000, .reason = "number of random poses for the null distribution of the NCC score"});
  fields.Add("decades_per_z_score", decades_per_z_score,
             {.min = 0,
              .max = 100,
              .unit = "decades",
              .reason = "increase of -log10 NFA per unit of the NCC z-score; fitted by logistic regression"});
  fields.Add("neutral_z_score", neutral_z_score,
             {.min = -100, .max = 100, .reason = "NCC z-score that leaves the -log10 NFA unchanged; fitted"});
  fields.Add(
      "impulse_fraction", impulse_fraction,
      {.min = 0,
       .max = 1,
       .reason =
           "salt-and-pepper noise is removed above this fraction of impulses in a frame's flat regions; 1: never"});
}

namespace {

// A pose hypothesis in weak perspective, relative to the camera of a view.
struct PoseHypothesis {
  double x = 0;          // projection of the samples' centroid into the scene, px
  double y = 0;          // px
  double log_scale = 0;  // ln of scene pixels per metre
  double turn_rad = 0;   // in-plane rotation
  double yaw_rad = 0;    // rotation of the object about its up axis
  double tip_rad = 0;    // rotation of the camera about the image's x axis
};

using PoseParameter = double PoseHypothesis::*;

// Minimum fraction of the surface samples inside the frame.
constexpr double kMinSampleFraction = 0.4;

class NccEvaluator {
 public:
  // @param least  minimum number of samples in the frame
  NccEvaluator(const cv::Mat& scene, const ViewAppearance& picture, double least)
      : scene_(scene), appearance_(picture), min_samples_(least) {}

  // The samples that project into the frame.
  [[nodiscard]] std::vector<SurfaceSample> SamplesInFrame(const PoseHypothesis& hypothesis) const {
    const Eigen::Matrix<float, 2, 3> project = Projection(hypothesis);
    const Eigen::Vector2f middle = Centre(hypothesis);
    std::vector<SurfaceSample> samples_in_frame;
    for (const SurfaceSample& point : appearance_.points) {
      if (IsInFrame(project * point.place + middle)) samples_in_frame.push_back(point);
    }
    return samples_in_frame;
  }

  // atanh of the correlation; std::nullopt if too few samples are in the frame.
  [[nodiscard]] std::optional<double> ScoreAt(const PoseHypothesis& hypothesis) const {
    constexpr double kVarianceFloor = 4;  // grey levels squared, added to both variances as regularisation
    const Eigen::Matrix<float, 2, 3> project = Projection(hypothesis);
    const Eigen::Vector2f middle = Centre(hypothesis);
    double n = 0;
    double sum_a = 0;
    double sum_b = 0;
    double sum_aa = 0;
    double sum_bb = 0;
    double sum_ab = 0;
    for (const SurfaceSample& point : appearance_.points) {
      const Eigen::Vector2f at = project * point.place + middle;
      if (!IsInFrame(at)) continue;
      const double a = point.brightness;
      const double b = scene_.at<float>(static_cast<int>(at.y()), static_cast<int>(at.x()));
      n += 1;
      sum_a += a;
      sum_b += b;
      sum_aa += a * a;
      sum_bb += b * b;
      sum_ab += a * b;
    }
    if (n < min_samples_) return std::nullopt;
    const double variance_a = sum_aa / n - sum_a * sum_a / (n * n) + kVarianceFloor;
    const double variance_b = sum_bb / n - sum_b * sum_b / (n * n) + kVarianceFloor;
    const double r = (sum_ab / n - sum_a * sum_b / (n * n)) / std::sqrt(variance_a * variance_b);
    return std::atanh(std::clamp(r, -0.99, 0.99));
  }

  // The maximum NCC score by hill climbing from a hypothesis, with step sizes halved twice.
  [[nodiscard]] std::optional<double> MaximiseScore(PoseHypothesis hypothesis) const {
    std::optional<double> best = ScoreAt(hypothesis);
    if (!best) return std::nullopt;
    std::array<Step, 6> steps = {Step{&PoseHypothesis::x, 4},
                                 Step{&PoseHypothesis::y, 4},
                                 Step{&PoseHypothesis::log_scale, 0.06},
                                 Step{&PoseHypothesis::turn_rad, 0.05},
                                 Step{&PoseHypothesis::yaw_rad, 0.08},
                                 Step{&PoseHypothesis::tip_rad, 0.05}};
    constexpr int kHalvings = 3;
    constexpr int kRounds = 3;
    for (int halving = 0; halving < kHalvings; ++halving) {
      for (int round = 0; round < kRounds && TryImprovingSteps(steps, hypothesis, *best); ++round) {
      }
      for (Step& step : steps) step.size /= 2;
    }
    return best;
  }

 private:
  [[nodiscard]] Eigen::Matrix<float, 2, 3> Projection(const PoseHypothesis& hypothesis) const {
    const Eigen::Matrix3d turned =
        (Eigen::AngleAxisd(hypothesis.turn_rad, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(hypothesis.tip_rad, Eigen::Vector3d::UnitX()) * appearance_.camera_from_model *
         Eigen::AngleAxisd(hypothesis.yaw_rad, Eigen::Vector3d::UnitZ()))
            .toRotationMatrix();
    return (std::exp(hypothesis.log_scale) * turned.topRows<2>()).cast<float>();
  }
  static Eigen::Vector2f Centre(const PoseHypothesis& hypothesis) {
    return {static_cast<float>(hypothesis.x), static_cast<float>(hypothesis.y)};
  }
  [[nodiscard]] bool IsInFrame(const Eigen::Vector2f& at) const {
    return at.x() >= 0 && at.y() >= 0 && at.x() < static_cast<float>(scene_.cols) &&
           at.y() < static_cast<float>(scene_.rows);
  }

  struct Step {
    PoseParameter parameter;
    double size;
  };

  // Tries each step in both directions and accepts improvements; false if there is none.
  bool TryImprovingSteps(const std::array<Step, 6>& steps, PoseHypothesis& hypothesis, double& best) const {
    bool any = false;
    for (const Step& step : steps) {
      for (const double sign : {-1.0, 1.0}) {
        PoseHypothesis next = hypothesis;
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
};

// The surface samples of a view, and its in-plane rotation relative to the matched view.
struct NeighbourAppearance {
  std::shared_ptr<const ViewAppearance> picture;
  Eigen::Vector2d centre_px;  // centre of the view's image: projection of the bounding sphere's centre
  double turn_rad;            // in-plane rotation of the object from the matched view to this view
  double least;               // minimum number of samples inside the frame
};

std::vector<NeighbourAppearance> AppearancesOfNeighbours(const ObjectModel& model, const RelitTemplateSource& pictures,
                                                         std::size_t view, int half_octaves) {
  const ModelView& matched = model.views[view];
  std::vector<std::size_t> numbers = {view};
  for (const std::uint32_t neighbour : matched.neighbours) {
    constexpr double kSameRing_rad = 0.01;
    const ModelView& other = model.views[neighbour];
    if (!matched.angles || !other.angles) continue;
    if (std::abs(other.angles->off_nadir_rad - matched.angles->off_nadir_rad) < kSameRing_rad) {
      numbers.push_back(neighbour);
    }
  }
  std::vector<NeighbourAppearance> all;
  for (const std::size_t number : numbers) {
    std::shared_ptr<const ViewAppearance> picture = pictures.GetAppearance(number, half_octaves);
    if (picture->points.empty()) {
      if (all.empty()) return {};  // the matched view itself has no surface
      continue;
    }
    double turn_rad = 0;
    if (!all.empty()) {
      const Eigen::Quaterniond turn = picture->camera_from_model * all.front().picture->camera_from_model.conjugate();
      turn_rad = WrapAngle(2 * std::atan2(turn.z(), turn.w()));
    }
    const double least = kMinSampleFraction * static_cast<double>(picture->points.size());
    all.push_back(
        {std::move(picture), {model.views[number].width / 2.0, model.views[number].height / 2.0}, turn_rad, least});
  }
  return all;
}

// The position of the matched view in the scene.
struct ViewPlacement {
  Eigen::Vector2d centre_px;  // of the view's image centre, in the scene
  double scale;
  double turn_rad;
};

PoseHypothesis HypothesisAt(const ViewPlacement& place, const NeighbourAppearance& beside) {
  const Similarity2 about_centre{place.scale, place.turn_rad - beside.turn_rad, place.centre_px};
  const Eigen::Vector2d middle = about_centre.Apply(beside.picture->centre_px - beside.centre_px);
  return {.x = middle.x(),
          .y = middle.y(),
          .log_scale = std::log(place.scale * beside.picture->pixels_per_m),
          .turn_rad = about_centre.rotation_rad};
}

// Drops the samples outside the frame at the tested pose, for all poses: few samples correlate by chance more easily
// than many, so the null distribution must use the same samples.
void KeepSamplesInFrame(const cv::Mat& scene, const ViewPlacement& place, std::vector<NeighbourAppearance>& pictures) {
  for (NeighbourAppearance& beside : pictures) {
    auto samples_in_frame =
        NccEvaluator(scene, *beside.picture, beside.least).SamplesInFrame(HypothesisAt(place, beside));
    if (samples_in_frame.size() == beside.picture->points.size()) continue;
    auto rest = std::make_shared<ViewAppearance>(*beside.picture);
    rest->points = std::move(samples_in_frame);
    beside.picture = std::move(rest);
  }
}

std::optional<double> MaxNccScore(const cv::Mat& scene, const std::vector<NeighbourAppearance>& pictures,
                                  const ViewPlacement& place) {
  std::optional<double> most;
  for (const NeighbourAppearance& beside : pictures) {
    const std::optional<double> found =
        NccEvaluator(scene, *beside.picture, beside.least).MaximiseScore(HypothesisAt(place, beside));
    if (found && (!most || *found > *most)) most = found;
  }
  return most;
}

// Mean distance of the samples from their centroid, in scene px.
double MeanRadiusPx(const ViewAppearance& picture, double scale) {
  double sum_m = 0;
  for (const SurfaceSample& point : picture.points) sum_m += point.place.norm();
  return scale * picture.pixels_per_m * sum_m / static_cast<double>(picture.points.size());
}

}  // namespace

cv::Mat PrepareSceneForNcc(const cv::Mat& grey, const NccOptions& options) {
  cv::Mat scene;
  const cv::Mat clean = options.impulse_fraction < 1 ? RemoveImpulses(grey, options.impulse_fraction) : grey;
  clean.convertTo(scene, CV_32F);
  cv::GaussianBlur(scene, scene, {}, kAppearanceBlur_px);
  return scene;
}

std::optional<double> ComputeNccZScore(const cv::Mat& scene, const ObjectModel& model,
                                       const RelitTemplateSource& pictures, std::size_t view,
                                       const Similarity2& scene_from_template, const NccOptions& options) {
  constexpr double kMaxHalfOctaves = 8;
  const double half_octaves =
      std::clamp(std::round(-2 * std::log2(scene_from_template.scale)), -kMaxHalfOctaves, kMaxHalfOctaves);
  std::vector<NeighbourAppearance> beside =
      AppearancesOfNeighbours(model, pictures, view, static_cast<int>(half_octaves));
  if (beside.empty()) return std::nullopt;
  const ViewPlacement hypothesis{
      .centre_px = scene_from_template.Apply(Eigen::Vector2d(model.views[view].width, model.views[view].height) / 2),
      .scale = scene_from_template.scale,
      .turn_rad = scene_from_template.rotation_rad};
  const double min_distance_px = MeanRadiusPx(*beside.front().picture, hypothesis.scale);
  KeepSamplesInFrame(scene, hypothesis, beside);
  const std::optional<double> score = MaxNccScore(scene, beside, hypothesis);
  if (!score) return std::nullopt;

  Random random(1);
  std::vector<double> elsewhere;
  for (int tries = 0; std::ssize(elsewhere) < options.null_samples && tries < 4 * options.null_samples; ++tries) {
    ViewPlacement other = hypothesis;
    other.centre_px.x() = random.Uniform(0, scene.cols);
    other.centre_px.y() = random.Uniform(0, scene.rows);
    other.turn_rad = random.Uniform(-kPi, kPi);
    if ((other.centre_px - hypothesis.centre_px).norm() < min_distance_px) continue;
    if (const std::optional<double> found = MaxNccScore(scene, beside, other)) elsewhere.push_back(*found);
  }
  if (std::ssize(elsewhere) < options.null_samples / 2) return std::nullopt;
  const auto n = static_cast<double>(elsewhere.size());
  double sum = 0;
  double sum2 = 0;
  for (const double one : elsewhere) {
    sum += one;
    sum2 += one * one;
  }
  constexpr double kMinDeviation = 0.02;
  const double deviation = std::sqrt(std::max(0.0, sum2 / n - sum * sum / (n * n)));
  return (*score - sum / n) / std::max(kMinDeviation, deviation);
}

}  // namespace victorious
