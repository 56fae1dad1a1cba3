// The contract of TriageStore, tested for every implementation.
#include "victorious/store/triage_store.h"

#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/scratch_postgres.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/geometry/web_mercator.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// Six objects of two models in two videos. By rank: ids_[0] to ids_[5]; ids_[2] and ids_[3] have the same score.
class TriageStoreTest : public ::testing::TestWithParam<testing::StoreKind> {
 protected:
  void SetUp() override {
    VICTORIOUS_STORE_OR_SKIP(name_, GetParam().make(folder_.path()));
    auto writer = OpenStore(name_, StoreMode::kCreate);
    ASSERT_TRUE(writer) << writer.error().message;
    writer_ = *std::move(writer);
    for (const char* name : {"a.mp4", "b.mp4"}) {
      videos_.push_back(writer_->PutVideo({.content_id = name, .name = name, .width = 640, .height = 480})->id);
    }
    for (const char* name : {"jeep", "Crane"}) {
      models_.push_back(writer_->PutModel({.name = name, .content_id = name, .kind = ModelKind::kCad})->id);
    }
    const double scores[] = {0.95, 0.9, 0.8, 0.8, 0.5, 0.1};
    const int frames[] = {2, 2, 3, 2, 2, 2};
    for (int i = 0; i < 6; ++i) ids_.push_back(Commit(videos_[i % 2], models_[i / 4], scores[i], frames[i], i));
    auto store = OpenTriageStore(name_);
    ASSERT_TRUE(store) << store.error().message;
    store_ = *std::move(store);
  }

  // One tracklet with sightings from frame 10 * `at` on, at as many seconds.
  std::int64_t Commit(std::int64_t video, std::int64_t model, double score, int frames, int at) {
    IndexBatch batch;
    batch.tracklets.push_back({std::nullopt,
                               {.video = video,
                                .model = model,
                                .score = score,
                                .frames = frames,
                                .first_time_s = 1.0 * at,
                                .last_time_s = at + 0.5}});
    for (int i = 0; i < frames; ++i) {
      batch.sightings.push_back({0,
                                 {.frame = 10 * at + i,
                                  .time_s = at + 0.1 * i,
                                  .box = {10, 10, 20, 20},
                                  .score = score,
                                  .matches = i == 1 ? 30 : 20}});
    }
    const auto ids = writer_->Commit(batch);
    EXPECT_TRUE(ids) << ids.error().message;
    return ids->front();
  }

  void PutPlace(std::int64_t object, double latitude_deg, double longitude_deg, std::string rejected = "") {
    Geolocation place{.point = {RadiansFromDegrees(latitude_deg), RadiansFromDegrees(longitude_deg), 40}};
    std::vector<ObjectRecord> records;
    const auto present = writer_->Objects({.include_rejected = true});
    ASSERT_TRUE(present) << present.error().message;
    for (const ObjectRecord& one : *present) {
      records.push_back(one);
      if (one.id != object) continue;
      records.back().place = place;
      records.back().rejected = rejected;
    }
    ASSERT_TRUE(writer_->PutObjects(records));
  }

  std::vector<std::int64_t> List(const ObjectQuery& query, const ObjectSlice& slice = {}) {
    std::vector<std::int64_t> ids;
    const auto objects = store_->Objects(query, slice);
    EXPECT_TRUE(objects) << objects.error().message;
    for (const TriageObject& one : *objects) ids.push_back(one.object.id);
    return ids;
  }

  testing::ScratchFolder folder_;
  std::string name_;
  std::unique_ptr<IndexStore> writer_;
  std::unique_ptr<TriageStore> store_;
  std::vector<std::int64_t> videos_;
  std::vector<std::int64_t> models_;
  std::vector<std::int64_t> ids_;
};

