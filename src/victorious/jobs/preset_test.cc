#include "victorious/jobs/preset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/category/finder/category_images.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/jobs/navigate/navigate_job.h"
#include "victorious/jobs/track/track_job.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/object/model/photo_model.h"
#include "victorious/place/calibrate/time_offset.h"
#include "victorious/place/geolocate/locate_options.h"

namespace victorious {
namespace {

TEST(Preset, ThesisSetsTheParametersOfTheThesisPerCommand) {
  IndexOptions index;
  index.recognize.match.ratio = 0.9;
  ASSERT_TRUE(ApplyPreset(Preset::kThesis, index));
  EXPECT_EQ(index.recognize.method, SearchMethod::kGrammar);
  EXPECT_EQ(index.recognize.match.ratio, 0.8);
  EXPECT_EQ(index.recognize.cascade.radius_px, 75);
  EXPECT_FALSE(index.recognize.pose.refine_plane);
  EXPECT_EQ(index.features.impulse_fraction, 1);
  NavigateVideoOptions navigate;
  ASSERT_TRUE(ApplyPreset(Preset::kThesis, navigate));
  EXPECT_EQ(OptionsToJsonText(navigate.recognize), OptionsToJsonText(index.recognize));
  EXPECT_EQ(OptionsToJsonText(navigate.features), OptionsToJsonText(index.features));
  CategoryTrainOptions category;
  ASSERT_TRUE(ApplyPreset(Preset::kThesis, category));
  EXPECT_EQ(category.features.kind, CategoryFeatureKind::kKeypoints);
  EXPECT_EQ(category.category.scoring, CategoryScoring::kLikelihood);
  EXPECT_TRUE(category.category.thesis.grammar.word_prior);
  CadModelOptions cad;
  ASSERT_TRUE(ApplyPreset(Preset::kThesis, cad));
  EXPECT_EQ(cad.features.contrast_threshold, index.features.contrast_threshold);
  EXPECT_EQ(cad.min_mask_fraction, 0);
  PhotoModelOptions photo;
  ASSERT_TRUE(ApplyPreset(Preset::kThesis, photo));
  EXPECT_EQ(photo.features.impulse_fraction, 1);
}

TEST(Preset, LearntSetsOnlyTheCascade) {
  IndexOptions index;
  ASSERT_TRUE(ApplyPreset(Preset::kLearnt, index));
  EXPECT_EQ(index.recognize.cascade.line_distortion_rad, 0.3);
  EXPECT_EQ(index.recognize.match.ratio, IndexOptions().recognize.match.ratio);
  EXPECT_EQ(OptionsToJsonText(index.features), OptionsToJsonText(IndexOptions().features));
}

TEST(Preset, WindowsAppliesToCategoriesOnly) {
  CategoryTrainOptions category;
  ASSERT_TRUE(ApplyPreset(Preset::kWindows, category));
  EXPECT_TRUE(category.features.windows.enabled);
  EXPECT_GT(category.category.linear.shapes.weight, 0);
  IndexOptions index;
  EXPECT_FALSE(ApplyPreset(Preset::kWindows, index));
}

TEST(Preset, KeepsOtherParameters) {
  IndexOptions index;
  index.recognize.pose.seed = 17;
  ASSERT_TRUE(ApplyPreset(Preset::kThesis, index));
  EXPECT_EQ(index.recognize.pose.seed, 17U);
}

// True if the preset is refused and changes nothing.
template <typename Options>
bool IsRefused(Preset preset) {
  Options options;
  const Status status = ApplyPreset(preset, options);
  return !status && status.error().code == ErrorCode::kInvalidArgument &&
         OptionsToJsonText(options) == OptionsToJsonText(Options());
}

// Fields of the same name in other commands (the `method` of `locate`, `features.impulse_fraction` of `telemetry`) are
// not those of a preset.
TEST(Preset, HasNoEffectOnOtherCommands) {
  for (const Preset preset : {Preset::kThesis, Preset::kLearnt, Preset::kWindows}) {
    EXPECT_TRUE(IsRefused<LocateOptions>(preset));
    EXPECT_TRUE(IsRefused<TimedTelemetryOptions>(preset));
    EXPECT_TRUE(IsRefused<TrackBoxesOptions>(preset));
    EXPECT_TRUE(IsRefused<FeatureOptions>(preset));
  }
  EXPECT_TRUE(IsRefused<CategoryTrainOptions>(Preset::kLearnt));
  EXPECT_TRUE(IsRefused<CadModelOptions>(Preset::kLearnt));
  EXPECT_TRUE(IsRefused<NavigateVideoOptions>(Preset::kWindows));
  LocateOptions locate;
  EXPECT_EQ(ApplyPreset(Preset::kThesis, locate).error().message,
            "preset thesis: sets none of the parameters of this command");
}

TEST(Quality, TradesTimeForCompleteness) {
  const IndexOptions defaults;
  IndexOptions normal;
  ApplyQuality(Quality::kNormal, true, normal);
  EXPECT_EQ(OptionsToJsonText(normal), OptionsToJsonText(defaults));
  IndexOptions fast;
  ApplyQuality(Quality::kFast, true, fast);
  EXPECT_GT(fast.search_interval_s, defaults.search_interval_s);
  EXPECT_GT(fast.follow.search_interval_s, defaults.follow.search_interval_s);
  EXPECT_EQ(fast.recognize.method, SearchMethod::kShortlist);
  IndexOptions fast_for_photos;
  ApplyQuality(Quality::kFast, false, fast_for_photos);
  EXPECT_EQ(fast_for_photos.recognize.method, SearchMethod::kAuto) << "photos are searched for by the grammar";
  IndexOptions thorough;
  ApplyQuality(Quality::kThorough, true, thorough);
  EXPECT_GT(thorough.recognize.search.nearest, defaults.recognize.search.nearest);
  EXPECT_EQ(thorough.recognize.method, SearchMethod::kVotes);
  EXPECT_EQ(thorough.every, 1);
  IndexOptions thorough_for_photos;
  ApplyQuality(Quality::kThorough, false, thorough_for_photos);
  EXPECT_EQ(thorough_for_photos.recognize.method, SearchMethod::kAuto);
}

TEST(Quality, IsReadByItsName) {
  for (const auto& [quality, name] : kQualityTexts) EXPECT_EQ(ParseQuality(name), quality);
  const Error error = ParseQuality("best").error();
  EXPECT_EQ(error.code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(error.message, ::testing::HasSubstr("fast, normal, thorough"));
}

TEST(KeptFeatures, AreThoseOfTheSearchButBounded) {
  const FeatureOptions search = LowContrastFeatureOptions();
  const FeatureOptions kept = MakeKeptFeatureOptions(search);
  EXPECT_EQ(OptionsToJsonText(kept), OptionsToJsonText(search)) << "an index goes on with the features it has";
  EXPECT_EQ(search.max_features, 0);
  EXPECT_EQ(kept.max_features, 4000);
}

}  // namespace
}  // namespace victorious
