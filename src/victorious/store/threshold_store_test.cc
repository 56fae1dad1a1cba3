// The contract of ThresholdStore, and what its thresholds make of queries (triage_store.h), tested for every
// implementation.
#include "victorious/store/threshold_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/scratch_postgres.h"
#include "victorious/store/account_store.h"
#include "victorious/store/open_store.h"
#include "victorious/store/triage_store.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;
using ::testing::UnorderedElementsAreArray;

class ThresholdStoreTest : public ::testing::TestWithParam<testing::StoreKind> {
 protected:
  void SetUp() override {
    VICTORIOUS_STORE_OR_SKIP(name_, GetParam().make(folder_.path()));
    writer_ = OpenStore(name_, StoreMode::kCreate).value();
    video_ = writer_->PutVideo({.content_id = "a", .name = "a.mp4", .width = 640, .height = 480})->id;
    for (const char* name : {"jeep", "crane"}) {
      models_.push_back(writer_->PutModel({.name = name, .content_id = name, .kind = ModelKind::kCad})->id);
    }
    store_ = OpenThresholdStore(name_, StoreMode::kCreate).value();
  }

  std::int64_t AddObject(std::int64_t model, double score) {
    IndexBatch batch;
    batch.tracklets.push_back({std::nullopt, {.video = video_, .model = model, .score = score, .frames = 1}});
    batch.sightings.push_back({0, {.frame = frame_++, .box = {10, 10, 20, 20}, .score = score, .matches = 9}});
    return writer_->Commit(batch)->front();
  }

  testing::ScratchFolder folder_;
  std::string name_;
  std::unique_ptr<IndexStore> writer_;
  std::unique_ptr<ThresholdStore> store_;
  std::int64_t video_ = 0;
  std::int64_t frame_ = 0;
  std::vector<std::int64_t> models_;
};

TEST_P(ThresholdStoreTest, KeepsOneThresholdForEachModel) {
  EXPECT_THAT(store_->Thresholds().value(), IsEmpty());
  ASSERT_TRUE(store_->Put({.model = "jeep", .min_score = 0.5, .set_by = "ann", .set_utc_us = 1}));
  ASSERT_TRUE(store_->Put({.model = "crane", .min_score = 0.25, .set_by = "", .set_utc_us = 2}));
  ASSERT_TRUE(store_->Put({.model = "jeep", .min_score = 0.75, .set_by = "bob", .set_utc_us = 3}));
  const auto other = OpenThresholdStore(name_, StoreMode::kRead).value();
  const auto found = other->Thresholds().value();
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_EQ(found[0].model, "crane");
  EXPECT_EQ(found[1].min_score, 0.75);
  EXPECT_EQ(found[1].set_by, "bob");
  EXPECT_EQ(found[1].set_utc_us, 3);
  ASSERT_TRUE(store_->Remove("jeep", "ann", 4));
  ASSERT_TRUE(store_->Remove("tank", "ann", 5)) << "one that is not there";
  EXPECT_THAT(other->Thresholds().value(), SizeIs(1));
  const auto log = OpenAccountStore(name_, StoreMode::kRead).value()->Audit(10, std::nullopt).value();
  ASSERT_THAT(log, SizeIs(4));
  EXPECT_EQ(log[0].action, "threshold");
  EXPECT_EQ(log[0].subject, "model jeep");
  EXPECT_EQ(log[0].detail, R"({"min_score":null})");
  EXPECT_EQ(log[1].detail, R"({"min_score":0.75})");
  EXPECT_EQ(log[1].actor, "bob");
  EXPECT_FALSE(other->Put({.model = "jeep"})) << "opened for reading";
}

