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
#include "testing/drawn_town.h"
#include "testing/fault_injecting_store.h"
#include "victorious/base/random.h"
#include "victorious/jobs/index/indexer_test.h"
#include "victorious/object/model/photo_model.h"

namespace victorious {
namespace {

using testing::Contents;
using ::testing::ElementsAre;
using testing::FaultInjectingStore;
using ::testing::IsEmpty;
using testing::SightingsOf;
using ::testing::SizeIs;

constexpr int kFrames = 80;
constexpr int kPhotoFrame = 40;
constexpr double kFrame_s = 0.5;

struct StandingObject {
  cv::Point2d at;  // centre, px of the town
  std::function<bool(int frame)> is_there = [](int) { return true; };
  cv::Point2d velocity = {0, 0};  // px of the town a frame
};

// Objects that stand on a town, from a camera that turns above it. Each shows a part of a strip that moves on with
// time, so that a view shares nothing with that of some 40 frames before: what a camera sees that circles around.
class TurningScene {
 public:
  // @param turn_px  by which the strip moves on from frame to frame
  explicit TurningScene(std::vector<StandingObject> objects = {StandingObject{.at = {450, 450}}}, int turn_px = 2)
      : objects_(std::move(objects)),
        turn_px_(turn_px),
        town_(testing::DrawTown({900, 900}, 6)),
        strip_(kHeight, turn_px * kFrames + kWidth, CV_8UC3) {
    Random random(3);
    const std::array<cv::Scalar, 4> colours = {cv::Scalar(40, 40, 200), cv::Scalar(20, 10, 110),
                                               cv::Scalar(90, 60, 240), cv::Scalar(60, 20, 160)};
    strip_.setTo(colours[0]);
    for (int i = 0; i < 3 * strip_.cols; ++i) {
      const cv::Rect patch(static_cast<int>(random.Below(static_cast<std::uint64_t>(strip_.cols))),
                           static_cast<int>(random.Below(kHeight)), 3 + static_cast<int>(random.Below(10)),
                           3 + static_cast<int>(random.Below(10)));
      cv::rectangle(strip_, patch, colours[random.Below(4)], cv::FILLED);
    }
    cv::GaussianBlur(strip_, strip_, {}, 0.7);
  }

  [[nodiscard]] cv::Mat Draw(int frame) const {
    cv::Mat town = town_.clone();
    for (const StandingObject& object : objects_) {
      const cv::Mat view = strip_.colRange(turn_px_ * frame, turn_px_ * frame + kWidth);
      if (object.is_there(frame)) view.copyTo(town(PlaceOf(object, frame)));
    }
    cv::Mat image;
    cv::warpAffine(town, image, MapOf(frame), {kImageWidth, kImageHeight});
    return image;
  }

  [[nodiscard]] Polygon OutlineOf(std::size_t object, int frame) const {
    const cv::Rect place = PlaceOf(objects_[object], frame);
    const cv::Matx23d map = MapOf(frame);
    Polygon outline = BoxCorners({static_cast<double>(place.x), static_cast<double>(place.y), kWidth, kHeight});
    for (Eigen::Vector2d& corner : outline) {
      const cv::Vec2d moved = map * cv::Vec3d(corner.x(), corner.y(), 1);
      corner = {moved[0], moved[1]};
    }
    return outline;
  }
  [[nodiscard]] Box BoxOf(std::size_t object, int frame) const { return BoundingBox(OutlineOf(object, frame)); }

  static constexpr int kImageWidth = 400;
  static constexpr int kImageHeight = 300;

 private:
  static constexpr int kWidth = 84;
  static constexpr int kHeight = 56;

  static cv::Rect PlaceOf(const StandingObject& object, int frame) {
    return {static_cast<int>(std::lround(object.at.x + frame * object.velocity.x)) - kWidth / 2,
            static_cast<int>(std::lround(object.at.y + frame * object.velocity.y)) - kHeight / 2, kWidth, kHeight};
  }
  static cv::Matx23d MapOf(int frame) {
    cv::Mat map = cv::getRotationMatrix2D({450, 450}, 0.7 * (frame - kPhotoFrame), 1 + 0.001 * frame);
    map.at<double>(0, 2) += kImageWidth / 2.0 - 450;
    map.at<double>(1, 2) += kImageHeight / 2.0 - 450;
    return map;
  }

