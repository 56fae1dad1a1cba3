#include "victorious/jobs/learn_views.h"

#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/drawn_flight.h"
#include "victorious/input/video/video_writer.h"
#include "victorious/jobs/index/indexer_test.h"
#include "victorious/jobs/turning_scene_test.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

const TurningScene& Turning() {
  static const TurningScene scene({StandingObject{.at = {450, 450}}}, 6);
  return scene;
}

// An index of the turning object, which a photo of one side found, and which was followed from there.
struct IndexedScene {
  explicit IndexedScene(int frames) {
    WriteVideo(frames);
    Index(video, {PhotoModelOf(Turning())}, *store);
    const std::vector<ObjectRecord> objects = store->Objects({}).value();
    EXPECT_THAT(objects, SizeIs(1));
    if (!objects.empty()) object = objects.front().id;
  }

  void WriteVideo(int frames) const {
    auto writer = VideoWriter::Create(
        video, {.width = TurningScene::kImageWidth, .height = TurningScene::kImageHeight, .fps = 1 / kFrame_s});
    ASSERT_TRUE(writer) << writer.error().message;
    for (int i = 0; i < frames; ++i) ASSERT_TRUE((*writer)->Write(Turning().Draw(i)));
    ASSERT_TRUE((*writer)->Finish());
  }

  [[nodiscard]] Expected<LearntViews> Learn(const ObjectModel& known, const CancelToken& cancel = {}) const {
    return LearnViews(known, object, *store, cancel);
  }

  testing::ScratchFolder folder;
  std::string video = (folder / "can.mkv").string();
  std::unique_ptr<IndexStore> store = OpenStore((folder / "index.db").string(), StoreMode::kCreate).value();
  std::int64_t object = 0;
};

class LearnViewsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { indexed_ = std::make_unique<IndexedScene>(kFrames); }
  static void TearDownTestSuite() { indexed_.reset(); }

  // The fraction of the frames with a sighting in which a model is recognised where the object is, of one in three.
  [[nodiscard]] static double FractionRecognised(const ObjectModel& model) {
    const Recognizer recognizer = Recognizer::Create({model}, model.engine, {}).value();
    const auto extractor = MakeFeatureExtractor({}).value();
    const std::vector<SightingRecord> sightings = indexed_->store->Sightings({}).value();
    int looked_at = 0;
    int recognised = 0;
    for (std::size_t i = 0; i < sightings.size(); i += 3) {
      const auto frame = static_cast<int>(sightings[i].frame);
      cv::Mat grey;
      cv::cvtColor(Turning().Draw(frame), grey, cv::COLOR_BGR2GRAY);
      const std::vector<Detection> found = recognizer.Recognize(extractor->Extract(grey).value()).value();
      ++looked_at;
      if (!found.empty() && IntersectionOverUnion(found.front().box, Turning().BoxOf(0, frame)) > 0.3) ++recognised;
    }
    return static_cast<double>(recognised) / looked_at;
  }

  static std::unique_ptr<IndexedScene> indexed_;
};

std::unique_ptr<IndexedScene> LearnViewsTest::indexed_;

TEST_F(LearnViewsTest, ModelKnowsTheObjectFromAllSidesThatWereSeen) {
  const ObjectModel photo = PhotoModelOf(Turning());
  const LearntViews grown = indexed_->Learn(photo).value();
  EXPECT_GE(grown.learnt, 3U);
  EXPECT_GE(grown.looked_at, 40U);
  ASSERT_THAT(grown.model.views, SizeIs(1 + grown.learnt));
  EXPECT_EQ(grown.model.views.front().source, photo.views.front().source) << "what it had stays, first";
  EXPECT_EQ(grown.model.views.front().feature_count, photo.views.front().feature_count);
  EXPECT_THAT(grown.model.views.back().source, HasSubstr("can.mkv, "));
  EXPECT_LE(FractionRecognised(photo), 0.5);
  EXPECT_GE(FractionRecognised(grown.model), 0.8);
}

TEST_F(LearnViewsTest, NewModelIsLearntFromTheObjectAlone) {
  const LearntViews learnt = indexed_->Learn(EmptyPhotoModel("can", 2.5, {})).value();
  EXPECT_GE(learnt.learnt, 4U);
  EXPECT_EQ(learnt.model.length_m, 2.5);
  EXPECT_GE(FractionRecognised(learnt.model), 0.8);
}

TEST_F(LearnViewsTest, NothingIsLearntTwice) {
  const LearntViews first = indexed_->Learn(PhotoModelOf(Turning())).value();
  EXPECT_LE(indexed_->Learn(first.model).value().learnt, first.learnt / 4);
}

TEST_F(LearnViewsTest, CanBeInterrupted) {
  CancelToken cancel;
  cancel.Cancel();
  EXPECT_EQ(indexed_->Learn(PhotoModelOf(Turning()), cancel).error().code, ErrorCode::kCancelled);
}

TEST(LearnViews, RefusesAnotherVideoUnderTheSameName) {
  const IndexedScene indexed(kPhotoFrame + 4);
  indexed.WriteVideo(kPhotoFrame + 3);
  const auto learnt = indexed.Learn(PhotoModelOf(Turning()));
  ASSERT_FALSE(learnt);
  EXPECT_EQ(learnt.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(learnt.error().message, HasSubstr("not the video that was indexed"));
}

}  // namespace
}  // namespace victorious