TEST_P(ThresholdStoreTest, WeakFindsAreOfModelsAndUndecided) {
  const std::int64_t category =
      writer_->PutModel({.name = "car", .content_id = "car", .kind = ModelKind::kCategory})->id;
  const std::int64_t strong = AddObject(models_[0], 0.9);
  const std::int64_t weak = AddObject(models_[0], 0.9);
  const std::int64_t accepted = AddObject(models_[1], 0.9);
  const std::int64_t car = AddObject(category, 0.3);
  std::vector<ObjectRecord> objects;
  const auto score = [&](std::int64_t id, std::int64_t model, double by_all) {
    objects.push_back({.id = id, .model = model, .object_score = by_all});
    objects.back().tracklets.push_back(id);
  };
  score(strong, models_[0], kWeakScore);
  score(weak, models_[0], 0.49);
  score(accepted, models_[1], 0.1);
  ASSERT_TRUE(writer_->PutObjects(objects));
  ASSERT_TRUE(writer_->PutReview(accepted, {.verdict = Verdict::kAccepted}));
  const auto ids = [&](const SightingFilter& filter) {
    std::vector<std::int64_t> found;
    const auto matching = writer_->Objects(filter).value();
    for (const ObjectRecord& one : matching) found.push_back(one.id);
    std::vector<std::int64_t> seen;
    const auto sightings = writer_->Sightings(filter).value();
    for (const SightingRecord& one : sightings) seen.push_back(one.object);
    EXPECT_THAT(seen, UnorderedElementsAreArray(found));
    return found;
  };
  EXPECT_THAT(ids({}), UnorderedElementsAre(strong, weak, accepted, car));
  EXPECT_THAT(ids({.without_weak = true}), UnorderedElementsAre(strong, accepted, car));
  // A rejected one is left out for that; who asks for it gets it, however weak it is.
  objects[1].rejected = "at the place of another";
  ASSERT_TRUE(writer_->PutObjects(objects));
  EXPECT_THAT(ids({.without_weak = true}), UnorderedElementsAre(strong, accepted, car));
  EXPECT_THAT(ids({.include_rejected = true, .without_weak = true}), UnorderedElementsAre(strong, weak, accepted, car));
}

TEST_P(ThresholdStoreTest, ListsDecisionsOfTheTeamByModel) {
  EXPECT_THAT(store_->Decisions().value(), IsEmpty());
  const std::int64_t good = AddObject(models_[0], 0.9);
  const std::int64_t bad = AddObject(models_[0], 0.4);
  const std::int64_t noted = AddObject(models_[0], 0.7);
  const std::int64_t other = AddObject(models_[1], 0.8);
  ASSERT_TRUE(writer_->PutReview(good, {.verdict = Verdict::kAccepted, .updated_utc_us = 1}));
  ASSERT_TRUE(writer_->PutReview(bad, {.verdict = Verdict::kAccepted, .updated_utc_us = 2, .reviewer = "ann"}));
  ASSERT_TRUE(writer_->PutReview(bad, {.verdict = Verdict::kRejected, .updated_utc_us = 3, .reviewer = "bob"}));
  ASSERT_TRUE(writer_->PutReview(noted, {.note = "look again", .updated_utc_us = 4}));
  ASSERT_TRUE(writer_->PutReview(other, {.verdict = Verdict::kRejected, .updated_utc_us = 5}));
  const auto found = store_->Decisions().value();
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_EQ(found[0].model, models_[0]);
  ASSERT_THAT(found[0].decisions, SizeIs(2)) << "a note is no decision; of persons the latest counts";
  EXPECT_EQ(found[0].decisions[0].score, 0.9);
  EXPECT_TRUE(found[0].decisions[0].is_accepted);
  EXPECT_FALSE(found[0].decisions[1].is_accepted);
  ASSERT_THAT(found[1].decisions, SizeIs(1));
}