  std::vector<StandingObject> objects_;
  int turn_px_;
  cv::Mat town_;
  cv::Mat strip_;
};

ObjectModel PhotoModelOf(const TurningScene& scene) {
  const Photo photo = PreparePhoto("photo", scene.Draw(kPhotoFrame), {}, scene.BoxOf(0, kPhotoFrame)).value();
  return MakePhotoModel("can", std::span(&photo, 1), std::nullopt, {}).value();
}

std::vector<Frame> DrawFrames(std::int64_t first, std::int64_t end, const std::function<cv::Mat(int)>& draw) {
  std::vector<Frame> frames;
  for (std::int64_t i = first; i < end; ++i)
    frames.push_back({.index = i, .time_s = kFrame_s * static_cast<double>(i), .image = draw(static_cast<int>(i))});
  return frames;
}

class TrackGrowthTest : public ::testing::Test {
 protected:
  // What recognition has found: an object in some frames.
  void Recognised(std::int64_t tracklet, const TurningScene& scene, std::size_t object, int first, int count) {
    tracklets_.push_back({.id = tracklet,
                          .score = kScore,
                          .frames = count,
                          .first_time_s = kFrame_s * first,
                          .last_time_s = kFrame_s * (first + count - 1)});
    for (int frame = first; frame < first + count; ++frame) {
      sightings_.push_back({.tracklet = tracklet,
                            .frame = frame,
                            .time_s = kFrame_s * frame,
                            .box = scene.BoxOf(object, frame),
                            .outline = scene.OutlineOf(object, frame),
                            .score = kScore,
                            .matches = 20});
    }
    std::ranges::stable_sort(sightings_, {}, &SightingRecord::frame);
  }

  [[nodiscard]] Expected<TrackGrowth> Grow(const std::function<cv::Mat(int)>& draw, std::int64_t block = 16,
                                           const CancelToken& cancel = {}) {
    const ObjectModel model = PhotoModelOf(TurningScene());
    std::vector<double> times_s;
    for (int i = 0; i < kFrames; ++i) times_s.push_back(kFrame_s * i);
    const ReadFrames read = [&](std::int64_t first, std::int64_t end) -> Expected<std::vector<Frame>> {
      for (std::int64_t i = first; i < end; ++i) read_.insert(i);
      return DrawFrames(first, end, draw);
    };
    return GrowTracks({.model = model,
                       .tracklets = tracklets_,
                       .sightings = sightings_,
                       .times_s = times_s,
                       .end = kFrames,
                       .extractor = *extractor_,
                       .recognize = recognize_,
                       .options = options_},
                      read, block, cancel);
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
  std::vector<TrackletRecord> tracklets_;
  std::vector<SightingRecord> sightings_;
  std::set<std::int64_t> read_;
  std::unique_ptr<const FeatureExtractor> extractor_ = MakeFeatureExtractor(LowContrastFeatureOptions()).value();
  RecognizeOptions recognize_;
  GrowOptions options_;
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
  const TrackGrowth growth = Grow(scene);
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

TEST_F(TrackGrowthTest, WeakFindsDoNotGrow) {
  const TurningScene scene;
  Recognised(1, scene, 0, kPhotoFrame, 2);
  EXPECT_THAT(Grow(scene).sightings, IsEmpty()) << "recognised too seldom";
  Recognised(2, scene, 0, kPhotoFrame + 10, 5);
  for (SightingRecord& sighting : sightings_) sighting.score = 0.9;
  EXPECT_THAT(Grow(scene).sightings, IsEmpty()) << "too unsure";
  EXPECT_THAT(read_, IsEmpty()) << "nothing is read for them";
}

TEST_F(TrackGrowthTest, PlacesThatTelemetryExcludesAreLeftOut) {
  const TurningScene scene;
  Recognised(1, scene, 0, kPhotoFrame - 2, 5);
  const ObjectModel model = PhotoModelOf(scene);
  std::vector<double> times_s;
  for (int i = 0; i < kFrames; ++i) times_s.push_back(kFrame_s * i);
  const ReadFrames read = [&](std::int64_t first, std::int64_t end) -> Expected<std::vector<Frame>> {
    return DrawFrames(first, end, [&](int i) { return scene.Draw(i); });
  };
  const GrowthInput input{.model = model,
                          .tracklets = tracklets_,
                          .sightings = sightings_,
                          .times_s = times_s,
                          .end = kFrames,
                          .extractor = *extractor_,
                          .recognize = recognize_,
                          .options = options_,
                          .is_plausible = [](std::int64_t, std::int64_t frame, const Box&) { return frame < 50; }};
  const TrackGrowth growth = GrowTracks(input, read, 16, {}).value();
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
    run_.options.grow.enabled = true;
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