// What is read at one moment does not change, and hinders no writer.
TEST_P(TriageStoreTest, ReadsAtOneMoment) {
  const Status read = store_->AtOneMoment([&]() -> Status {
    EXPECT_THAT(*store_->Objects({}, {.limit = 3}), SizeIs(3));
    EXPECT_TRUE(writer_->DeleteVideo(videos_[0]));
    Commit(videos_[1], models_[0], 0.99, 2, 9);
    EXPECT_EQ(*store_->CountObjects({}), 6);
    EXPECT_THAT(*store_->Objects({}, {}), SizeIs(6));
    EXPECT_THAT(*store_->Videos(), SizeIs(2));
    EXPECT_THAT(*store_->Models(), SizeIs(2));
    return {};
  });
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(*store_->CountObjects({}), 4);
  EXPECT_THAT(*store_->Videos(), SizeIs(1));
  const Status failed = store_->AtOneMoment([] { return Fail(ErrorCode::kCancelled, "enough"); });
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kCancelled);
  EXPECT_EQ(*store_->CountObjects({}), 4);
}

TEST_P(TriageStoreTest, ListsWhatTheIndexStoreLists) {
  const auto expected = writer_->Objects({});
  const auto listed = store_->Objects({}, {});
  ASSERT_TRUE(listed) << listed.error().message;
  ASSERT_EQ(listed->size(), expected->size());
  for (std::size_t i = 0; i < expected->size(); ++i) {
    const ObjectRecord& a = (*expected)[i];
    const ObjectRecord& b = (*listed)[i].object;
    EXPECT_EQ(a.id, b.id) << i;
    EXPECT_EQ(std::tie(a.model, a.score, a.frames, a.first_time_s, a.last_time_s),
              std::tie(b.model, b.score, b.frames, b.first_time_s, b.last_time_s));
    ASSERT_THAT((*listed)[i].moments, SizeIs(1));
    EXPECT_EQ((*listed)[i].moments[0].video, a.videos[0]);
  }
}

TEST_P(TriageStoreTest, ListsByTheScoresOfObjects) {
  std::vector<ObjectRecord> objects = *writer_->Objects({});
  for (std::size_t i = 0; i < objects.size(); ++i) objects[i].object_score = 0.1 + 0.1 * static_cast<double>(i);
  objects.front().against = {"size 12 % off"};
  ASSERT_TRUE(writer_->PutObjects(objects));
  const auto listed = store_->Objects({}, {});
  ASSERT_TRUE(listed) << listed.error().message;
  EXPECT_EQ(listed->front().object.id, objects.back().id);
  EXPECT_EQ(listed->back().object.id, objects.front().id);
  EXPECT_EQ(listed->back().object.score, 0.1);
  EXPECT_EQ(listed->back().object.against, objects.front().against);
  // A tracklet that grows keeps the score until data association runs again.
  IndexBatch grown;
  const std::int64_t first = objects.front().tracklets.front();
  const std::vector<TrackletRecord> tracklets = *writer_->Tracklets();
  TrackletRecord record = *std::ranges::find(tracklets, first, &TrackletRecord::id);
  record.score = 0.999;
  grown.tracklets.push_back({first, record});
  ASSERT_TRUE(writer_->Commit(grown));
  EXPECT_EQ(store_->Objects({}, {})->back().object.score, 0.1);
}

TEST_P(TriageStoreTest, SummaryFollowsTracklets) {
  // A tracklet grows, is joined to another object, and is deleted.
  IndexBatch grown;
  grown.tracklets.push_back(
      {ids_[5],
       {.video = videos_[1], .model = models_[1], .score = 0.99, .frames = 7, .first_time_s = 5, .last_time_s = 9}});
  ASSERT_TRUE(writer_->Commit(grown));
  EXPECT_EQ(List({}).front(), ids_[5]);
  const std::vector<ObjectRecord> joined = {{.id = ids_[4], .model = models_[1], .tracklets = {ids_[4], ids_[5]}}};
  ASSERT_TRUE(writer_->PutObjects(joined));
  auto listed = store_->Objects({}, {.limit = 1});
  ASSERT_THAT(*listed, SizeIs(1));
  EXPECT_EQ(listed->front().object.id, ids_[4]);
  EXPECT_EQ(listed->front().object.frames, 9);
  EXPECT_EQ(listed->front().object.first_time_s, 4);
  EXPECT_EQ(listed->front().object.last_time_s, 9);
  EXPECT_THAT(listed->front().moments, SizeIs(2));
  ASSERT_TRUE(writer_->DeleteSearch(videos_[1], models_[1]));
  listed = store_->Objects({}, {});
  EXPECT_EQ(listed->back().object.id, ids_[4]);
  EXPECT_EQ(listed->back().object.score, 0.5);
  ASSERT_TRUE(writer_->DeleteSearch(videos_[0], models_[1]));
  EXPECT_THAT(List({}), ElementsAre(ids_[0], ids_[1], ids_[2], ids_[3])) << "without tracklets it is not listed";
}

