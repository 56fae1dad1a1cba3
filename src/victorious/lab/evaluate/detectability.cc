#include "victorious/lab/evaluate/detectability.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/median.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/similarity.h"
#include "victorious/geometry/view_direction.h"
#include "victorious/input/image/degrade.h"
#include "victorious/input/image/image_file.h"
#include "victorious/lab/evaluate/drawn_clutter.h"
#include "victorious/lab/evaluate/warped_view.h"
#include "victorious/object/model/model_builder.h"
#include "victorious/object/model/nearest_view.h"
#include "victorious/object/model/relit_views.h"
#include "victorious/object/render/paste.h"

namespace victorious {

void DetectabilityOptions::ListFields(FieldList& fields) {
  fields.Add("size_px", size_px,
             {.min = 8, .max = 400, .unit = "px", .reason = "the longest side of the object's bounding box"});
  fields.Add("noise", noise, {.min = 0, .max = 0.9, .reason = "fraction of pixels with salt-and-pepper noise"});
  fields.Add("sun_deg", sun_deg,
             {.min = 5, .max = 90, .unit = "deg", .reason = "elevation of the sun; null: diffuse light"});
  fields.Add("attitude_known", attitude_known, {.reason = "whether telemetry gives the camera's attitude"});
  fields.Add("directions", directions,
             {.min = 3, .max = 10000, .reason = "number of test directions: more reduce the error of the fractions"});
  fields.Add("seed", seed, {.reason = "of the directions, in-plane rotations, clutter and noise"});
}

namespace {

constexpr std::array kSizeLadder_px = {16.0, 23.0, 32.0, 45.0, 64.0, 91.0, 128.0, 181.0, 256.0};
const cv::Size kImageSize(640, 480);
constexpr double kMinOverlap = 0.4;
constexpr double kCorrectView_rad = RadiansFromDegrees(10.0);

// One test direction with its random parameters.
struct Sample {
  std::size_t band;
  ViewDirection direction;
  double turn_rad;                  // in-plane rotation of the object, clockwise
  double relative_sun_azimuth_rad;  // as FrameConditions::relative_sun
  Eigen::Vector2d place;            // 0 to 1, position within the range that keeps the object in the image
  std::uint64_t seed;
  std::size_t photo = 0;  // of a model of photos: the view; `direction` is then how far it is turned out of its plane,
                          // and the direction of the axis
};

// The imaging conditions of a sample.
struct Setting {
  double size_px;
  double noise;
  std::optional<double> sun_deg;
  bool attitude_known;
};

struct TrialResult {
  bool found = false;
  bool correct_view = false;
  cv::Mat bgr;  // the test image, kept only for the callback
  Box box;      // the true box
};

// The result of a sample.
struct SampleResult {
  TrialResult at_size;
  std::size_t min_size = 0;  // index of the minimum detected size in the ladder; its length if none
};

bool IsOfPhotos(const ObjectModel& model) { return model.kind == ModelKind::kPhotos; }

// A photo cannot be shown larger than it is stored.
std::vector<double> MakeSizeLadder(const ObjectModel& model) {
  std::vector<double> sizes_px(kSizeLadder_px.begin(), kSizeLadder_px.end());
  if (!IsOfPhotos(model)) return sizes_px;
  constexpr double kStored_px = 160;
  double max_px = 0;
  for (const ModelView& view : model.views) {
    const Box box = BoundingBox(view.outline);
    max_px = std::max(max_px, std::min(kStored_px, std::max(box.width, box.height)));
  }
  std::erase_if(sizes_px, [&](double size_px) { return size_px > max_px && size_px > kSizeLadder_px.front(); });
  return sizes_px;
}

std::vector<DetectabilityBand> MakeBands(const ObjectModel& model) {
  constexpr double kWidth_deg = 25;
  constexpr double kMaxTurned_deg = 50;  // beyond, hardly any planar object is recognised by SIFT
  double max_rad = 0;
  for (const ModelView& view : model.views) {
    if (view.angles) max_rad = std::max(max_rad, view.angles->off_nadir_rad);
  }
  const double max_deg = IsOfPhotos(model) ? kMaxTurned_deg : DegreesFromRadians(max_rad);
  const int count = std::max(1, static_cast<int>(std::lround(max_deg / kWidth_deg)));
  std::vector<DetectabilityBand> bands;
  for (int i = 0; i < count; ++i) {
    DetectabilityBand band;
    band.min_deg = max_deg * i / count;
    band.max_deg = max_deg * (i + 1) / count;
    bands.push_back(std::move(band));
  }
  return bands;
}

std::vector<Sample> DrawSamples(const ObjectModel& model, std::span<const DetectabilityBand> bands,
                                const DetectabilityOptions& options) {
  std::vector<Sample> samples;
  for (int i = 0; i < options.directions; ++i) {
    Random random(MixSeed(options.seed, static_cast<std::uint64_t>(i)));
    Sample sample;
    sample.band = static_cast<std::size_t>(i) % bands.size();
    sample.direction.azimuth_rad = random.Uniform(0, 2 * kPi);
    sample.direction.off_nadir_rad =
        RadiansFromDegrees(random.Uniform(bands[sample.band].min_deg, bands[sample.band].max_deg));
    // The camera is never upside down, except near nadir, where every in-plane rotation occurs.
    constexpr double kFromAbove_rad = 0.35;
    const double max_turn_rad = IsOfPhotos(model) || sample.direction.off_nadir_rad < kFromAbove_rad ? kPi : kPi / 2;
    sample.turn_rad = random.Uniform(-max_turn_rad, max_turn_rad);
    sample.relative_sun_azimuth_rad = random.Uniform(-kPi, kPi);
    sample.place.x() = random.Uniform();
    sample.place.y() = random.Uniform();
    sample.seed = random.Next();
    if (IsOfPhotos(model)) sample.photo = static_cast<std::size_t>(random.Below(model.views.size()));
    samples.push_back(sample);
  }
  return samples;
}

// Pastes the object onto the image, scaled so that the longest side of its bounding box is `size_px`. Returns the box;
// empty if nothing of the object is visible.
Box Paste(const WarpedView& view, const Sample& sample, double size_px, cv::Mat& grey) {
  Polygon outline = FindMaskOutline(view.mask);
  if (outline.size() < 3) return {};
  const auto boxed = [&](const Similarity2& similarity) {
    Polygon seen;
    for (const Eigen::Vector2d& corner : outline) seen.push_back(similarity.Apply(corner));
    return BoundingBox(seen);
  };
  Similarity2 image_from_view{.scale = 1, .rotation_rad = sample.turn_rad, .translation = {0, 0}};
  const Box turned = boxed(image_from_view);
  image_from_view.scale = size_px / std::max(turned.width, turned.height);
  const Box scaled = boxed(image_from_view);
  image_from_view.translation = {sample.place.x() * (grey.cols - scaled.width) - scaled.x,
                                 sample.place.y() * (grey.rows - scaled.height) - scaled.y};

  victorious::Paste(view.grey, view.mask, image_from_view, grey);
  return boxed(image_from_view);
}

// The frame conditions of a distant camera with the object on its optical axis.
FrameConditions MakeFrameConditions(const Sample& sample, const Setting& setting) {
  FrameConditions conditions;
  if (!setting.attitude_known) return conditions;
  constexpr double kFocal_px = 1e5;
  conditions.vertical = Vertical{.pinhole = {.fx = kFocal_px,
                                             .fy = kFocal_px,
                                             .cx = 0.5 * kImageSize.width,
                                             .cy = 0.5 * kImageSize.height,
                                             .width = kImageSize.width,
                                             .height = kImageSize.height},
                                 .up_in_camera = ViewUpVector(sample.direction.off_nadir_rad, sample.turn_rad)};
  if (setting.sun_deg)
    conditions.relative_sun = Sun{sample.relative_sun_azimuth_rad, RadiansFromDegrees(*setting.sun_deg)};
  return conditions;
}

class Search {
 public:
  Search(const ObjectModel& model, Recognizer recognizer, std::unique_ptr<const FeatureExtractor> extractor)
      : model_(&model),
        ladder_px_(MakeSizeLadder(model)),
        recognizer_(std::move(recognizer)),
        extractor_(std::move(extractor)) {}

