#include "victorious/jobs/index/track_growth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/drawn_flight.h"
#include "testing/fault_injecting_store.h"
#include "victorious/jobs/index/indexer_test.h"
#include "victorious/jobs/turning_scene_test.h"

namespace victorious {
namespace {

using testing::Contents;
using ::testing::ElementsAre;
using testing::FaultInjectingStore;
using ::testing::IsEmpty;
using testing::SightingsOf;
using ::testing::SizeIs;

class TrackGrowthTest : public ::testing::Test {
 protected:
  // What recognition has found: an object in some frames.
  void Recognised(std::int64_t tracklet, const TurningScene& scene, std::size_t object, int first, int count) {
    tracklets_.push_back({.id = tracklet,
                          .score = kScore,
                          .frames = count,
                          .first_time_s = frame_s_ * first,
                          .last_time_s = frame_s_ * (first + count - 1)});
    for (int frame = first; frame < first + count; ++frame) {
      sightings_.push_back({.tracklet = tracklet,
                            .frame = frame,
                            .time_s = frame_s_ * frame,
                            .box = scene.BoxOf(object, frame),
                            .outline = scene.OutlineOf(object, frame),
                            .score = kScore,
                            .matches = 20});
    }
    std::ranges::stable_sort(sightings_, {}, &SightingRecord::frame);
  }

  // The tracklets given, or all.
  [[nodiscard]] GrowthInput InputOf(const ObjectModel& model, std::span<const TrackletRecord> tracklets,
                                    std::span<const SightingRecord> sightings) const {
    return {.model = model,
            .tracklets = tracklets,
            .sightings = sightings,
            .extractor = *extractor_,
            .recognize = recognize_,
            .options = options_,
            .is_plausible = is_plausible_};
  }

  [[nodiscard]] Expected<std::vector<TrackGrowth>> GrowAll(std::span<const GrowthInput> inputs,
                                                           const std::function<cv::Mat(int)>& draw,
                                                           std::int64_t max_wanted, const CancelToken& cancel = {}) {
    std::vector<double> times_s;
    for (int i = 0; i < kFrames; ++i) times_s.push_back(frame_s_ * i);
    const ReadFrames read = [&](std::int64_t first, std::int64_t end,
                                const auto& is_wanted) -> Expected<std::vector<Frame>> {
      std::vector<Frame> frames;
      for (std::int64_t i = first; i < end; ++i) {
        if (!is_wanted(i)) continue;
        read_.insert(i);
        frames.push_back(
            {.index = i, .time_s = times_s[static_cast<std::size_t>(i)], .image = draw(static_cast<int>(i))});
      }
      EXPECT_LE(std::ssize(frames), max_wanted);
      return frames;
    };
    return GrowTracks({.times_s = times_s,
                       .end = kFrames,
                       .frame = FrameBox(TurningScene::kImageWidth, TurningScene::kImageHeight),
                       .read = read,
                       .max_wanted = max_wanted},
                      inputs, cancel);
  }

  [[nodiscard]] Expected<TrackGrowth> Grow(const std::function<cv::Mat(int)>& draw, std::int64_t max_wanted = 16,
                                           const CancelToken& cancel = {}) {
    const ObjectModel model = PhotoModelOf(TurningScene());
    const GrowthInput input = InputOf(model, tracklets_, sightings_);
    VICTORIOUS_ASSIGN_OR_RETURN(std::vector<TrackGrowth> growths,
                                GrowAll(std::span(&input, 1), draw, max_wanted, cancel));
    return std::move(growths.front());
  }
  [[nodiscard]] TrackGrowth Grow(const TurningScene& scene) {
    return Grow([&](int frame) { return scene.Draw(frame); }).value();
  }

  // Frames of a tracklet whose box is that of the object, and in which it is not.
  static std::pair<int, int> Score(const TrackGrowth& growth, std::int64_t tracklet, const TurningScene& scene,
                                   std::size_t object) {
    std::pair<int, int> score;
    for (const GrownSighting& one : growth.sightings) {
      if (one.tracklet != tracklet) continue;
      const bool is_right = IntersectionOverUnion(one.box, scene.BoxOf(object, static_cast<int>(one.frame))) > 0.5;
      ++(is_right ? score.first : score.second);
    }
    return score;
  }