TEST_P(TriageStoreTest, KeysWalkTheListBothWays) {
  for (const ObjectOrder order : {ObjectOrder::kRank, ObjectOrder::kQueue, ObjectOrder::kNewest}) {
    ASSERT_TRUE(writer_->PutReview(ids_[1], {Verdict::kAccepted, "", 10}));
    ASSERT_TRUE(writer_->PutReview(ids_[3], {Verdict::kRejected, "", 10}));
    const ObjectSlice all{.order = order, .queue_utc_us = 50};
    const std::vector<std::int64_t> whole = List({}, all);
    ASSERT_THAT(whole, SizeIs(6));
    if (order == ObjectOrder::kQueue) {
      EXPECT_THAT(whole, ElementsAre(ids_[0], ids_[2], ids_[4], ids_[5], ids_[1], ids_[3]));
    }
    if (order == ObjectOrder::kNewest) {
      EXPECT_EQ(whole.front(), ids_[5]);
    }
    for (std::size_t i = 0; i < whole.size(); ++i) {
      const auto key = store_->FindKey(whole[i], all);
      ASSERT_TRUE(key && *key);
      EXPECT_EQ(*store_->CountBefore({}, all, **key), static_cast<std::int64_t>(i));
      ObjectSlice after = all;
      after.after = *key;
      const auto at = whole.begin() + static_cast<std::ptrdiff_t>(i);
      EXPECT_EQ(List({}, after), std::vector(at + 1, whole.end()));
      ObjectSlice before = all;
      before.before = *key;
      EXPECT_EQ(List({}, before), std::vector(std::reverse_iterator(at), whole.rend()));
      ObjectSlice from = all;
      from.offset = static_cast<std::int64_t>(i);
      from.limit = 2;
      EXPECT_EQ(List({}, from), std::vector(at, std::min(at + 2, whole.end())));
    }
  }
  EXPECT_FALSE(*store_->FindKey(12345, {}));
}

// What is reviewed while the queue is worked off keeps its place in it.
TEST_P(TriageStoreTest, QueueStaysWhileItIsWorkedOff) {
  ASSERT_TRUE(writer_->PutReview(ids_[0], {Verdict::kAccepted, "", 100}));
  const ObjectSlice before{.order = ObjectOrder::kQueue, .queue_utc_us = 50};
  const ObjectSlice later{.order = ObjectOrder::kQueue, .queue_utc_us = 150};
  EXPECT_EQ(List({}, before).front(), ids_[0]);
  EXPECT_EQ(List({}, later).back(), ids_[0]);
}