  [[nodiscard]] const std::vector<double>& ladder_px() const { return ladder_px_; }

  [[nodiscard]] Expected<WarpedView> RenderSample(const Sample& sample, const std::optional<double>& sun_deg) const {
    if (IsOfPhotos(*model_)) {
      return WarpPhoto(*model_, sample.photo, sample.direction.off_nadir_rad, sample.direction.azimuth_rad);
    }
    std::optional<ViewDirection> sun;
    if (sun_deg) {
      sun = ViewDirection{sample.direction.azimuth_rad + kPi + sample.relative_sun_azimuth_rad,
                          RadiansFromDegrees(90 - *sun_deg)};
    }
    return WarpView(*model_, sample.direction, sun);
  }

  [[nodiscard]] Expected<TrialResult> RunTrial(const WarpedView& view, const Sample& sample,
                                               const Setting& setting) const {
    constexpr ImageDegradation kCamera{.degrade = {.blur_px = 0.5, .grain = 1.5}, .jpeg_quality = 85};
    TrialResult trial_result;
    cv::Mat grey = DrawClutter(kImageSize, sample.seed);
    trial_result.box = Paste(view, sample, setting.size_px, grey);
    cv::cvtColor(grey, trial_result.bgr, cv::COLOR_GRAY2BGR);
    ImageDegradation degradation = kCamera;
    degradation.degrade.noise = setting.noise;
    VICTORIOUS_RETURN_IF_ERROR(DegradeImage(degradation, sample.seed, trial_result.bgr));
    VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet features, extractor_->Extract(GreyFromBgr(trial_result.bgr)));
    // Only the votes decide, without the image: it is made from the model's own rendering, so that its NCC score would
    // be higher than in any video.
    VICTORIOUS_ASSIGN_OR_RETURN(
        const std::vector<Detection> detections,
        recognizer_.Recognize(features,
                              IsOfPhotos(*model_) ? FrameConditions{} : MakeFrameConditions(sample, setting)));
    for (const Detection& detection : detections) {
      if (IntersectionOverUnion(detection.box, trial_result.box) < kMinOverlap) continue;
      const std::optional<ViewDirection>& angles = model_->views[detection.view].angles;
      trial_result.found = true;
      trial_result.correct_view =
          angles ? AngleBetween(*angles, sample.direction) <= kCorrectView_rad : detection.view == sample.photo;
      break;  // the best detection
    }
    return trial_result;
  }

