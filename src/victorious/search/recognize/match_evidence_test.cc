#include "victorious/search/recognize/match_evidence.h"

#include <algorithm>
#include <functional>

#include <gtest/gtest.h>

#include "testing/textured_scenes.h"
#include "victorious/search/recognize/model_matcher.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/search/recognize/template_variant.h"

namespace victorious {
namespace {

using testing::FeaturesOf;
using testing::kAround;
using testing::kOffNadir_rad;
using testing::ModelFromAround;
using testing::ModelOf;
using testing::Paste;
using testing::SunDependentTemplates;
using testing::Texture;

RecognizeOptions By(SearchMethod method) {
  RecognizeOptions options;
  options.method = method;
  return options;
}

MatchEvidence Gather(const FeatureSet& scene, const ObjectModel& model, const Box& box, SearchMethod method) {
  return GatherEvidence(scene, {}, model, nullptr, 0, box, By(method)).value();
}

Box BoxOf(const Similarity2& fit, const cv::Mat& object) {
  Polygon outline;
  for (const Eigen::Vector2d& corner :
       BoxCorners({0, 0, static_cast<double>(object.cols), static_cast<double>(object.rows)})) {
    outline.push_back(fit.Apply(corner));
  }
  return BoundingBox(outline);
}

// Each stage counts the matches that passed it, and no stage has more than the one before.
void ExpectConsistentStages(const MatchEvidence& evidence) {
  ASSERT_FALSE(evidence.stages.empty());
  for (std::size_t i = 0; i < evidence.stages.size(); ++i) {
    const auto passed =
        std::ranges::count_if(evidence.matches, [&](const EvidenceMatch& one) { return one.stages > i; });
    EXPECT_EQ(static_cast<std::size_t>(passed), evidence.stages[i].matches) << i;
    if (i > 0) {
      EXPECT_LE(evidence.stages[i].matches, evidence.stages[i - 1].matches);
    }
  }
  EXPECT_TRUE(std::ranges::is_sorted(evidence.matches, std::greater{}, &EvidenceMatch::stages));
}

class EvidenceTest : public ::testing::TestWithParam<SearchMethod> {};

INSTANTIATE_TEST_SUITE_P(Methods, EvidenceTest, ::testing::Values(SearchMethod::kGrammar, SearchMethod::kVotes),
                         [](const auto& test) { return std::string(ToText(kSearchMethodTexts, test.param)); });

TEST_P(EvidenceTest, FollowsTheMatchesOfTheInstanceAtThePlace) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat scene = Texture(640, 480, 4);
  const Similarity2 one = Paste(crate, 1.0, 0.5, {150, 120}, scene);
  const Similarity2 other = Paste(crate, 0.9, -2.0, {470, 330}, scene);
  const ObjectModel model = ModelOf("crate", crate);
  const FeatureSet features = FeaturesOf(scene);
  for (const Similarity2& truth : {one, other}) {
    const MatchEvidence evidence = Gather(features, model, BoxOf(truth, crate), GetParam());
    ExpectConsistentStages(evidence);
    ASSERT_TRUE(evidence.detection.has_value());
    EXPECT_GT(evidence.detection->score, 0.9);
    EXPECT_GT(IntersectionOverUnion(evidence.detection->box, BoxOf(truth, crate)), 0.8);
    EXPECT_FALSE(evidence.is_relit);
    const std::size_t last = evidence.stages.size();
    EXPECT_EQ(evidence.stages.back().stage, EvidenceStage::kInliers);
    ASSERT_GE(evidence.stages.back().matches, 10U);
    // Both instances match at first; what is left lies where the object is.
    EXPECT_GT(evidence.stages.front().matches, evidence.stages.back().matches + 10);
    for (const EvidenceMatch& match : evidence.matches) {
      if (match.stages < last) break;
      EXPECT_LT((truth.Apply(match.in_template_px) - match.in_scene_px).norm(), 6.0);
    }
  }
}

TEST_P(EvidenceTest, WithoutTheObjectHasMatchesButNoPose) {
  const cv::Mat scene = Texture(640, 480, 4);
  const ObjectModel model = ModelOf("crate", Texture(120, 90, 1));
  const MatchEvidence evidence = Gather(FeaturesOf(scene), model, {100, 100, 120, 90}, GetParam());
  ExpectConsistentStages(evidence);
  EXPECT_FALSE(evidence.detection.has_value());
  EXPECT_EQ(evidence.stages.back().matches, 0U);
}

TEST_P(EvidenceTest, APoseElsewhereIsNotThatOfTheSighting) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat scene = Texture(640, 480, 4);
  Paste(crate, 1.0, 0.5, {150, 120}, scene);
  const MatchEvidence evidence = Gather(FeaturesOf(scene), ModelOf("crate", crate), {400, 300, 120, 90}, GetParam());
  EXPECT_FALSE(evidence.detection.has_value());
}