  static constexpr double kScore = 0.999;
  double frame_s_ = kFrame_s;
  std::vector<TrackletRecord> tracklets_;
  std::vector<SightingRecord> sightings_;
  std::set<std::int64_t> read_;
  std::unique_ptr<const FeatureExtractor> extractor_ = MakeFeatureExtractor(LowContrastFeatureOptions()).value();
  RecognizeOptions recognize_;
  GrowOptions options_;
  std::function<bool(std::int64_t, std::int64_t, const Box&)> is_plausible_;
};

TEST_F(TrackGrowthTest, FollowsAnObjectThatTurnsAndLearnsItsViews) {
  const TurningScene scene;
  Recognised(1, scene, 0, kPhotoFrame - 2, 5);
  const TrackGrowth growth = Grow(scene);
  const auto [right, wrong] = Score(growth, 1, scene, 0);
  EXPECT_EQ(right, kFrames - 5) << "both ways, where the photo shows nothing of it any more";
  EXPECT_EQ(wrong, 0);
  EXPECT_THAT(growth.joined, IsEmpty());
  ASSERT_GE(growth.views.size(), 2U);
  for (std::size_t i = 0; i < growth.views.size(); ++i) {
    const LearntView& view = growth.views[i];
    EXPECT_GT(IntersectionOverUnion(view.box, scene.BoxOf(0, static_cast<int>(view.frame))), 0.5) << view.frame;
    EXPECT_GE(view.probability, 0.5);
    EXPECT_LE(view.probability, 1);
    if (view.parent) {
      ASSERT_LT(*view.parent, i) << "it is older";
      EXPECT_LE(view.probability, growth.views[*view.parent].probability);
    }
  }
  EXPECT_TRUE(std::ranges::any_of(growth.views, [](const LearntView& view) { return view.parent.has_value(); }));
  for (const GrownSighting& one : growth.sightings) EXPECT_LE(one.score, kScore);
}

TEST_F(TrackGrowthTest, EndsWhereTheObjectHasGone) {
  constexpr int kGone = 55;
  const TurningScene scene(std::vector<StandingObject>{
      StandingObject{.at = {450, 450}, .is_there = [](int frame) { return frame < kGone; }}});
  Recognised(1, scene, 0, kPhotoFrame - 2, 5);
  const TrackGrowth growth = Grow([&](int frame) { return scene.Draw(frame); }, 4).value();
  EXPECT_EQ(Score(growth, 1, scene, 0).first, kGone - 5);
  for (const GrownSighting& one : growth.sightings) EXPECT_LT(one.frame, kGone);
  EXPECT_LT(*read_.rbegin(), kFrames - 1) << "it is given up";
}

TEST_F(TrackGrowthTest, TimeUntilAnObjectIsGivenUpIsAnOption) {
  constexpr int kGone = 45;
  const TurningScene scene(std::vector<StandingObject>{
      StandingObject{.at = {450, 450}, .is_there = [](int frame) { return frame < kGone; }}});
  Recognised(1, scene, 0, kPhotoFrame - 2, 5);
  const auto last_read = [&](double max_lost_s) {
    options_.max_lost_s = max_lost_s;
    read_.clear();
    EXPECT_TRUE(Grow([&](int frame) { return scene.Draw(frame); }, 1));
    return *read_.rbegin();
  };
  EXPECT_EQ(last_read(5) - last_read(2), 2 * 3 / kFrame_s);
}

TEST_F(TrackGrowthTest, EndsAtACutOfTheVideo) {
  constexpr int kCut = 55;
  const TurningScene scene;
  const cv::Mat other = testing::DrawTown({TurningScene::kImageWidth, TurningScene::kImageHeight}, 77);
  Recognised(1, scene, 0, kPhotoFrame - 2, 5);
  const TrackGrowth growth = Grow([&](int frame) { return frame < kCut ? scene.Draw(frame) : other; }).value();
  EXPECT_EQ(Score(growth, 1, scene, 0), std::pair(kCut - 5, 0));
}

// The camera's motion does not tell where it is.
TEST_F(TrackGrowthTest, DoesNotInventAnObjectThatDrivesAway) {
  const TurningScene scene(std::vector<StandingObject>{StandingObject{.at = {330, 450}, .velocity = {3, 0}}});
  Recognised(1, scene, 0, kPhotoFrame - 2, 5);
  EXPECT_EQ(Score(Grow(scene), 1, scene, 0).second, 0);
}

TEST_F(TrackGrowthTest, TwinsSideBySideStayApart) {
  const TurningScene scene({StandingObject{.at = {400, 450}}, StandingObject{.at = {500, 450}}});
  Recognised(1, scene, 0, kPhotoFrame - 2, 5);
  Recognised(2, scene, 1, kPhotoFrame - 2, 5);
  const TrackGrowth growth = Grow(scene);
  EXPECT_THAT(growth.joined, IsEmpty());
  for (const std::int64_t tracklet : {1, 2}) {
    const auto [right, wrong] = Score(growth, tracklet, scene, static_cast<std::size_t>(tracklet - 1));
    EXPECT_GE(right, 0.9 * (kFrames - 5)) << tracklet;
    EXPECT_EQ(wrong, 0) << tracklet;
  }
}

// Nobody has recognised the second one, which must not be taken for the first.
TEST_F(TrackGrowthTest, ATwinBesideItIsNotTakenForTheObject) {
  const TurningScene scene({StandingObject{.at = {400, 450}}, StandingObject{.at = {500, 450}}});
  Recognised(1, scene, 0, kPhotoFrame - 2, 5);
  EXPECT_EQ(Score(Grow(scene), 1, scene, 0).second, 0);
}

TEST_F(TrackGrowthTest, TrackletsOfOneObjectAreJoined) {
  const TurningScene scene;
  Recognised(4, scene, 0, 5, 5);
  Recognised(7, scene, 0, 60, 5);
  const TrackGrowth growth = Grow(scene);
  EXPECT_THAT(growth.joined, ElementsAre(std::pair<std::int64_t, std::int64_t>(4, 7)));
  EXPECT_EQ(Score(growth, 4, scene, 0), std::pair(kFrames - 10, 0)) << "all sightings are the first one's";
}

TEST_F(TrackGrowthTest, ResultDoesNotDependOnTheBlocks) {
  const TurningScene scene({StandingObject{.at = {400, 450}}, StandingObject{.at = {500, 450}}});
  Recognised(1, scene, 0, 10, 4);
  Recognised(2, scene, 1, 50, 4);
  Recognised(3, scene, 0, 70, 4);
  std::vector<TrackGrowth> results;
  for (const std::int64_t block : {1, 7, 1000})
    results.push_back(Grow([&](int frame) { return scene.Draw(frame); }, block).value());
  EXPECT_FALSE(results[0].sightings.empty());
  for (const TrackGrowth& other : results) {
    EXPECT_EQ(other.joined, results[0].joined);
    ASSERT_EQ(other.views.size(), results[0].views.size());
    ASSERT_EQ(other.sightings.size(), results[0].sightings.size());
    for (std::size_t i = 0; i < other.sightings.size(); ++i) {
      EXPECT_EQ(other.sightings[i].frame, results[0].sightings[i].frame);
      EXPECT_EQ(other.sightings[i].tracklet, results[0].sightings[i].tracklet);
      EXPECT_EQ(other.sightings[i].box, results[0].sightings[i].box);
      EXPECT_EQ(other.sightings[i].score, results[0].sightings[i].score);
    }
  }
}

// At ten frames a second, two of three frames are looked at; the recognition from which the object is followed lies
// between them.
TEST_F(TrackGrowthTest, FramesBetweenTheStepsAreInterpolated) {
  frame_s_ = 0.1;
  const TurningScene scene({StandingObject{.at = {450, 450}}}, 1);
  constexpr int kAnchor = 37;  // 3.7 s, of the slot from 3.6 to 3.75 s, whose first frame is 36
  Recognised(1, scene, 0, kAnchor, 3);
  sightings_[0].matches = 30;  // the best one
  const auto draw = [&](int frame) { return scene.Draw(frame); };
  const TrackGrowth growth = Grow(draw).value();
  EXPECT_TRUE(read_.contains(kAnchor));
  EXPECT_FALSE(read_.contains(kAnchor + 3)) << "no step";
  EXPECT_EQ(Score(growth, 1, scene, 0), std::pair(kFrames - 3, 0));
  for (const std::int64_t max_wanted : {1, 7, 1000}) {
    const TrackGrowth same = Grow(draw, max_wanted).value();
    ASSERT_EQ(same.sightings.size(), growth.sightings.size()) << max_wanted;
    for (std::size_t i = 0; i < same.sightings.size(); ++i) EXPECT_EQ(same.sightings[i].box, growth.sightings[i].box);
  }
}

// Each in its own thread, from the same frames.
TEST_F(TrackGrowthTest, ModelsGrowTogetherAsTheyDoAlone) {
  const TurningScene scene({StandingObject{.at = {400, 450}}, StandingObject{.at = {540, 450}}});
  const auto draw = [&](int frame) { return scene.Draw(frame); };
  const ObjectModel model = PhotoModelOf(TurningScene());
  Recognised(1, scene, 0, kPhotoFrame - 2, 5);
  const std::vector<TrackletRecord> first = std::exchange(tracklets_, {});
  const std::vector<SightingRecord> of_first = std::exchange(sightings_, {});
  Recognised(2, scene, 1, kPhotoFrame - 12, 5);
  const std::vector<GrowthInput> inputs = {InputOf(model, first, of_first), InputOf(model, tracklets_, sightings_)};
  const std::vector<TrackGrowth> together = GrowAll(inputs, draw, 16).value();
  ASSERT_THAT(together, SizeIs(2));
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::vector<TrackGrowth> alone = GrowAll(std::span(inputs).subspan(i, 1), draw, 16).value();
    ASSERT_EQ(together[i].sightings.size(), alone.front().sightings.size());
    EXPECT_FALSE(alone.front().sightings.empty());
    for (std::size_t k = 0; k < together[i].sightings.size(); ++k) {
      EXPECT_EQ(together[i].sightings[k].box, alone.front().sightings[k].box);
      EXPECT_EQ(together[i].sightings[k].score, alone.front().sightings[k].score);
    }
  }
}

TEST_F(TrackGrowthTest, WeakFindsDoNotGrow) {
  const TurningScene scene;
  Recognised(1, scene, 0, kPhotoFrame, 2);
  EXPECT_THAT(Grow(scene).sightings, IsEmpty()) << "recognised too seldom";
  Recognised(2, scene, 0, kPhotoFrame + 10, 5);
  for (SightingRecord& sighting : sightings_) sighting.score = 0.9;
  EXPECT_THAT(Grow(scene).sightings, IsEmpty()) << "too unsure";
  EXPECT_THAT(read_, IsEmpty()) << "nothing is read for them";
}

TEST_F(TrackGrowthTest, NothingIsReadForAnObjectThatIsSeenAllTheTime) {
  const TurningScene scene;
  Recognised(1, scene, 0, 0, kFrames);
  EXPECT_THAT(Grow(scene).sightings, IsEmpty());
  EXPECT_THAT(read_, IsEmpty());
}

TEST_F(TrackGrowthTest, NothingIsLookedForBehindTheLastGap) {
  const TurningScene scene;
  Recognised(1, scene, 0, 0, kFrames);
  std::erase_if(sightings_, [](const SightingRecord& one) { return one.frame >= 50 && one.frame < 55; });
  const TrackGrowth growth = Grow([&](int frame) { return scene.Draw(frame); }, 1).value();
  EXPECT_EQ(Score(growth, 1, scene, 0), std::pair(5, 0));
  EXPECT_LE(*read_.rbegin(), 55);
}

TEST_F(TrackGrowthTest, AnObjectThatLeavesTheViewIsNotFollowedOutOfIt) {
  const TurningScene scene;
  Recognised(1, scene, 0, 0, 50);
  SightingRecord& last = sightings_.back();
  last.box = {TurningScene::kImageWidth - last.box.width, last.box.y, last.box.width, last.box.height};
  EXPECT_THAT(Grow(scene).sightings, IsEmpty());
  EXPECT_THAT(read_, IsEmpty());
}

TEST_F(TrackGrowthTest, PlacesThatTelemetryExcludesAreLeftOut) {
  const TurningScene scene;
  Recognised(1, scene, 0, kPhotoFrame - 2, 5);
  is_plausible_ = [](std::int64_t, std::int64_t frame, const Box&) { return frame < 50; };
  const TrackGrowth growth = Grow(scene);
  EXPECT_FALSE(growth.sightings.empty());
  for (const GrownSighting& one : growth.sightings) EXPECT_LT(one.frame, 50);
}

TEST_F(TrackGrowthTest, CancelEndsIt) {
  const TurningScene scene;
  Recognised(1, scene, 0, kPhotoFrame - 2, 5);
  CancelToken cancel;
  cancel.Cancel();
  const auto growth = Grow([&](int frame) { return scene.Draw(frame); }, 16, cancel);
  ASSERT_FALSE(growth);
  EXPECT_EQ(growth.error().code, ErrorCode::kCancelled);
}

// The turning object in a video, and the model of its photo in a library.
class IndexGrowthTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto writer = VideoWriter::Create(
        video_, {.width = TurningScene::kImageWidth, .height = TurningScene::kImageHeight, .fps = 1 / kFrame_s});
    ASSERT_TRUE(writer) << writer.error().message;
    for (int i = 0; i < kFrames; ++i) ASSERT_TRUE((*writer)->Write(scene_.Draw(i)));
    ASSERT_TRUE((*writer)->Finish());
    ASSERT_TRUE(library_.Add(PhotoModelOf(scene_)));
    run_.options.keep.interval_s = 0;  // many commits
  }

  [[nodiscard]] std::vector<ObjectModel> Models() const { return {library_.Load("can").value()}; }
  [[nodiscard]] std::unique_ptr<IndexStore> Store(std::string_view name) const {
    return OpenSqliteStore(folder_ / name, StoreMode::kCreate).value();
  }

  testing::ScratchFolder folder_;
  TurningScene scene_{{StandingObject{.at = {450, 450}}}, 6};
  std::string video_ = (folder_ / "can.mkv").string();
  ModelLibrary library_{folder_ / "models"};
  RunSetup run_;
};

