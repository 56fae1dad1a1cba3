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
#include "victorious/image/impulse_noise.h"
#include "victorious/geometry/angles.h"

namespace victorious {

void LikenessOptions::ListFields(FieldList& fields) {
  fields.Add(
      "most", most,
      {.min = 0, .max = 1000, .reason = "maximum number of rescored poses per model and frame, best first; 0: none"});
  fields.Add("most_in_frame", most_in_frame,
             {.min = 0,
              .max = 100000,
              .reason = "maximum number of rescored poses per frame, over all models: bounds the time"});
  fields.Add("least_evidence", least_evidence,
             {.min = -100,
              .max = 1000,
              .unit = "decades",
              .reason = "minimum -log10 NFA of a rescored pose: below it hardly any pose is true"});
  fields.Add("most_evidence", most_evidence,
             {.min = -100,
              .max = 1000,
              .unit = "decades",
              .reason = "maximum -log10 NFA of a rescored pose: above it a pose is certain, also if partly occluded"});
  fields.Add("elsewhere", elsewhere,
             {.min = 10, .max = 10000, .reason = "number of random poses for the null distribution of the NCC score"});
  fields.Add("decades_per_sigma", decades_per_sigma,
             {.min = 0,
              .max = 100,
              .unit = "decades",
              .reason = "increase of -log10 NFA per unit of the NCC z-score; fitted by logistic regression"});
  fields.Add("even_sigmas", even_sigmas,
             {.min = -100, .max = 100, .reason = "NCC z-score that leaves the -log10 NFA unchanged; fitted"});
  fields.Add(
      "impulse_share", impulse_share,
      {.min = 0,
       .max = 1,
       .reason =
           "salt-and-pepper noise is removed above this fraction of impulses in a frame's flat regions; 1: never"});
}

namespace {

// A pose hypothesis in weak perspective, relative to the camera of a view.
struct Guess {
  double x = 0;          // projection of the samples' centroid into the scene, px
  double y = 0;          // px
  double log_scale = 0;  // ln of scene pixels per metre
  double turn_rad = 0;   // in-plane rotation
  double yaw_rad = 0;    // rotation of the object about its up axis
  double tip_rad = 0;    // rotation of the camera about the image's x axis
};

using Field = double Guess::*;

// Minimum fraction of the surface samples inside the frame.
constexpr double kLeastShare = 0.4;

class PictureOnScene {
 public:
  // @param least  minimum number of samples in the frame
  PictureOnScene(const cv::Mat& scene, const ViewPicture& picture, double least)
      : scene_(scene), picture_(picture), least_(least) {}

  // The samples that project into the frame.
  [[nodiscard]] std::vector<PicturePoint> Seen(const Guess& guess) const {
    const Eigen::Matrix<float, 2, 3> project = Projection(guess);
    const Eigen::Vector2f middle = MiddleOf(guess);
    std::vector<PicturePoint> seen;
    for (const PicturePoint& point : picture_.points) {
      if (IsInFrame(project * point.place + middle)) seen.push_back(point);
    }
    return seen;
  }