TEST_P(TriageStoreTest, FiltersSelect) {
  PutPlace(ids_[1], 52, 13);
  ASSERT_TRUE(writer_->PutReview(ids_[2], {Verdict::kAccepted, "By the Barn", 10, "ann"}));
  using State = ObjectQuery::ReviewState;
  EXPECT_THAT(List({.models = {"Crane"}}), ElementsAre(ids_[4], ids_[5]));
  EXPECT_THAT(List({.models = {"none"}}), IsEmpty());
  EXPECT_THAT(List({.video = videos_[1]}), ElementsAre(ids_[1], ids_[3], ids_[5]));
  EXPECT_THAT(List({.min_score = 0.9}), ElementsAre(ids_[0], ids_[1]));
  EXPECT_THAT(List({.from_s = 4.5, .to_s = 4.9}), ElementsAre(ids_[4]));
  EXPECT_THAT(List({.near = GeoCircle{{RadiansFromDegrees(52), RadiansFromDegrees(13.001), 0}, 100}}),
              ElementsAre(ids_[1]));
  EXPECT_THAT(List({.near = GeoCircle{{RadiansFromDegrees(52), RadiansFromDegrees(13.001), 0}, 50}}), IsEmpty());
  EXPECT_THAT(List({.words = {"crane"}}), ElementsAre(ids_[4], ids_[5])) << "letters' case is ignored";
  EXPECT_THAT(List({.words = {"BARN", "jee"}}), ElementsAre(ids_[2])) << "all words";
  EXPECT_THAT(List({.words = {"barn", "crane"}}), IsEmpty());
  EXPECT_THAT(List({.words = {"' OR 1 --"}}), IsEmpty());
  EXPECT_THAT(List({.review = State::kAccepted}), ElementsAre(ids_[2]));
  EXPECT_THAT(List({.review = State::kRejected}), IsEmpty());
  EXPECT_THAT(List({.review = State::kNone}), SizeIs(5));
  EXPECT_EQ(*store_->CountObjects({.models = {"jeep"}}), 4);
  const auto counts = store_->Count({.models = {"jeep"}});
  ASSERT_TRUE(counts) << counts.error().message;
  EXPECT_EQ(std::tuple(counts->objects, counts->accepted, counts->rejected), std::tuple(4, 1, 0));
  EXPECT_EQ(counts->scores[80], 2);
  EXPECT_EQ(counts->scores[95], 1);
}

TEST_P(TriageStoreTest, ScoresAreCountedByVerdict) {
  ASSERT_TRUE(writer_->PutReview(ids_[2], {Verdict::kAccepted, "", 10, "ann"}));
  ASSERT_TRUE(writer_->PutReview(ids_[5], {Verdict::kRejected, "", 11, "ann"}));
  const auto counts = store_->Count({});
  ASSERT_TRUE(counts) << counts.error().message;
  const auto at = [&](int bin) {
    return std::tuple(counts->scores[bin], counts->accepted_scores[bin], counts->rejected_scores[bin]);
  };
  EXPECT_EQ(at(80), std::tuple(2, 1, 0));
  EXPECT_EQ(at(10), std::tuple(1, 0, 1));
  EXPECT_EQ(at(95), std::tuple(1, 0, 0));
  const auto rare = store_->Count({.models = {"crane"}});
  ASSERT_TRUE(rare) << rare.error().message;
  EXPECT_EQ(rare->accepted_scores[80], 0) << "filters hold for verdicts, too";
}