TEST_F(IndexGrowthTest, OnePhotoIsEnough) {
  const auto grown = Store("grown.db");
  const IndexReport report = Index(video_, Models(), *grown, run_);
  run_.options.grow.enabled = false;
  const auto plain = Store("plain.db");
  Index(video_, Models(), *plain, run_);
  const std::vector<SightingRecord> found = SightingsOf(*grown);
  const std::vector<SightingRecord> before = SightingsOf(*plain);
  EXPECT_LT(before.size(), 0.8 * kFrames);
  EXPECT_GE(found.size(), before.size() + 10);
  EXPECT_EQ(report.sightings, std::ssize(found));
  EXPECT_THAT(grown->Objects({}).value(), SizeIs(1));
  EXPECT_EQ(grown->Objects({}).value().front().frames, std::ssize(found));
  for (const SightingRecord& one : found) {
    if (std::ranges::find(before, one.frame, &SightingRecord::frame) != before.end()) continue;
    EXPECT_GT(IntersectionOverUnion(one.box, scene_.BoxOf(0, static_cast<int>(one.frame))), 0.5) << one.frame;
  }
  // What recognition found stays as it is.
  for (const SightingRecord& one : before) {
    const auto same = std::ranges::find(found, one.frame, &SightingRecord::frame);
    ASSERT_NE(same, found.end());
    EXPECT_EQ(same->box, one.box);
    EXPECT_EQ(same->score, one.score);
    EXPECT_EQ(same->source, one.source);
  }
}

