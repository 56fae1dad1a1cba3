#include "victorious/jobs/preset.h"

#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/category/finder/category_images.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/jobs/navigate/navigate_job.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/object/model/photo_model.h"
#include "victorious/search/recognize/recognizer.h"

namespace victorious {
namespace {

// Lowe's values (IJCV 2004), and no prior denoising.
void SetThesisFeatures(FeatureOptions& features) {
  features.contrast_threshold = 0.04;
  features.edge_threshold = 10.0;
  features.impulse_fraction = 1.0;
}

// Chapter 3: ratio test, cascade of table 3.1 with R = 75 px, MLESAC without refinement.
void SetThesisSearch(RecognizeOptions& recognize) {
  recognize.method = SearchMethod::kGrammar;
  recognize.match.ratio = 0.8;
  recognize.cascade.filter = CascadeFilter::kCascade;
  recognize.cascade.radius_px = 75.0;
  recognize.cascade.scale_distortion = 1.45;
  recognize.cascade.distance_distortion = 1.45;
  recognize.cascade.first_approval = 0.2;
  recognize.cascade.orientation_distortion_rad = 1.5;
  recognize.cascade.line_distortion_rad = 0.6;
  recognize.cascade.second_approval = 0.4;
  recognize.cascade.third_approval = 0.6;
  recognize.cascade.min_votes = 2;
  recognize.cascade.distinct_stages = 1;
  recognize.cascade.all_measures = false;
  recognize.pose.refine_plane = false;
}

// Rounded from `experiment chapter3.filters`.
void SetLearntSearch(RecognizeOptions& recognize) {
  recognize.method = SearchMethod::kGrammar;
  recognize.cascade.scale_distortion = 1.7;
  recognize.cascade.distance_distortion = 1.35;
  recognize.cascade.orientation_distortion_rad = 0.5;
  recognize.cascade.line_distortion_rad = 0.3;
  recognize.cascade.first_approval = 0.1;
  recognize.cascade.second_approval = 0.2;
  recognize.cascade.third_approval = 0.6;
  recognize.cascade.min_votes = 2;
  recognize.cascade.all_measures = true;
}

// Equations 3.1 to 3.3, in the reading that reproduces the thesis's figures.
void SetThesisCategories(CategoryTrainOptions& options) {
  options.features.kind = CategoryFeatureKind::kKeypoints;
  options.features.surroundings = Surroundings::kCalibrate;
  options.features.mirrored = false;
  options.category.scoring = CategoryScoring::kLikelihood;
  options.category.vocabulary.words_per_keypoint = 1;
  options.category.vocabulary.root = false;
  options.category.thesis.grammar.kernel_cap = 3.0;
  options.category.thesis.grammar.word_prior = true;
  options.category.thesis.grammar.likelihood_exponent = 0.1;
}

void SetWindows(CategoryTrainOptions& options) {
  options.features.windows.enabled = true;
  options.features.dense.sizes = 5;
  options.category.vocabulary.words = 1000;
  options.category.linear.shapes.weight = 4.0;
}

// Features and search of a command that searches videos.
template <typename Options>
Status ApplyToSearch(Preset preset, Options& options) {
  VICTORIOUS_RETURN_IF_ERROR(ApplyPreset(preset, options.recognize));
  if (preset == Preset::kThesis) SetThesisFeatures(options.features);
  return {};
}

}  // namespace

Error PresetDoesNotApply(Preset preset) {
  return {ErrorCode::kInvalidArgument,
          fmt::format("preset {}: sets none of the parameters of this command", ToText(kPresetTexts, preset))};
}

Status ApplyPreset(Preset preset, RecognizeOptions& options) {
  if (preset == Preset::kWindows) return std::unexpected(PresetDoesNotApply(preset));
  preset == Preset::kThesis ? SetThesisSearch(options) : SetLearntSearch(options);
  return {};
}

Status ApplyPreset(Preset preset, IndexOptions& options) { return ApplyToSearch(preset, options); }

Status ApplyPreset(Preset preset, NavigateVideoOptions& options) { return ApplyToSearch(preset, options); }

Status ApplyPreset(Preset preset, PhotoModelOptions& options) {
  if (preset != Preset::kThesis) return std::unexpected(PresetDoesNotApply(preset));
  SetThesisFeatures(options.features);
  return {};
}

Status ApplyPreset(Preset preset, CadModelOptions& options) {
  if (preset != Preset::kThesis) return std::unexpected(PresetDoesNotApply(preset));
  SetThesisFeatures(options.features);
  options.min_mask_fraction = 0.0;  // all keypoints on the object
  return {};
}

Status ApplyPreset(Preset preset, CategoryTrainOptions& options) {
  if (preset == Preset::kLearnt) return std::unexpected(PresetDoesNotApply(preset));
  preset == Preset::kThesis ? SetThesisCategories(options) : SetWindows(options);
  return {};
}

Expected<Quality> ParseQuality(std::string_view name) {
  if (const std::optional<Quality> quality = FromText(kQualityTexts, name)) return *quality;
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("--quality {}: give one of {}", name, fmt::join(Texts(kQualityTexts), ", ")));
}

void ApplyQuality(Quality quality, bool cad_only, IndexOptions& options) {
  constexpr double kFastInterval_s = 0.6;
  constexpr double kFastRegionInterval_s = 0.5;
  constexpr int kThoroughNearest = 8;
  switch (quality) {
    case Quality::kFast:
      options.search_interval_s = kFastInterval_s;
      options.follow.search_interval_s = kFastRegionInterval_s;
      if (cad_only) options.recognize.method = SearchMethod::kShortlist;
      return;
    case Quality::kNormal:
      return;
    case Quality::kThorough:
      options.every = 1;
      options.recognize.search.nearest = kThoroughNearest;
      if (cad_only) options.recognize.method = SearchMethod::kVotes;
      return;
  }
}

}  // namespace victorious