TEST_P(TriageStoreTest, DecisionsOfPersonsSelect) {
  ASSERT_TRUE(writer_->PutReview(ids_[0], {Verdict::kAccepted, "", 10, "ann"}));
  ASSERT_TRUE(writer_->PutReview(ids_[1], {Verdict::kAccepted, "", 11, "ann"}));
  ASSERT_TRUE(writer_->PutReview(ids_[1], {Verdict::kRejected, "no", 12, "bob"}));
  ASSERT_TRUE(writer_->PutReview(ids_[2], {Verdict::kRejected, "", 13, "bob"}));
  ASSERT_TRUE(writer_->PutReview(ids_[3], {std::nullopt, "a note only", 14, "bob"}));
  const auto of = [&](ObjectQuery::ReviewState state, const char* reviewer) {
    return List({.review = state, .reviewer = reviewer});
  };
  using State = ObjectQuery::ReviewState;
  EXPECT_THAT(of(State::kOwn, "ann"), ElementsAre(ids_[0], ids_[1]));
  EXPECT_THAT(of(State::kOwn, "bob"), ElementsAre(ids_[1], ids_[2]));
  EXPECT_THAT(of(State::kOwn, ""), IsEmpty());
  EXPECT_THAT(of(State::kNotOwn, "ann"), ElementsAre(ids_[2], ids_[3], ids_[4], ids_[5]));
  EXPECT_THAT(of(State::kNotOwn, "bob"), ElementsAre(ids_[0], ids_[3], ids_[4], ids_[5])) << "a note decides nothing";
  EXPECT_THAT(of(State::kDisputed, ""), ElementsAre(ids_[1]));
  EXPECT_EQ(store_->Count({.review = State::kDisputed})->objects, 1);
  const auto rows = store_->ObjectsById(ids_);
  ASSERT_TRUE(rows) << rows.error().message;
  const TriageObject& disputed = *std::ranges::find(*rows, ids_[1], [](const auto& one) { return one.object.id; });
  EXPECT_TRUE(disputed.is_disputed);
  EXPECT_EQ(disputed.review.verdict, Verdict::kRejected) << "the latest";
  ASSERT_THAT(disputed.decisions, SizeIs(2));
  EXPECT_EQ(disputed.decisions.front().reviewer, "bob");
  EXPECT_EQ(disputed.decisions.front().note, "no");
  // They agree again.
  ASSERT_TRUE(writer_->PutReview(ids_[1], {Verdict::kAccepted, "", 20, "bob"}));
  EXPECT_THAT(of(State::kDisputed, ""), IsEmpty());
}

TEST_P(TriageStoreTest, RowsHaveTheLatestDecisionsOnly) {
  for (int i = 0; i < 2 * TriageObject::kMaxDecisions; ++i) {
    ASSERT_TRUE(writer_->PutReview(ids_[0], {Verdict::kAccepted, "", i, "person " + std::to_string(i)}));
  }
  const auto rows = store_->ObjectsById({&ids_[0], 1});
  ASSERT_THAT(rows->front().decisions, SizeIs(TriageObject::kMaxDecisions));
  EXPECT_EQ(rows->front().decisions.front().reviewer, "person 19");
  EXPECT_THAT(*writer_->Decisions(ids_[0]), SizeIs(2 * TriageObject::kMaxDecisions));
}

TEST_P(TriageStoreTest, AreasSelect) {
  PutPlace(ids_[0], 52, 13);
  PutPlace(ids_[1], 52, 13.002);
  PutPlace(ids_[4], 52, 13.001);
  PutPlace(ids_[2], -10, 179.9999);
  PutPlace(ids_[3], -10, -179.9999);
  const auto in = [&](std::initializer_list<std::pair<double, double>> corners) {
    GeoPolygon area;
    for (const auto& [latitude, longitude] : corners) {
      area.corners.push_back({RadiansFromDegrees(latitude), RadiansFromDegrees(longitude), 0});
    }
    return List({.area = area});
  };
  EXPECT_THAT(in({{51.999, 12.999}, {52.001, 12.999}, {52.001, 13.001}, {51.999, 13.001}}), ElementsAre(ids_[0]));
  EXPECT_THAT(in({{51.999, 12.999}, {51.999, 13.003}, {52.001, 13.003}, {52.001, 12.999}}),
              ElementsAre(ids_[0], ids_[1], ids_[4]))
      << "either orientation";
  EXPECT_THAT(in({{51.999, 12.999},
                  {52.001, 12.999},
                  {52.001, 13.0005},
                  {51.9995, 13.001},
                  {52.001, 13.0015},
                  {52.001, 13.003},
                  {51.999, 13.003}}),
              ElementsAre(ids_[0], ids_[1]))
      << "the notch leaves one out";
  EXPECT_THAT(in({{52.0005, 12.999}, {52.001, 12.999}, {52.001, 13.001}}), IsEmpty());
  EXPECT_THAT(in({{-11, 179.999}, {-9, 179.999}, {-9, -179.999}, {-11, -179.999}}), ElementsAre(ids_[2], ids_[3]))
      << "across the antimeridian";
  EXPECT_EQ(*store_->CountObjects({.area = GeoPolygon{{{0.9, 0.22, 0}, {0.92, 0.22, 0}, {0.91, 0.24, 0}}}}), 3);
}

