#include "victorious/pipeline/preset.h"

#include <gtest/gtest.h>

#include "victorious/geolocate/locate_options.h"
#include "victorious/model/cad_model.h"
#include "victorious/pipeline/index_options.h"
#include "victorious/recognize/category_images.h"

namespace victorious {
namespace {

TEST(Preset, ThesisSetsWhatTheThesisSaysInEachList) {
  IndexOptions index;
  index.recognize.match.ratio = 0.9;
  ASSERT_TRUE(ApplyPreset("thesis", CollectFields(index)).has_value());
  EXPECT_EQ(index.recognize.method, SearchMethod::kGrammar);
  EXPECT_EQ(index.recognize.match.ratio, 0.8);
  EXPECT_EQ(index.recognize.cascade.radius_px, 75);
  EXPECT_EQ(index.features.impulse_fraction, 1);
  CategoryTrainOptions category;
  ASSERT_TRUE(ApplyPreset("thesis", CollectFields(category)).has_value());
  EXPECT_EQ(category.features.kind, "keypoints");
  EXPECT_EQ(category.category.scoring, "likelihood");
  EXPECT_TRUE(category.category.grammar.word_prior);
  CadModelOptions cad;
  ASSERT_TRUE(ApplyPreset("thesis", CollectFields(cad)).has_value());
  EXPECT_EQ(cad.features.contrast_threshold, index.features.contrast_threshold);
  EXPECT_EQ(cad.min_mask_fraction, 0);
}

TEST(Preset, LearntSetsTheCascadeAlone) {
  IndexOptions index;
  ASSERT_TRUE(ApplyPreset("learnt", CollectFields(index)).has_value());
  EXPECT_EQ(index.recognize.cascade.line_distortion_rad, 0.3);
  EXPECT_EQ(index.recognize.match.ratio, IndexOptions().recognize.match.ratio);
  EXPECT_EQ(index.features.contrast_threshold, IndexOptions().features.contrast_threshold);
}

TEST(Preset, WindowsAreForCategoriesAlone) {
  CategoryTrainOptions category;
  ASSERT_TRUE(ApplyPreset("windows", CollectFields(category)).has_value());
  EXPECT_TRUE(category.features.windows.enabled);
  EXPECT_GT(category.category.shapes.weight, 0);
  IndexOptions index;
  EXPECT_FALSE(ApplyPreset("windows", CollectFields(index)).has_value());
}

TEST(Preset, LeavesTheRestAsItIs) {
  IndexOptions index;
  index.recognize.pose.seed = 17;
  ASSERT_TRUE(ApplyPreset("thesis", CollectFields(index)).has_value());
  EXPECT_EQ(index.recognize.pose.seed, 17U);
}

TEST(Preset, UnknownNamesAndListsWithoutItsFieldsAreRefused) {
  IndexOptions index;
  EXPECT_EQ(ApplyPreset("nonsense", CollectFields(index)).error().message,
            "nonsense: no such preset; there are thesis, learnt, windows");
  LocateOptions locate;
  EXPECT_EQ(ApplyPreset("thesis", CollectFields(locate)).error().message,
            "preset thesis: sets none of the parameters of this command");
  TrackletOptions runs;
  EXPECT_EQ(ApplyPreset("thesis", CollectFields(runs)).error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace victorious