// A threshold is asked of what nobody has decided.
TEST_P(ThresholdStoreTest, ThresholdsLeaveOutUndecidedObjectsOfTheirModel) {
  const std::int64_t good = AddObject(models_[0], 0.9);
  const std::int64_t weak = AddObject(models_[0], 0.4);
  const std::int64_t accepted = AddObject(models_[0], 0.3);
  const std::int64_t other = AddObject(models_[1], 0.2);
  ASSERT_TRUE(writer_->PutReview(accepted, {.verdict = Verdict::kAccepted, .updated_utc_us = 1}));
  const auto triage = OpenTriageStore(name_).value();
  const auto listed = [&](const ObjectQuery& query) {
    std::vector<std::int64_t> ids;
    const auto objects = triage->Objects(query, {}).value();
    for (const TriageObject& one : objects) ids.push_back(one.object.id);
    EXPECT_EQ(triage->CountObjects(query).value(), std::ssize(ids));
    EXPECT_EQ(triage->Count(query)->objects, std::ssize(ids));
    return ids;
  };
  EXPECT_THAT(listed({}), ElementsAre(good, weak, accepted, other));
  EXPECT_THAT(listed({.model_min_scores = {{"jeep", 0.5}}}), ElementsAre(good, accepted, other));
  EXPECT_THAT(listed({.model_min_scores = {{"jeep", 0.4}}}), ElementsAre(good, weak, accepted, other)) << "inclusive";
  EXPECT_THAT(listed({.model_min_scores = {{"jeep", 0.95}, {"crane", 0.5}}}), ElementsAre(accepted));
  EXPECT_THAT(listed({.model_min_scores = {{"tank", 1}}}), SizeIs(4)) << "a model that the index has no more";
  const ObjectQuery thresholds{.model_min_scores = {{"jeep", 0.5}}};
  EXPECT_FALSE(thresholds.IsEmpty());
}

TEST_P(ThresholdStoreTest, ListsAndExportsApplyThoseInForceIfAsked) {
  const std::int64_t good = AddObject(models_[0], 0.9);
  const std::int64_t weak = AddObject(models_[0], 0.4);
  const std::int64_t accepted = AddObject(models_[0], 0.3);
  const std::int64_t other = AddObject(models_[1], 0.2);
  ASSERT_TRUE(writer_->PutReview(accepted, {.verdict = Verdict::kAccepted, .updated_utc_us = 1}));
  const auto listed = [&](const SightingFilter& filter) {
    std::vector<std::int64_t> ids;
    const auto objects = writer_->Objects(filter).value();
    for (const ObjectRecord& one : objects) ids.push_back(one.id);
    std::vector<std::int64_t> seen;
    const auto sightings = writer_->Sightings(filter).value();
    for (const SightingRecord& one : sightings) seen.push_back(one.object);
    EXPECT_THAT(seen, UnorderedElementsAreArray(ids)) << "each has one sighting";
    return ids;
  };
  const SightingFilter applied{.thresholds = ThresholdUse::kApplied};
  EXPECT_THAT(listed(applied), ElementsAre(good, weak, accepted, other)) << "none is in force";
  ASSERT_TRUE(store_->Put({.model = "jeep", .min_score = 0.5, .set_by = "ann", .set_utc_us = 1}));
  EXPECT_THAT(listed(applied), ElementsAre(good, accepted, other));
  EXPECT_THAT(listed({}), ElementsAre(good, weak, accepted, other)) << "by default they are ignored";
  ASSERT_TRUE(store_->Put({.model = "jeep", .min_score = 0.4, .set_by = "ann", .set_utc_us = 2}));
  EXPECT_THAT(listed(applied), ElementsAre(good, weak, accepted, other)) << "inclusive";
  ASSERT_TRUE(store_->Put({.model = "jeep", .min_score = 1, .set_by = "ann", .set_utc_us = 3}));
  EXPECT_THAT(listed({.model_name = "jeep", .thresholds = ThresholdUse::kApplied}), ElementsAre(accepted));
  ASSERT_TRUE(store_->Remove("jeep", "ann", 4));
  EXPECT_THAT(listed(applied), ElementsAre(good, weak, accepted, other));
}

VICTORIOUS_TEST_ON_ALL_STORES(ThresholdStoreTest);

}  // namespace
}  // namespace victorious