// Agreement: circles with the distance in a tangent plane, areas with the angle that their border turns around a place.
TEST_P(TriageStoreTest, RegionsSelectWhatGeometrySays) {
  Random random(7);
  const auto draw = [&](const GeodeticPoint& around, double side_rad) {
    return GeodeticPoint{around.latitude_rad + random.Uniform(-side_rad, side_rad),
                         std::remainder(around.longitude_rad + random.Uniform(-side_rad, side_rad), 2 * kPi), 0};
  };
  int selected = 0;
  for (const GeodeticPoint& town : {GeodeticPoint{0.9, 0.2, 0}, GeodeticPoint{-0.4, kPi - 1e-4, 0},
                                    GeodeticPoint{0.001, -2, 0}, GeodeticPoint{-1.2, -kPi + 1e-4, 0}}) {
    constexpr double kSide_rad = 5e-4;  // 3 km
    std::map<std::int64_t, GeodeticPoint> places;
    auto objects = *writer_->Objects({.include_rejected = true});
    for (ObjectRecord& object : objects) {
      object.place = Geolocation{.point = draw(town, kSide_rad)};
      places[object.id] = object.place->point;
    }
    ASSERT_TRUE(writer_->PutObjects(objects));
    for (int trial = 0; trial < 40; ++trial) {
      GeoCircle circle{draw(town, kSide_rad), random.Uniform(100, 4000)};
      circle.centre.altitude_m = random.Uniform(-100, 3000);
      GeoPolygon area;
      for (int i = 0; i < 3 + trial % 5; ++i) area.corners.push_back(draw(town, kSide_rad));
      std::vector<std::int64_t> within;
      std::vector<std::int64_t> inside;
      for (const std::int64_t id : ids_) {  // by rank
        GeodeticPoint point = places.at(id);
        double turns = 0;
        for (std::size_t i = 0; i < area.corners.size(); ++i) {
          const auto angle = [&](const GeodeticPoint& corner) {
            return std::atan2(corner.latitude_rad - point.latitude_rad,
                              std::remainder(corner.longitude_rad - point.longitude_rad, 2 * kPi));
          };
          const double turn = angle(area.corners[i]) - angle(area.corners[(i + 1) % area.corners.size()]);
          turns += std::remainder(turn, 2 * kPi) / (2 * kPi);
        }
        if (std::llround(turns) % 2 != 0) inside.push_back(id);
        point.altitude_m = circle.centre.altitude_m;
        if (TangentPlane(circle.centre).EnuFromGeodetic(point).norm() <= circle.radius_m) within.push_back(id);
      }
      selected += static_cast<int>(within.size() + inside.size());
      EXPECT_EQ(List({.near = circle}), within);
      EXPECT_EQ(List({.area = area}), inside);
      std::vector<std::int64_t> exported;
      const std::vector<ObjectRecord> near = *writer_->Objects({.near = circle});
      for (const ObjectRecord& one : near) exported.push_back(one.id);
      EXPECT_EQ(exported, within);
    }
  }
  EXPECT_GT(selected, 200);
}

TEST_P(TriageStoreTest, WordsSelectByModelIdAndNote) {
  ASSERT_TRUE(writer_->PutReview(ids_[1], {std::nullopt, "At the BRIDGE 100%", 10, "ann"}));
  ASSERT_TRUE(writer_->PutReview(ids_[5], {Verdict::kAccepted, "bridge", 10, "bob"}));
  EXPECT_THAT(List({.words = {"bridge"}}), ElementsAre(ids_[1], ids_[5]));
  EXPECT_THAT(List({.words = {"100%"}}), ElementsAre(ids_[1]));
  EXPECT_THAT(List({.words = {"CRAN", "brid"}}), ElementsAre(ids_[5]));
  EXPECT_THAT(List({.words = {"tower"}}), IsEmpty());
  EXPECT_EQ(*store_->CountObjects({.words = {"bridge"}}), 2);
}

