// Videos of an index, tested for every implementation: found by their names, their texts as given, and the times that
// they cover of live sources.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/scratch_postgres.h"
#include "victorious/store/index_store.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(FindVideosByName, PrefersTheWholeNameToItsLastParts) {
  const std::vector<VideoRecord> videos = {{.id = 1, .name = "a.mp4"},
                                           {.id = 2, .name = "/data/flight/a.mp4"},
                                           {.id = 3, .name = "frames/"},
                                           {.id = 4, .name = "/data/other/a.mp4"},
                                           {.id = 5, .name = "rtsp://camera/live"},
                                           {.id = 6, .name = "rtsp://ann:secret@camera/two"}};
  const auto ids = [&](std::string_view name) {
    std::vector<std::int64_t> found;
    for (const VideoRecord& video : FindVideosByName(videos, name)) found.push_back(video.id);
    return found;
  };
  EXPECT_THAT(ids("a.mp4"), ElementsAre(1));
  EXPECT_THAT(ids("./a.mp4"), ElementsAre(1, 2, 4));
  EXPECT_THAT(ids("flight/a.mp4"), ElementsAre(2));
  EXPECT_THAT(ids("/data/other/a.mp4"), ElementsAre(4));
  EXPECT_THAT(ids("frames"), ElementsAre(3));
  EXPECT_THAT(ids("rtsp://camera/live"), ElementsAre(5));
  EXPECT_THAT(ids("rtsp://camera/two"), ElementsAre(6)) << "as it is shown";
  EXPECT_THAT(ids("rtsp://ann:secret@camera/two"), ElementsAre(6));
  EXPECT_TRUE(ids(".mp4").empty());
  EXPECT_TRUE(ids("light/a.mp4").empty());
  EXPECT_TRUE(ids("").empty());
}

class VideosTest : public ::testing::TestWithParam<testing::StoreKind> {
 protected:
  void SetUp() override {
    VICTORIOUS_STORE_OR_SKIP(name_, GetParam().make(folder_.path()));
    Reopen();
  }

  void Reopen() {
    store_.reset();
    auto store = OpenStore(name_, StoreMode::kCreate);
    ASSERT_TRUE(store) << store.error().message;
    store_ = *std::move(store);
  }

  VideoRecord PutVideo(const std::string& content_id, const std::string& name, const std::string& folder = "") {
    const auto video =
        store_->PutVideo({.content_id = content_id, .name = name, .folder = folder, .width = 640, .height = 480});
    EXPECT_TRUE(video) << video.error().message;
    return video.value_or(VideoRecord{});
  }

  std::vector<std::string> ContentIds() const {
    std::vector<std::string> ids;
    const auto videos = store_->Videos().value();
    for (const VideoRecord& video : videos) ids.push_back(video.content_id);
    return ids;
  }

  testing::ScratchFolder folder_;
  std::string name_;
  std::unique_ptr<IndexStore> store_;
};

// Names of files and texts of users can be any bytes.
TEST_P(VideosTest, CoveredTimesGrowByTheirFirstFrame) {
  const VideoRecord video = PutVideo("c1", "a.mp4");
  const VideoRecord other = PutVideo("c2", "b.mp4");
  const auto cover = [&](const CoveredTime& covered) {
    IndexBatch batch;
    batch.covered = {covered};
    ASSERT_TRUE(store_->Commit(batch));
  };
  cover({video.id, 0, "udp://a", 5'000'000, 6'000'000});
  cover({other.id, 0, "udp://a", 1'000'000, 2'000'000});
  cover({other.id, 9, "udp://b", 3'000'000, 4'000'000});
  cover({video.id, 0, "udp://a", 4'900'000, 8'000'000});
  Reopen();
  EXPECT_THAT(*store_->CoveredTimes("udp://a"), ElementsAre(CoveredTime{other.id, 0, "udp://a", 1'000'000, 2'000'000},
                                                            CoveredTime{video.id, 0, "udp://a", 4'900'000, 8'000'000}));
  EXPECT_TRUE(store_->CoveredTimes("udp://c")->empty());
}

