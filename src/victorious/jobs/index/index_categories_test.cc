// Categories in an index: sightings like those of models, resumable, and separate from models.
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/category_tools.h"
#include "testing/drawn_flight.h"
#include "testing/fault_injecting_store.h"
#include "victorious/category/finder/category_images.h"
#include "victorious/category/finder/review_marks.h"
#include "victorious/jobs/index/indexer.h"
#include "victorious/store/catalogue.h"

namespace victorious {
namespace {

using testing::Contents;
using testing::DrawnFlight;
using testing::FaultInjectingStore;
using ::testing::HasSubstr;
using testing::ObjectsOf;
using testing::ShortFlight;
using testing::SightingsOf;

constexpr int kCategoryFrames = 80;
constexpr int kChange = 40;  // first frame of the second category

CategoryModel TrainedModel(std::uint64_t seed = 1) {
  CategoryModel model = TrainCategories(testing::DrawExamples(8, seed), testing::SmallOptions()).value();
  CategoryFeatureOptions features;
  features.dense = testing::CoarseGrid();
  model.features_json = OptionsToJsonText(features);
  return model;
}

class IndexCategoriesTest : public ::testing::Test {
 protected:
  // A cross before a disc, then behind it; each is static.
  void SetUp() override {
    auto writer = VideoWriter::Create(video_, {.width = 160, .height = 120, .fps = 10});
    ASSERT_TRUE(writer) << writer.error().message;
    for (int i = 0; i < kCategoryFrames; ++i) {
      Random random(i < kChange ? 11 : 12);
      cv::Mat bgr;
      cv::cvtColor(testing::DrawPair(i < kChange, random), bgr, cv::COLOR_GRAY2BGR);
      ASSERT_TRUE((*writer)->Write(bgr));
    }
    ASSERT_TRUE((*writer)->Finish());
  }

  [[nodiscard]] std::unique_ptr<IndexStore> Store(std::string_view name) const {
    return OpenSqliteStore(folder_ / name, StoreMode::kCreate).value();
  }

  Expected<IndexReport> TryIndex(IndexStore& store, const IndexOptions& options = {}, Redo redo = Redo::kNever,
                                 std::uint64_t seed = 1, const CancelToken& cancel = {}) const {
    VICTORIOUS_ASSIGN_OR_RETURN(const Indexer indexer, Indexer::Create({}, options, TrainedModel(seed)));
    return indexer.Index({.video = video_, .telemetry = {}, .redo = redo, .threads = 2}, cancel, store);
  }

  testing::ScratchFolder folder_;
  std::string video_ = (folder_ / "pairs.mkv").string();
};

TEST_F(IndexCategoriesTest, FindsEachCategoryInItsFrames) {
  const auto store = Store("index.db");
  const auto report = TryIndex(*store);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->frames_searched, kCategoryFrames);
  for (const bool first : {true, false}) {
    const SightingFilter filter{.category_name = first ? "cross-disc" : "disc-cross"};
    const std::vector<SightingRecord> sightings = SightingsOf(*store, filter);
    int right = 0;
    for (const SightingRecord& sighting : sightings) {
      right += (sighting.frame < kChange) == first ? 1 : 0;
      EXPECT_FALSE(sighting.box.IsEmpty());
      EXPECT_GE(sighting.score, 0.5);
    }
    EXPECT_GE(right, kChange - 2);
    EXPECT_EQ(right, static_cast<int>(sightings.size()));
    const std::vector<ObjectRecord> objects = ObjectsOf(*store, filter);
    ASSERT_EQ(objects.size(), 1);  // one tracklet
    EXPECT_EQ(objects[0].frames, right);
  }
  const std::string contents = Contents(*store);
  EXPECT_THAT(contents, HasSubstr(R"("model":null,"category":"cross-disc")"));
  EXPECT_THAT(contents, HasSubstr(R"("matches":null,"view":null)"));
}

TEST_F(IndexCategoriesTest, SearchesEveryNthFrameOnly) {
  const auto store = Store("index.db");
  IndexOptions options;
  options.every = 4;
  options.follow.restart_interval_frames = 8;
  ASSERT_TRUE(TryIndex(*store, options));
  const std::vector<SightingRecord> sightings = SightingsOf(*store);
  EXPECT_FALSE(sightings.empty());
  for (const SightingRecord& sighting : sightings) EXPECT_EQ(sighting.frame % 4, 0);
}

TEST_F(IndexCategoriesTest, ResumedSearchEqualsUninterruptedSearch) {
  IndexOptions options;
  options.keep.interval_s = 0;  // so that frames are stored before the end of the video
  const auto whole = Store("whole.db");
  ASSERT_TRUE(TryIndex(*whole, options));

  const auto parts = Store("parts.db");
  CancelToken cancel;
  FaultInjectingStore hooked(*parts, [&]() -> Status {
    cancel.Cancel();
    return {};
  });
  ASSERT_FALSE(TryIndex(hooked, options, Redo::kNever, 1, cancel));
  const std::int64_t done = parts->FindSearch(1, 1).value().value().next_frame;
  EXPECT_GT(done, 0);
  EXPECT_LT(done, kCategoryFrames);
  const auto rest = TryIndex(*parts, options);
  ASSERT_TRUE(rest) << rest.error().message;
  EXPECT_EQ(rest->frames_searched, kCategoryFrames - done);
  EXPECT_EQ(Contents(*parts), Contents(*whole));

  const auto again = TryIndex(*parts, options);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->frames_searched, 0);
  ASSERT_TRUE(TryIndex(*parts, options, Redo::kAlways));
  EXPECT_EQ(SightingsOf(*parts).size(), SightingsOf(*whole).size());
}

