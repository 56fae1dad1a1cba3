#include "victorious/search/follow/looks_before.h"

#include <cstddef>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "testing/plain_scene.h"
#include "victorious/object/model/relit_views.h"

namespace victorious {
namespace {

using testing::PlainModel;
using testing::PlainScene;

// A flight past an object of one grey: the image moves to the right, frame by frame.
class LooksBeforeTest : public ::testing::Test {
 protected:
  static constexpr int kBefore = 5;    // frames
  static constexpr int kStep_px = 40;  // a twentieth of the diagonal
  static constexpr std::size_t kView = 5;
  static constexpr int kWidth_px = 640;

  [[nodiscard]] static PlainScene SceneOf(int frames_before, double left_px) {
    static const cv::Mat ground = testing::DrawFields(kView, {kWidth_px + kBefore * kStep_px, 480});
    const int shift_px = frames_before * kStep_px;
    return testing::MakePlainScene(kView, ground(cv::Rect(shift_px, 0, kWidth_px, ground.rows)).clone(),
                                   left_px - shift_px);
  }

  [[nodiscard]] static FollowedFrame FrameOf(int number, const PlainScene& scene) {
    return {.frame = {.index = number, .time_s = 0.5 * number, .image = scene.grey},
            .conditions = scene.conditions,
            .objects = {}};
  }

  // The frames before, the nearest first, of a flight in which the object is at `left_px` at the end.
  void FlyTo(double left_px) {
    now_scene_ = SceneOf(0, left_px);
    now_ = FrameOf(kBefore, now_scene_);
    for (int i = 1; i <= kBefore; ++i) frames_.push_back(FrameOf(kBefore - i, SceneOf(i, left_px)));
    for (int i = 1; i <= kBefore; ++i) {
      before_.push_back(
          {.seen = &frames_[static_cast<std::size_t>(i - 1)], .then_from_now = {.translation = {-i * kStep_px, 0}}});
    }
    const std::vector<ShapeMatch> found = search_.Find(now_scene_.grey, now_scene_.conditions, 1).value();
    ASSERT_FALSE(found.empty());
    match_ = found.front();
    ASSERT_LT((match_.centre_px - now_scene_.centre_px).norm(), 5);
  }

  [[nodiscard]] LooksBefore LookFor(const ShapeMatch& match) {
    FeatureSet features{.keypoints = {}, .descriptors = {}, .image_width = kWidth_px, .image_height = 480};
    const std::vector<Detection> detections = {search_.MakeDetection(match, features).value()};
    auto looks = LookBefore(recognizer_, *extractor_, {}, now_, features, detections, before_, search_);
    EXPECT_TRUE(looks);
    return looks->at(0);
  }

  // A match in the first frame, followed to `now_`.
  [[nodiscard]] std::vector<ShapeMatch> FollowToNow(const ShapeMatch& match) {
    FeatureSet features{.keypoints = {}, .descriptors = {}, .image_width = kWidth_px, .image_height = 480};
    const std::vector<Detection> detections = {search_.MakeDetection(match, features).value()};
    std::vector<const FollowedFrame*> since;
    for (int i = kBefore - 2; i >= 0; --i) since.push_back(&frames_[static_cast<std::size_t>(i)]);
    since.push_back(&now_);
    return FindFurtherOn(recognizer_, *extractor_, {}, frames_.back(), FullFrameResult{features, detections}, since,
                         search_)
        .value();
  }