  // Tests the size of the options, then finds the minimum size of the ladder by bisection.
  [[nodiscard]] Expected<SampleResult> Measure(const Sample& sample, Setting setting) const {
    VICTORIOUS_ASSIGN_OR_RETURN(const WarpedView view, RenderSample(sample, setting.sun_deg));
    SampleResult outcome;
    VICTORIOUS_ASSIGN_OR_RETURN(outcome.at_size, RunTrial(view, sample, setting));
    const double asked_px = setting.size_px;
    std::size_t low = 0;
    std::size_t high = ladder_px_.size();
    if (outcome.at_size.found) {
      high = static_cast<std::size_t>(std::ranges::lower_bound(ladder_px_, asked_px) - ladder_px_.begin());
    } else {
      low = static_cast<std::size_t>(std::ranges::upper_bound(ladder_px_, asked_px) - ladder_px_.begin());
    }
    while (low < high) {
      const std::size_t middle = (low + high) / 2;
      setting.size_px = ladder_px_[middle];
      VICTORIOUS_ASSIGN_OR_RETURN(const TrialResult trial_result, RunTrial(view, sample, setting));
      (trial_result.found ? high : low) = trial_result.found ? middle : middle + 1;
    }
    outcome.min_size = high;
    return outcome;
  }

 private:
  const ObjectModel* model_;
  std::vector<double> ladder_px_;
  Recognizer recognizer_;
  std::unique_ptr<const FeatureExtractor> extractor_;
};

// Runs loops in parallel with progress and cancellation.
class ParallelRunner {
 public:
  ParallelRunner(const CancelToken& cancel, const DetectabilityCallbacks& callbacks)
      : cancel_(cancel), callbacks_(callbacks) {}