TEST_P(VideosTest, PartsOfASearchGrowAndGoWithIt) {
  const VideoRecord video = PutVideo("c1", "a.mp4");
  const std::int64_t model = store_->PutModel({.name = "m", .content_id = "1", .kind = ModelKind::kCad})->id;
  const auto commit = [&](std::int64_t before, std::int64_t next, const std::vector<SearchPart>& parts) {
    IndexBatch batch;
    batch.progress.push_back({.search = {.video = video.id,
                                         .model = model,
                                         .next_frame = next,
                                         .finished = false,
                                         .options_json = "{}",
                                         .program_version = "1"},
                              .expected_next_frame = before});
    batch.parts = parts;
    const auto done = store_->Commit(batch);
    ASSERT_TRUE(done) << done.error().message;
  };
  const SearchPart first{video.id, model, SearchPartKind::kSearched, 0, 10, 0, 0.9};
  const SearchPart grown{video.id, model, SearchPartKind::kSearched, 0, 20, 0, 1.9};
  const SearchPart damaged{video.id, model, SearchPartKind::kDamaged, 20, 20, 1.9, 5};
  const SearchPart thinned{video.id, model, SearchPartKind::kThinned, 20, 30, 5, 5.9};
  commit(0, 10, {first});
  EXPECT_THAT(*store_->SearchParts(video.id), ElementsAre(first));
  commit(10, 30, {grown, damaged, thinned});
  Reopen();
  EXPECT_THAT(*store_->SearchParts(video.id), ElementsAre(grown, damaged, thinned));
  EXPECT_THAT(*store_->SearchParts(video.id + 1), IsEmpty());
  ASSERT_TRUE(store_->DeleteSearch(video.id, model));
  EXPECT_THAT(*store_->SearchParts(video.id), IsEmpty());
}

TEST_P(VideosTest, TextsRoundTripByteForByte) {
  using namespace std::string_literals;
  const std::string name = "/data/\xFF\xC3(\0 \xED\xA0\x80 \xF4\x8F\xBC\x80 Übung.mp4"s;
  const VideoRecord video = PutVideo("c2", name, name);
  EXPECT_EQ(video.name, name);
  EXPECT_EQ(video.folder, name);
  EXPECT_EQ(store_->VideosNamed(name)->size(), 1U);
  EXPECT_TRUE(store_->VideosNamed("Übung.mp4")->empty());
  const ModelRecord model =
      store_->PutModel({.name = name, .content_id = "m2", .kind = ModelKind::kPhotos}).value_or(ModelRecord{});
  EXPECT_EQ(model.name, name);
  IndexBatch batch;
  batch.tracklets.push_back({std::nullopt, {.video = video.id, .model = model.id, .score = 0.5, .frames = 1}});
  batch.sightings.push_back({0, {.box = {1, 2, 30, 40}, .outline = {{1, 2}, {31, 2}, {31, 42}}, .score = 0.5}});
  const auto ids = store_->Commit(batch);
  ASSERT_TRUE(ids) << ids.error().message;
  ASSERT_TRUE(store_->PutReview(ids->front(), {Verdict::kAccepted, name, 10, name}));
  Reopen();
  EXPECT_EQ(store_->Videos()->back().name, name);
  EXPECT_EQ(store_->Videos()->back().folder, name);
  EXPECT_EQ(store_->Models()->back().name, name);
  EXPECT_EQ(store_->Reviews()->front().review.note, name);
  EXPECT_EQ(store_->Reviews()->front().review.reviewer, name);
  EXPECT_EQ(*store_->DeleteOtherContent(name, name, "c2"), 0);
  EXPECT_EQ(*store_->DeleteOtherContent(name, name, "c3"), 1);
}

class DeletionTest : public VideosTest {
 protected:
  // A tracklet of one sighting, which is an object by itself.
  std::int64_t Find(std::int64_t video, std::int64_t model) {
    IndexBatch batch;
    batch.tracklets.push_back({std::nullopt, {.video = video, .model = model, .score = 0.5, .frames = 1}});
    batch.sightings.push_back({0, {.box = {1, 2, 30, 40}, .outline = {{1, 2}, {31, 2}, {31, 42}}, .score = 0.5}});
    batch.progress.push_back({.search = {.video = video, .model = model, .next_frame = 1, .options_json = "{}"}});
    return store_->Commit(batch).value().front();
  }
  [[nodiscard]] std::vector<std::int64_t> ObjectIds() {
    std::vector<std::int64_t> ids;
    const auto objects = store_->Objects({.include_rejected = true}).value();
    for (const ObjectRecord& object : objects) ids.push_back(object.id);
    return ids;
  }
};