TEST_P(EvidenceTest, AFrameWithoutFeaturesHasNoMatches) {
  const cv::Mat blank(480, 640, CV_8UC1, cv::Scalar(90));
  const MatchEvidence evidence =
      Gather(FeaturesOf(blank), ModelOf("crate", Texture(120, 90, 1)), {0, 0, 120, 90}, GetParam());
  ExpectConsistentStages(evidence);
  EXPECT_TRUE(evidence.matches.empty());
}

TEST(GatherEvidence, ASunlitObjectIsMatchedByARelitTemplate) {
  const ObjectModel model = ModelFromAround();
  const SunDependentTemplates templates;
  constexpr std::size_t kView = 3;
  FrameConditions conditions;
  conditions.vertical = MakeVertical({0, kOffNadir_rad - kPi / 2, 0}, 0.3, 640, 480);
  conditions.relative_sun = Sun{.azimuth_rad = 1.0, .elevation_rad = 0.8};
  // Which sun that is in the model's frame.
  const Eigen::Vector2d centre(320, 240);
  const FeatureSet empty = FeaturesOf(cv::Mat(480, 640, CV_8UC1, cv::Scalar(0)));
  const PreparedScene prepared(empty, conditions.vertical);
  const double cell =
      MakeAzimuthCells(prepared, {}, conditions.vertical).CellCentre(conditions.vertical->AzimuthAt(centre));
  const TemplateVariant variant =
      MakeRelitVariant(model, kView, cell, *conditions.relative_sun, VoteSearchOptions().sun_step_rad);
  cv::Mat scene = Texture(640, 480, 4);
  const cv::Mat lit = SunDependentTemplates::ImageOf(*variant.sun_view, kView);
  const Similarity2 truth = Paste(lit, 1.0, 0.0, centre, scene);
  const FeatureSet features = FeaturesOf(scene);
  const Box box = BoxOf(truth, lit);
  const MatchEvidence evidence =
      GatherEvidence(features, conditions, model, &templates, kView, box, By(SearchMethod::kVotes)).value();
  EXPECT_TRUE(evidence.is_relit);
  ASSERT_TRUE(evidence.detection.has_value());
  EXPECT_GT(IntersectionOverUnion(evidence.detection->box, box), 0.8);
  // Under diffuse light it looks otherwise.
  const MatchEvidence diffuse =
      GatherEvidence(features, conditions, model, nullptr, kView, box, By(SearchMethod::kVotes)).value();
  EXPECT_FALSE(diffuse.is_relit);
  EXPECT_FALSE(diffuse.detection.has_value());
}

TEST(GatherEvidence, RefusesAViewThatTheModelDoesNotHave) {
  const ObjectModel model = ModelOf("crate", Texture(120, 90, 1));
  const auto evidence = GatherEvidence({}, {}, model, nullptr, 1, {0, 0, 10, 10}, {});
  ASSERT_FALSE(evidence.has_value());
  EXPECT_EQ(evidence.error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace victorious