  // atanh of the correlation; std::nullopt if too few samples are in the frame.
  [[nodiscard]] std::optional<double> At(const Guess& guess) const {
    constexpr double kFaintest = 4;  // grey levels squared, added to both variances as regularisation
    const Eigen::Matrix<float, 2, 3> project = Projection(guess);
    const Eigen::Vector2f middle = MiddleOf(guess);
    double n = 0;
    double sum_a = 0;
    double sum_b = 0;
    double sum_aa = 0;
    double sum_bb = 0;
    double sum_ab = 0;
    for (const PicturePoint& point : picture_.points) {
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
    if (n < least_) return std::nullopt;
    const double variance_a = sum_aa / n - sum_a * sum_a / (n * n) + kFaintest;
    const double variance_b = sum_bb / n - sum_b * sum_b / (n * n) + kFaintest;
    const double r = (sum_ab / n - sum_a * sum_b / (n * n)) / std::sqrt(variance_a * variance_b);
    return std::atanh(std::clamp(r, -0.99, 0.99));
  }

  // The maximum NCC score by hill climbing from a hypothesis, with step sizes halved twice.
  [[nodiscard]] std::optional<double> Climb(Guess guess) const {
    std::optional<double> best = At(guess);
    if (!best) return std::nullopt;
    std::array<Step, 6> steps = {
        Step{&Guess::x, 4},           Step{&Guess::y, 4},          Step{&Guess::log_scale, 0.06},
        Step{&Guess::turn_rad, 0.05}, Step{&Guess::yaw_rad, 0.08}, Step{&Guess::tip_rad, 0.05}};
    constexpr int kHalvings = 3;
    constexpr int kRounds = 3;
    for (int halving = 0; halving < kHalvings; ++halving) {
      for (int round = 0; round < kRounds && TakeSteps(steps, guess, *best); ++round) {
      }
      for (Step& step : steps) step.size /= 2;
    }
    return best;
  }

 private:
  [[nodiscard]] Eigen::Matrix<float, 2, 3> Projection(const Guess& guess) const {
    const Eigen::Matrix3d turned =
        (Eigen::AngleAxisd(guess.turn_rad, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(guess.tip_rad, Eigen::Vector3d::UnitX()) * picture_.camera_from_model *
         Eigen::AngleAxisd(guess.yaw_rad, Eigen::Vector3d::UnitZ()))
            .toRotationMatrix();
    return (std::exp(guess.log_scale) * turned.topRows<2>()).cast<float>();
  }
  static Eigen::Vector2f MiddleOf(const Guess& guess) {
    return {static_cast<float>(guess.x), static_cast<float>(guess.y)};
  }
  [[nodiscard]] bool IsInFrame(const Eigen::Vector2f& at) const {
    return at.x() >= 0 && at.y() >= 0 && at.x() < static_cast<float>(scene_.cols) &&
           at.y() < static_cast<float>(scene_.rows);
  }

  struct Step {
    Field field;
    double size;
  };

  // Tries each step in both directions and accepts improvements; false if there is none.
  bool TakeSteps(const std::array<Step, 6>& steps, Guess& guess, double& best) const {
    bool any = false;
    for (const Step& step : steps) {
      for (const double way : {-1.0, 1.0}) {
        Guess next = guess;
        next.*step.field += way * step.size;
        const std::optional<double> found = At(next);
        if (!found || *found <= best) continue;
        best = *found;
        guess = next;
        any = true;
      }
    }
    return any;
  }

  const cv::Mat& scene_;
  const ViewPicture& picture_;
  double least_;
};

// The surface samples of a view, and its in-plane rotation relative to the matched view.
struct Beside {
  std::shared_ptr<const ViewPicture> picture;
  Eigen::Vector2d centre_px;  // centre of the view's image: projection of the bounding sphere's centre
  double turn_rad;            // in-plane rotation of the object from the matched view to this view
  double least;               // minimum number of samples inside the frame
};

std::vector<Beside> PicturesBeside(const ObjectModel& model, const LitTemplates& pictures, std::size_t view,
                                   int half_octaves) {
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
  std::vector<Beside> all;
  for (const std::size_t number : numbers) {
    std::shared_ptr<const ViewPicture> picture = pictures.Picture(number, half_octaves);
    if (picture->points.empty()) {
      if (all.empty()) return {};  // the matched view itself has no surface
      continue;
    }
    double turn_rad = 0;
    if (!all.empty()) {
      const Eigen::Quaterniond turn = picture->camera_from_model * all.front().picture->camera_from_model.conjugate();
      turn_rad = WrapAngle(2 * std::atan2(turn.z(), turn.w()));
    }
    const double least = kLeastShare * static_cast<double>(picture->points.size());
    all.push_back(
        {std::move(picture), {model.views[number].width / 2.0, model.views[number].height / 2.0}, turn_rad, least});
  }
  return all;
}

// The position of the matched view in the scene.
struct Place {
  Eigen::Vector2d centre_px;  // of the view's image centre, in the scene
  double scale;
  double turn_rad;
};

Guess GuessAt(const Place& place, const Beside& beside) {
  const Similarity2 about_centre{place.scale, place.turn_rad - beside.turn_rad, place.centre_px};
  const Eigen::Vector2d middle = about_centre.Apply(beside.picture->middle_px - beside.centre_px);
  return {.x = middle.x(),
          .y = middle.y(),
          .log_scale = std::log(place.scale * beside.picture->pixels_per_m),
          .turn_rad = about_centre.rotation_rad};
}

// Drops the samples outside the frame at the tested pose, for all poses: few samples correlate by chance more easily
// than many, so the null distribution must use the same samples.
void KeepWhatIsSeen(const cv::Mat& scene, const Place& place, std::vector<Beside>& pictures) {
  for (Beside& beside : pictures) {
    auto seen = PictureOnScene(scene, *beside.picture, beside.least).Seen(GuessAt(place, beside));
    if (seen.size() == beside.picture->points.size()) continue;
    auto rest = std::make_shared<ViewPicture>(*beside.picture);
    rest->points = std::move(seen);
    beside.picture = std::move(rest);
  }
}

std::optional<double> MostLikeness(const cv::Mat& scene, const std::vector<Beside>& pictures, const Place& place) {
  std::optional<double> most;
  for (const Beside& beside : pictures) {
    const std::optional<double> found =
        PictureOnScene(scene, *beside.picture, beside.least).Climb(GuessAt(place, beside));
    if (found && (!most || *found > *most)) most = found;
  }
  return most;
}

// Mean distance of the samples from their centroid, in scene px.
double ReachPx(const ViewPicture& picture, double scale) {
  double sum_m = 0;
  for (const PicturePoint& point : picture.points) sum_m += point.place.norm();
  return scale * picture.pixels_per_m * sum_m / static_cast<double>(picture.points.size());
}

}  // namespace

cv::Mat SceneForLikeness(const cv::Mat& grey, const LikenessOptions& options) {
  cv::Mat scene;
  const cv::Mat clean = options.impulse_share < 1 ? WithoutImpulses(grey, options.impulse_share) : grey;
  clean.convertTo(scene, CV_32F);
  cv::GaussianBlur(scene, scene, {}, kPictureBlur_px);
  return scene;
}

std::optional<double> SigmasOfLikeness(const cv::Mat& scene, const ObjectModel& model, const LitTemplates& pictures,
                                       std::size_t view, const Similarity2& scene_from_template,
                                       const LikenessOptions& options) {
  constexpr double kMostHalfOctaves = 8;
  const double half_octaves =
      std::clamp(std::round(-2 * std::log2(scene_from_template.scale)), -kMostHalfOctaves, kMostHalfOctaves);
  std::vector<Beside> beside = PicturesBeside(model, pictures, view, static_cast<int>(half_octaves));
  if (beside.empty()) return std::nullopt;
  const Place guess{
      .centre_px = scene_from_template.Apply(Eigen::Vector2d(model.views[view].width, model.views[view].height) / 2),
      .scale = scene_from_template.scale,
      .turn_rad = scene_from_template.rotation_rad};
  const double apart_px = ReachPx(*beside.front().picture, guess.scale);
  KeepWhatIsSeen(scene, guess, beside);
  const std::optional<double> here = MostLikeness(scene, beside, guess);
  if (!here) return std::nullopt;

  Random random(1);
  std::vector<double> elsewhere;
  for (int tries = 0; std::ssize(elsewhere) < options.elsewhere && tries < 4 * options.elsewhere; ++tries) {
    Place other = guess;
    other.centre_px.x() = random.Uniform(0, scene.cols);
    other.centre_px.y() = random.Uniform(0, scene.rows);
    other.turn_rad = random.Uniform(-kPi, kPi);
    if ((other.centre_px - guess.centre_px).norm() < apart_px) continue;
    if (const std::optional<double> found = MostLikeness(scene, beside, other)) elsewhere.push_back(*found);
  }
  if (std::ssize(elsewhere) < options.elsewhere / 2) return std::nullopt;
  const auto n = static_cast<double>(elsewhere.size());
  double sum = 0;
  double sum2 = 0;
  for (const double one : elsewhere) {
    sum += one;
    sum2 += one * one;
  }
  constexpr double kLeastDeviation = 0.02;
  const double deviation = std::sqrt(std::max(0.0, sum2 / n - sum * sum / (n * n)));
  return (*here - sum / n) / std::max(kLeastDeviation, deviation);
}

}  // namespace victorious