TEST_P(DeletionTest, AVideoGoesWithWhatOnlyItShows) {
  const std::int64_t kept = PutVideo("c1", "a.mp4").id;
  const std::int64_t gone = PutVideo("c2", "b.mp4").id;
  const std::int64_t model =
      store_->PutModel({.name = "jeep", .content_id = "m", .kind = ModelKind::kPhotos}).value().id;
  const std::int64_t stays = Find(kept, model);
  const std::int64_t goes = Find(gone, model);
  ASSERT_TRUE(store_->PutReview(goes, {Verdict::kAccepted, "", 10, "ann"}));
  ASSERT_TRUE(store_->DeleteVideo(gone));
  EXPECT_THAT(ContentIds(), ElementsAre("c1"));
  EXPECT_THAT(ObjectIds(), ElementsAre(stays));
  EXPECT_THAT(store_->Reviews().value(), IsEmpty());
  EXPECT_FALSE(*store_->FindSearch(gone, model));
  EXPECT_THAT(store_->FindFaults().value(), IsEmpty());
  const Status again = store_->DeleteVideo(gone);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::kNotFound);
}

TEST_P(DeletionTest, AModelGoesWithItsObjectsInAllVideos) {
  const std::int64_t video = PutVideo("c1", "a.mp4").id;
  const std::int64_t kept = store_->PutModel({.name = "jeep", .content_id = "m", .kind = ModelKind::kPhotos})->id;
  const std::int64_t gone = store_->PutModel({.name = "wrong", .content_id = "w", .kind = ModelKind::kPhotos})->id;
  const std::int64_t stays = Find(video, kept);
  Find(video, gone);
  ASSERT_TRUE(store_->DeleteModel(gone));
  EXPECT_EQ(store_->Models()->size(), 1U);
  EXPECT_THAT(ObjectIds(), ElementsAre(stays));
  EXPECT_EQ(store_->Searches()->size(), 1U);
  EXPECT_FALSE(store_->DeleteModel(gone));
}

// The telemetry file that was given last is that of the next search.
TEST_P(VideosTest, RemembersTheTelemetryThatWasGiven) {
  const VideoRecord video{.content_id = "c1", .name = "a.mp4", .telemetry = "/data/Übung.csv"};
  EXPECT_FALSE(*store_->VideoOfContent("c1"));
  EXPECT_EQ(store_->PutVideo(video)->telemetry, "/data/Übung.csv");
  EXPECT_EQ(PutVideo("c2", "b.mp4").telemetry, "");
  EXPECT_EQ(PutVideo("c1", "c.mp4").telemetry, "/data/Übung.csv") << "none was given";
  Reopen();
  EXPECT_EQ((*store_->VideoOfContent("c1"))->telemetry, "/data/Übung.csv");
  EXPECT_EQ((*store_->VideoOfContent("c2"))->telemetry, "");
  EXPECT_EQ(store_->PutVideo({.content_id = "c1", .name = "c.mp4", .telemetry = "/data/b.csv"})->telemetry,
            "/data/b.csv");
  EXPECT_EQ(store_->Videos()->front().telemetry, "/data/b.csv");
}

TEST_P(VideosTest, LongOptionsRoundTrip) {
  std::string json(100'000, ' ');
  for (std::size_t i = 0; i < json.size(); ++i) json[i] = static_cast<char>('a' + i * i % 23);
  ASSERT_TRUE(store_->SetVideoFeatures(PutVideo("c1", "a.mp4").id, json));
  ASSERT_TRUE(store_->SetVideoFeatures(PutVideo("c2", "b.mp4").id, json));
  EXPECT_EQ(store_->Videos()->front().features_json, json);
  EXPECT_EQ(store_->Videos()->back().features_json, json);
}

// A video that moved keeps its row; one of the same name in another folder is another video.
TEST_P(VideosTest, FolderDistinguishesVideosOfOneName) {
  PutVideo("c1", "a.mp4", "/data/monday");
  PutVideo("c2", "a.mp4", "/data/tuesday");
  PutVideo("c3", "a.mp4");
  EXPECT_EQ(*store_->DeleteOtherContent("a.mp4", "/data/tuesday", "c4"), 2) << "of the folder, and of an unknown one";
  EXPECT_THAT(ContentIds(), ElementsAre("c1"));
  EXPECT_EQ(PutVideo("c1", "a.mp4", "/data/archive").folder, "/data/archive");
  EXPECT_EQ(store_->Videos()->front().folder, "/data/archive");
  EXPECT_EQ(*store_->DeleteOtherContent("a.mp4", "/data/monday", "c4"), 0);
}

TEST_P(VideosTest, SoundIndexHasNoFaults) {
  EXPECT_THAT(store_->FindFaults().value(), IsEmpty());
  PutVideo("c1", "a.mp4");
  EXPECT_THAT(store_->FindFaults().value(), IsEmpty());
}

VICTORIOUS_TEST_ON_ALL_STORES(VideosTest);
VICTORIOUS_TEST_ON_ALL_STORES(DeletionTest);

}  // namespace
}  // namespace victorious