  // Calls fn(i) for i in [0, count) on all cores; returns the first error, if any.
  template <typename Fn>
  Status ForEach(std::size_t count, Fn fn) {
    all_ += static_cast<int>(count);
    std::vector<Status> status(count);
    oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      if (cancel_.IsCancelled()) return;
      status[i] = fn(i);
      const std::scoped_lock lock(mutex_);
      ++done_;
      if (callbacks_.progress) callbacks_.progress(done_, all_);
    });
    if (cancel_.IsCancelled()) return Fail(ErrorCode::kCancelled, "interrupted");
    for (Status& one : status) VICTORIOUS_RETURN_IF_ERROR(std::move(one));
    return {};
  }

 private:
  const CancelToken& cancel_;
  const DetectabilityCallbacks& callbacks_;
  std::mutex mutex_;
  int done_ = 0;
  int all_ = 0;
};

void AddToRate(const SampleResult& outcome, DetectionRate& rate) {
  rate.tested += 1;
  rate.found += outcome.at_size.found ? 1 : 0;
  rate.correct_view += outcome.at_size.correct_view ? 1 : 0;
}

// Computes the sizes from the minimum detected rung of each direction.
DetectableSizes ComputeDetectableSizes(std::vector<std::size_t> rungs, std::span<const double> ladder_px) {
  std::ranges::sort(rungs);
  const auto at = [&](double rate) -> std::optional<double> {
    if (rungs.empty()) return std::nullopt;
    const std::size_t rung = rungs[static_cast<std::size_t>(std::ceil(rate * static_cast<double>(rungs.size()))) - 1];
    if (rung == ladder_px.size()) return std::nullopt;
    return ladder_px[rung];
  };
  return {.size_50_px = at(0.5), .size_90_px = at(0.9)};
}

Status CheckArguments(const ObjectModel& model, const DetectabilityOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (IsOfPhotos(model)) {
    if (options.sun_deg) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("model {}: is of photos, which cannot be relit: leave the sun off", model.name));
    }
    if (!model.views.empty() && std::ranges::none_of(model.views, [](const ModelView& view) {
          return view.thumbnail.empty() || view.outline.size() < 3;
        })) {
      return {};
    }
  }
  const auto rendered = [](const ModelView& view) { return view.angles && !view.surface.empty(); };
  if (model.views.empty() || !std::ranges::all_of(model.views, rendered)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("model {}: stores no images of its views: make it again by this version", model.name));
  }
  return {};
}

// The rates and sizes of the bands and of all samples.
void Summarize(const ObjectModel& model, const std::vector<Sample>& samples, const std::vector<SampleResult>& outcomes,
               std::span<const double> ladder_px, Detectability& result) {
  std::vector<std::size_t> rungs;
  for (std::size_t b = 0; b < result.bands.size(); ++b) {
    DetectabilityBand& band = result.bands[b];
    std::vector<std::size_t> own;
    std::vector<double> counts;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (samples[i].band != b) continue;
      AddToRate(outcomes[i], band.rate);
      AddToRate(outcomes[i], result.rate);
      own.push_back(outcomes[i].min_size);
      const std::size_t view = result.of_photos ? samples[i].photo : NearestView(model, samples[i].direction);
      counts.push_back(static_cast<double>(model.views[view].feature_count));
    }
    band.min_size = ComputeDetectableSizes(own, ladder_px);
    band.features = MedianOr(std::move(counts), 0);
    std::ranges::copy(own, std::back_inserter(rungs));
  }
  result.min_size = ComputeDetectableSizes(rungs, ladder_px);
}

// The rate where the missed samples are searched again with `setting`.
Expected<DetectionRate> RepeatMissed(const Search& search, const std::vector<Sample>& samples,
                                     std::vector<SampleResult> outcomes, const Setting& setting,
                                     ParallelRunner& runner) {
  std::vector<std::size_t> missed;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!outcomes[i].at_size.found) missed.push_back(i);
  }
  VICTORIOUS_RETURN_IF_ERROR(runner.ForEach(missed.size(), [&](std::size_t i) -> Status {
    const Sample& sample = samples[missed[i]];
    VICTORIOUS_ASSIGN_OR_RETURN(const WarpedView view, search.RenderSample(sample, setting.sun_deg));
    VICTORIOUS_ASSIGN_OR_RETURN(outcomes[missed[i]].at_size, search.RunTrial(view, sample, setting));
    return {};
  }));
  DetectionRate rate;
  for (const SampleResult& outcome : outcomes) AddToRate(outcome, rate);
  return rate;
}