TEST_F(IndexCategoriesTest, OtherParametersNeedRedo) {
  const auto store = Store("index.db");
  ASSERT_TRUE(TryIndex(*store));
  IndexOptions options;
  options.categories.min_probability = 0.6;
  const auto other = TryIndex(*store, options);
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("categories.min_probability was 0.5, is 0.6"));
}

TEST_F(IndexCategoriesTest, ChangedModelReplacesItsSightings) {
  const auto store = Store("index.db");
  ASSERT_TRUE(TryIndex(*store));
  const auto report = TryIndex(*store, {}, Redo::kNever, 2);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->frames_searched, kCategoryFrames);
  std::set<std::pair<std::int64_t, std::int64_t>> seen;
  for (const SightingRecord& sighting : SightingsOf(*store))
    EXPECT_TRUE(seen.emplace(sighting.model, sighting.frame).second);
}

TEST_F(IndexCategoriesTest, ModelsAndCategoriesAreIndexedIndependently) {
  const auto store = Store("index.db");
  ASSERT_TRUE(TryIndex(*store));
  const auto no_model = Catalogue::Read(*store, {.model_name = "cross-disc"});
  ASSERT_FALSE(no_model);
  EXPECT_EQ(no_model.error().message, "model cross-disc: not in the index, which contains: none");
  const auto no_category = Catalogue::Read(*store, {.category_name = "cross"});
  ASSERT_FALSE(no_category);
  EXPECT_EQ(no_category.error().message, "category cross: not in the index, which contains: cross-disc, disc-cross");

  const DrawnFlight flight(ShortFlight(1));
  ObjectModel namesake = flight.Model(0);
  namesake.name = "cross-disc";
  const auto both = Indexer::Create({namesake}, {}, TrainedModel());
  ASSERT_FALSE(both);
  EXPECT_THAT(both.error().message, HasSubstr("cross-disc: is the name of both a model and a category"));
  const auto later = Indexer::Create({namesake}, {}).value().Index({.video = video_}, {}, *store);
  ASSERT_FALSE(later);
  EXPECT_THAT(later.error().message, HasSubstr("cross-disc: is the name of both a model and a category"));
  EXPECT_FALSE(SightingsOf(*store, {.category_name = "cross-disc"}).empty());
}

TEST_F(IndexCategoriesTest, SearchingWithModelsChangesNothing) {
  const DrawnFlight flight(ShortFlight());
  const auto apart = Store("apart.db");
  const auto together = Store("together.db");
  const auto index = [&](std::vector<ObjectModel> models, std::optional<CategoryModel> categories, IndexStore& store) {
    const Indexer indexer = Indexer::Create(std::move(models), {}, std::move(categories)).value();
    const auto report = indexer.Index({.video = flight.video(), .threads = 2}, {}, store);
    EXPECT_TRUE(report) << report.error().message;
  };
  index(flight.Models(), std::nullopt, *apart);
  index(flight.Models(), TrainedModel(), *together);
  for (int object = 0; object < 2; ++object) {
    const SightingFilter filter{.model_name = flight.Model(object).name};
    const auto a = SightingsOf(*apart, filter);
    const auto b = SightingsOf(*together, filter);
    ASSERT_EQ(a.size(), b.size());
    EXPECT_FALSE(a.empty());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].box, b[i].box);
  }
}

// What the team decided, each by the frame that the category was recognised in.
TEST_F(IndexCategoriesTest, ReviewsAreMarks) {
  const auto store = Store("index.db");
  ASSERT_TRUE(TryIndex(*store));
  EXPECT_TRUE(ListReviewMarks(*store)->empty());
  const std::int64_t right = ObjectsOf(*store, {.category_name = "cross-disc"})[0].id;
  const std::int64_t wrong = ObjectsOf(*store, {.category_name = "disc-cross"})[0].id;
  ASSERT_TRUE(store->PutReview(wrong, {.verdict = Verdict::kRejected, .updated_utc_us = 1}));
  ASSERT_TRUE(store->PutReview(right, {.verdict = Verdict::kRejected, .updated_utc_us = 1, .reviewer = "ann"}));
  ASSERT_TRUE(store->PutReview(right, {.verdict = Verdict::kAccepted, .updated_utc_us = 2, .reviewer = "bob"}));
  const auto marks = ListReviewMarks(*store);
  ASSERT_TRUE(marks) << marks.error().message;
  ASSERT_EQ(marks->size(), 2U);
  EXPECT_EQ(marks->at(0).category, "cross-disc");
  EXPECT_TRUE(marks->at(0).is_right) << "the latest decision";
  EXPECT_LT(marks->at(0).time_s, 0.1 * kChange);
  EXPECT_EQ(marks->at(1).category, "disc-cross");
  EXPECT_FALSE(marks->at(1).is_right);
  EXPECT_GE(marks->at(1).time_s, 0.1 * kChange - 0.2);
  for (const ReviewMark& mark : *marks) {
    const auto frame = ReadMarkedFrame(mark, {}, {});
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(frame->size(), cv::Size(160, 120));
    EXPECT_EQ(frame->type(), CV_8UC1);
  }
  const FileRoots elsewhere({"/nowhere"});
  EXPECT_EQ(ReadMarkedFrame(marks->at(0), elsewhere, {}).error().code, ErrorCode::kPermissionDenied);
  ReviewMark live = marks->at(0);
  live.video.name = "rtsp://camera/stream";
  EXPECT_EQ(ReadMarkedFrame(live, {}, {}).error().code, ErrorCode::kUnsupported);
  ASSERT_TRUE(store->PutReview(right, {.note = "look again", .updated_utc_us = 3, .reviewer = "bob"}));
  EXPECT_FALSE(ListReviewMarks(*store)->at(0).is_right) << "Ann's decision is the team's again";
}

}  // namespace
}  // namespace victorious