  std::vector<ObjectModel> models_{PlainModel()};
  std::vector<std::shared_ptr<const RelitTemplateSource>> surfaces_{MakeRelitViews(PlainModel()).value()};
  ShapeSearch search_{models_, surfaces_, testing::CellsOfFields()};
  std::unique_ptr<const FeatureExtractor> extractor_ = MakeFeatureExtractor(LowContrastFeatureOptions()).value();
  Recognizer recognizer_ = Recognizer::Create(models_, FeatureOptions().engine, {}).value();
  PlainScene now_scene_;
  FollowedFrame now_;
  std::vector<FollowedFrame> frames_;
  std::vector<FrameBefore> before_;
  ShapeMatch match_;
};

TEST_F(LooksBeforeTest, AnObjectIsFoundInAllFrames) {
  FlyTo(310);
  const LooksBefore looks = LookFor(match_);
  EXPECT_EQ(looks.looks, kBefore);
  EXPECT_GT(looks.sum, kBefore * (kMinDecadesInOnePlace + kDecadesOfOnePlace));
}

TEST_F(LooksBeforeTest, APlaceWithoutTheObjectIsAMissInEveryFrame) {
  FlyTo(310);
  ShapeMatch elsewhere = match_;
  elsewhere.centre_px += Eigen::Vector2d(150, 100);
  const LooksBefore looks = LookFor(elsewhere);
  EXPECT_EQ(looks.looks, kBefore);
  EXPECT_EQ(looks.sum, kBefore * kDecadesWhereMissed);
}

TEST_F(LooksBeforeTest, FramesWithoutMotionAreNoLooks) {
  FlyTo(310);
  for (FrameBefore& past : before_) past = {.seen = &now_, .then_from_now = {}};
  EXPECT_EQ(LookFor(match_).looks, 0);
}

TEST_F(LooksBeforeTest, FramesThatShowAPartAreNoLooks) {
  FlyTo(110);
  const LooksBefore looks = LookFor(match_);
  EXPECT_GE(looks.looks, 1);
  EXPECT_LE(looks.looks, now_scene_.box.x / kStep_px);
}

TEST_F(LooksBeforeTest, AnObjectOfTheLastFrameIsNotLookedFor) {
  FlyTo(310);
  FeatureSet features;
  Detection known = search_.MakeDetection(match_, features).value();
  for (Eigen::Vector2d& corner : known.outline) corner.x() -= kStep_px;
  frames_[0].objects.push_back({.detection = known, .features = {}});
  const LooksBefore looks = LookFor(match_);
  EXPECT_EQ(looks.looks, 0);
  EXPECT_TRUE(looks.is_explained);
  Detection& other = frames_[0].objects[0].detection;
  other.model_index = 1;
  EXPECT_EQ(LookFor(match_).looks, 0) << "it explains the match";
  other.neg_log10_nfa = match_.neg_log10_nfa - 1;
  EXPECT_EQ(LookFor(match_).looks, kBefore) << "it has less evidence";
}

TEST_F(LooksBeforeTest, AMatchIsFoundFurtherOn) {
  FlyTo(310);
  const FollowedFrame& first = frames_.back();
  const std::vector<ShapeMatch> start = search_.Find(first.frame.image, first.conditions, 1).value();
  ASSERT_FALSE(start.empty());
  const std::vector<ShapeMatch> found = FollowToNow(start.front());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_LT((found[0].centre_px - now_scene_.centre_px).norm(), 5);
  EXPECT_NEAR(found[0].neg_log10_nfa, match_.neg_log10_nfa, 2) << "that of a whole frame";
}

TEST_F(LooksBeforeTest, NothingIsFoundFurtherOnWhereNothingIs) {
  FlyTo(310);
  const FollowedFrame& first = frames_.back();
  ShapeMatch elsewhere = search_.Find(first.frame.image, first.conditions, 1).value().at(0);
  elsewhere.centre_px += Eigen::Vector2d(150, 100);
  EXPECT_TRUE(FollowToNow(elsewhere).empty());
}

TEST(LooksBefore, AreWeighedByTheirMean) {
  const LooksBefore four{.looks = 4, .sum = 4 * 5.0};
  EXPECT_DOUBLE_EQ(four.NegLog10Nfa(5.0 - kDecadesOfOnePlace), 5);
  EXPECT_EQ(LooksBefore{}.NegLog10Nfa(3), 3 + kDecadesOfOnePlace);
}

}  // namespace
}  // namespace victorious