// Ablation: the rates without one of the difficulties, each where it applies and something was missed.
Status Ablate(const Search& search, const std::vector<Sample>& samples, const std::vector<SampleResult>& outcomes,
              const Setting& tested, ParallelRunner& runner, Detectability& result) {
  if (result.rate.found == result.rate.tested) return {};
  const auto repeat = [&](const Setting& setting, std::optional<DetectionRate>& into) -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(into, RepeatMissed(search, samples, outcomes, setting, runner));
    return {};
  };
  if (tested.noise > 0) {
    Setting setting = tested;
    setting.noise = 0;
    VICTORIOUS_RETURN_IF_ERROR(repeat(setting, result.without_noise));
  }
  if (tested.sun_deg) {
    Setting setting = tested;
    setting.sun_deg = std::nullopt;
    VICTORIOUS_RETURN_IF_ERROR(repeat(setting, result.in_diffuse_light));
  }
  if (!tested.attitude_known && !result.of_photos) {
    Setting setting = tested;
    setting.attitude_known = true;
    VICTORIOUS_RETURN_IF_ERROR(repeat(setting, result.with_attitude));
  }
  return {};
}

// Shows the searched images with the object's box: green if it was found, red if it was missed.
void ShowOutcomes(std::vector<SampleResult>& outcomes, const DetectabilityCallbacks& callbacks) {
  for (SampleResult& outcome : outcomes) {
    const Box& box = outcome.at_size.box;
    const cv::Scalar colour = outcome.at_size.found ? cv::Scalar(0, 255, 0) : cv::Scalar(0, 0, 255);
    cv::rectangle(outcome.at_size.bgr, cv::Rect2d(box.x - 4, box.y - 4, box.width + 8, box.height + 8), colour, 2);
    callbacks.image(outcome.at_size.bgr);
  }
}

}  // namespace

Expected<Detectability> MeasureDetectability(const ObjectModel& model, const FeatureOptions& features,
                                             const RecognizeOptions& recognize, const DetectabilityOptions& options,
                                             const CancelToken& cancel, const DetectabilityCallbacks& callbacks) {
  VICTORIOUS_RETURN_IF_ERROR(CheckArguments(model, options));
  FeatureOptions used = features;
  used.engine = model.engine;
  VICTORIOUS_ASSIGN_OR_RETURN(auto extractor, MakeFeatureExtractor(used));
  std::vector<std::shared_ptr<const RelitTemplateSource>> relit_templates(1);
  VICTORIOUS_ASSIGN_OR_RETURN(relit_templates.front(), MakeRelitViews(model));
  VICTORIOUS_ASSIGN_OR_RETURN(Recognizer recognizer,
                              Recognizer::Create({model}, used.engine, recognize, relit_templates));
  const Search search(model, std::move(recognizer), std::move(extractor));

  Detectability result{.options = options,
                       .of_photos = IsOfPhotos(model),
                       .bands = MakeBands(model),
                       .rate = {},
                       .min_size = {},
                       .max_size_px = search.ladder_px().back(),
                       .without_noise = {},
                       .in_diffuse_light = {},
                       .with_attitude = {}};
  const std::vector<Sample> samples = DrawSamples(model, result.bands, options);
  const Setting tested{options.size_px, options.noise, options.sun_deg, options.attitude_known};
  std::vector<SampleResult> outcomes(samples.size());
  ParallelRunner runner(cancel, callbacks);
  VICTORIOUS_RETURN_IF_ERROR(runner.ForEach(samples.size(), [&](std::size_t i) -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(outcomes[i], search.Measure(samples[i], tested));
    if (!callbacks.image) outcomes[i].at_size.bgr.release();
    return {};
  }));

  Summarize(model, samples, outcomes, search.ladder_px(), result);
  VICTORIOUS_RETURN_IF_ERROR(Ablate(search, samples, outcomes, tested, runner, result));
  if (callbacks.image) ShowOutcomes(outcomes, callbacks);
  return result;
}

}  // namespace victorious