TEST_P(TriageStoreTest, CirclesCrossTheAntimeridianAndThePole) {
  PutPlace(ids_[0], 10, 179.9995);
  PutPlace(ids_[1], 89.9999, -90);
  EXPECT_THAT(List({.near = GeoCircle{{RadiansFromDegrees(10), RadiansFromDegrees(-179.9995), 0}, 200}}),
              ElementsAre(ids_[0]));
  EXPECT_THAT(List({.near = GeoCircle{{RadiansFromDegrees(89.9999), RadiansFromDegrees(90), 0}, 100}}),
              ElementsAre(ids_[1]));
}

TEST_P(TriageStoreTest, RejectedObjectsAreNotListed) {
  PutPlace(ids_[0], 52, 13, "it floats");
  EXPECT_THAT(List({}), SizeIs(5));
  EXPECT_EQ(store_->Count({})->objects, 5);
  EXPECT_THAT(*store_->ObjectsById(ids_), SizeIs(5));
  EXPECT_FALSE(*store_->FindKey(ids_[0], {}));
  EXPECT_FALSE(*store_->PlaceBounds());
  PutPlace(ids_[0], 52, 13);
  EXPECT_THAT(List({}), SizeIs(6));
}

TEST_P(TriageStoreTest, PlacesOfARegion) {
  PutPlace(ids_[0], 52, 13);
  PutPlace(ids_[1], 52.5, 14);
  const auto visit = [&](const GeoBox& region, const ObjectQuery& query) {
    std::vector<std::pair<std::int64_t, bool>> found;
    EXPECT_TRUE(store_->VisitPlaces(region, query, [&](const PlacedObject& one) {
      found.emplace_back(one.id, one.matches);
      return true;
    }));
    return found;
  };
  const auto degrees = [](double south, double west, double north, double east) {
    return GeoBox{RadiansFromDegrees(south), RadiansFromDegrees(west), RadiansFromDegrees(north),
                  RadiansFromDegrees(east)};
  };
  EXPECT_THAT(visit(degrees(51, 12, 53, 15), {.min_score = 0.92}),
              ElementsAre(std::pair(ids_[0], true), std::pair(ids_[1], false)));
  EXPECT_THAT(visit(degrees(51, 13.5, 53, 15), {}), ElementsAre(std::pair(ids_[1], true)));
  EXPECT_THAT(visit(degrees(0, 0, 1, 1), {}), IsEmpty());
  const auto bounds = store_->PlaceBounds();
  ASSERT_TRUE(bounds && *bounds);
  EXPECT_DOUBLE_EQ((*bounds)->north_rad, RadiansFromDegrees(52.5));
  EXPECT_DOUBLE_EQ((*bounds)->west_rad, RadiansFromDegrees(13));
  EXPECT_THAT(*store_->PlaceHeights(videos_[0]), ElementsAre(40.0));
  EXPECT_THAT(*store_->PlaceShapes(ids_), SizeIs(2));
}