TEST_F(IndexGrowthTest, InterruptedPassGivesTheSameRows) {
  const auto whole = Store("whole.db");
  Index(video_, Models(), *whole, run_);
  const auto store = Store("cut.db");
  const Indexer indexer = Indexer::Create(Models(), run_.options).value();
  int stops = 0;
  for (;; ++stops) {
    ASSERT_LT(stops, 200);
    CancelToken cancel;
    cancel.CancelAtPoll(30 + 25 * stops);  // in the searches, then while what was found grows
    const auto report = indexer.Index({.video = video_, .threads = 2}, cancel, *store);
    if (report) break;
    ASSERT_EQ(report.error().code, ErrorCode::kCancelled) << report.error().message;
  }
  EXPECT_GE(stops, 4);
  EXPECT_EQ(Contents(*store), Contents(*whole));
}

// The last commit fails once: what has grown is stored by the next run, once.
TEST_F(IndexGrowthTest, FailedLastCommitIsMadeUp) {
  const auto whole = Store("whole.db");
  Index(video_, Models(), *whole, run_);
  const auto store = Store("cut.db");
  const Indexer indexer = Indexer::Create(Models(), run_.options).value();
  bool has_grown = false;
  FaultInjectingStore failing(
      *store, [&]() -> Status { return has_grown ? Fail(ErrorCode::kNoSpace, "full") : Status(); },
      [&]() -> Status {
        has_grown = true;
        return {};
      });
  EXPECT_EQ(indexer.Index({.video = video_}, CancelToken(), failing).error().code, ErrorCode::kNoSpace);
  EXPECT_TRUE(has_grown);
  EXPECT_FALSE(store->FindSearch(1, 1).value()->finished);
  EXPECT_TRUE(indexer.Index({.video = video_}, CancelToken(), *store));
  EXPECT_EQ(Contents(*store), Contents(*whole));
}

}  // namespace
}  // namespace victorious