TEST_P(TriageStoreTest, PlacesAreSummedInAGrid) {
  const std::pair<double, double> places[] = {{52, 13}, {52.001, 13.001}, {52, -13}, {-30, 13}, {52, 170}, {86, 13}};
  for (int i = 0; i < 6; ++i) PutPlace(ids_[static_cast<std::size_t>(i)], places[i].first, places[i].second);
  const auto world = store_->SumPlaces({.cells = 2}, {.min_score = 0.92});
  ASSERT_TRUE(world) << world.error().message;
  ASSERT_THAT(*world, SizeIs(3)) << "a map ends at 85 degrees";
  EXPECT_EQ(std::pair((*world)[0].column, (*world)[0].row), std::pair(0, 0));
  EXPECT_EQ((*world)[0].best, 0.8);
  EXPECT_EQ((*world)[0].matches, 0);
  const PlaceCell& east = (*world)[1];
  EXPECT_EQ(std::pair(east.column, east.row), std::pair(1, 0));
  EXPECT_EQ(east.count, 3);
  EXPECT_EQ(east.matches, 1);
  EXPECT_EQ(east.best, 0.95);
  double sum_x = 0;
  double sum_y = 0;
  for (const int i : {0, 1, 4}) {
    sum_x += MercatorEast(RadiansFromDegrees(places[i].second));
    sum_y += MercatorSouth(RadiansFromDegrees(places[i].first));
  }
  EXPECT_NEAR(east.sum_x, sum_x, 1e-12);
  EXPECT_NEAR(east.sum_y, sum_y, 1e-12);
  EXPECT_EQ(std::pair((*world)[2].column, (*world)[2].row), std::pair(1, 1));
  // The north-eastern quarter alone.
  const auto quarter = store_->SumPlaces({.west = 0.5, .north = 0, .side = 0.5, .cells = 1}, {});
  ASSERT_TRUE(quarter) << quarter.error().message;
  ASSERT_THAT(*quarter, SizeIs(1));
  EXPECT_EQ(quarter->front().count, 3);
  EXPECT_EQ(quarter->front().matches, 3);
  EXPECT_NEAR(quarter->front().sum_x, 2 * (sum_x - 1.5), 1e-12);
  EXPECT_THAT(*store_->SumPlaces({.west = 0, .north = 0.5, .side = 0.5, .cells = 4}, {}), IsEmpty());
}

TEST_P(TriageStoreTest, BestSightingHasMostMatches) {
  const auto best = store_->BestSighting(ids_[3]);
  ASSERT_TRUE(best && *best) << best.error().message;
  EXPECT_EQ((*best)->frame, 31);
  EXPECT_EQ((*best)->matches, 30);
  EXPECT_FALSE(*store_->BestSighting(4711));
}

TEST_P(TriageStoreTest, NumbersOfVideosAndModels) {
  ASSERT_THAT(*store_->ObjectsOfVideos(), SizeIs(2));
  EXPECT_EQ(store_->ObjectsOfVideos()->front().objects, 3);
  EXPECT_EQ(store_->ObjectsOfModels()->back().objects, 2);
  EXPECT_THAT(*store_->Searches(), IsEmpty());
}

TEST_P(TriageStoreTest, SaysWhichVideosMayShowAPlace) {
  const auto put = [&](const std::string& name) {
    return writer_->PutVideo({.content_id = name, .name = name, .width = 640, .height = 480})->id;
  };
  const std::int64_t unknown = put("shown-unknown");
  const std::int64_t twice = put("shown-twice");
  const std::int64_t nothing = put("shown-nothing");
  const std::vector<GeoBox> boxes = {{0.9, 0.2, 0.91, 0.21}, {0.905, 0.205, 0.92, 0.22}};
  ASSERT_TRUE(writer_->PutShownGround(twice, boxes));
  ASSERT_TRUE(writer_->PutShownGround(nothing, {}));
  const auto showing = [&](double latitude_rad, double longitude_rad) {
    std::vector<std::int64_t> ids = store_->VideosShowing(latitude_rad, longitude_rad).value();
    std::erase_if(ids, [&](std::int64_t id) { return id < unknown; });
    return ids;
  };
  EXPECT_THAT(showing(0.907, 0.207), ElementsAre(unknown, twice)) << "both boxes hold it";
  EXPECT_THAT(showing(0.919, 0.219), ElementsAre(unknown, twice));
  EXPECT_THAT(showing(0.901, 0.219), ElementsAre(unknown));
  ASSERT_TRUE(writer_->PutShownGround(twice, std::span(boxes).last(1)));
  EXPECT_THAT(showing(0.901, 0.201), ElementsAre(unknown)) << "replaced";
  EXPECT_FALSE(writer_->PutShownGround(99, boxes));
  ASSERT_EQ(*writer_->DeleteOtherContent("shown-twice", "", "other"), 1);
  EXPECT_THAT(showing(0.919, 0.219), ElementsAre(unknown)) << "deleted with its video";
}

VICTORIOUS_TEST_ON_ALL_STORES(TriageStoreTest);

}  // namespace
}  // namespace victorious
