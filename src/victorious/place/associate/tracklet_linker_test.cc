#include "victorious/place/associate/tracklet_linker.h"

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;

constexpr double kFrameS = 0.1;
constexpr std::int64_t kModel = 7;

SightingRecord Sighting(std::int64_t frame, const Box& box, std::int64_t model = kModel, double score = 0.5) {
  SightingRecord sighting;
  sighting.video = 3;
  sighting.model = model;
  sighting.frame = frame;
  sighting.time_s = kFrameS * static_cast<double>(frame);
  sighting.box = box;
  sighting.score = score;
  return sighting;
}

// Emulates the store: assigns ids to new tracklets in their order, replaces updated ones, keeps sightings.
class EmulatedStore {
 public:
  std::vector<std::int64_t> Commit(const IndexBatch& batch) {
    std::vector<std::int64_t> ids;
    for (const IndexBatch::TrackletUpdate& update : batch.tracklets) {
      const std::int64_t id = update.id.value_or(static_cast<std::int64_t>(tracklets.size()) + 1);
      tracklets[id] = update.tracklet;
      tracklets[id].id = id;
      ids.push_back(id);
    }
    for (const IndexBatch::NewSighting& sighting : batch.sightings) {
      sightings.push_back(sighting.sighting);
      sightings.back().tracklet = ids[sighting.tracklet_update];
    }
    return ids;
  }

  std::map<std::int64_t, TrackletRecord> tracklets;
  std::vector<SightingRecord> sightings;
};

using Frames = std::vector<std::vector<SightingRecord>>;

// Camera motion from the previous frame, one entry per frame; empty: no motion.
using Motions = std::vector<Similarity2>;

// Links the frames, with a commit after each frame that `cut` selects, and a new linker for `kKill`.
enum class Cut { kNone, kCommit, kKill };

EmulatedStore LinkAll(const Frames& frames, const TrackletOptions& options, const Motions& motions,
                      const std::function<Cut(std::size_t)>& cut, const ObjectOptions& objects = {}) {
  EmulatedStore store;
  TrackletLinker linker(options, objects);
  IndexBatch batch;
  const auto step = [&](std::size_t i) {
    if (i < motions.size()) linker.Step(static_cast<std::int64_t>(i), motions[i]);
  };
  for (std::size_t i = 0; i < frames.size(); ++i) {
    step(i);
    linker.Link(frames[i], batch);
    const Cut here = i + 1 == frames.size() ? Cut::kCommit : cut(i);
    if (here == Cut::kNone) continue;
    linker.SetCommittedIds(store.Commit(batch));
    batch = {};
    if (here == Cut::kCommit) continue;
    linker = TrackletLinker(options, objects);
    std::vector<TrackletRecord> tracklets;
    for (const auto& [id, tracklet] : store.tracklets) tracklets.push_back(tracklet);
    std::vector<SightingRecord> last;
    for (const SightingRecord& sighting : store.sightings) {
      if (sighting.time_s >= kFrameS * static_cast<double>(i) - linker.HistorySeconds()) last.push_back(sighting);
    }
    linker.Resume(tracklets, last);
    for (auto k = static_cast<std::size_t>(linker.FirstRequiredFrame().value_or(0)); k <= i; ++k) step(k);
  }
  return store;
}

EmulatedStore LinkAll(const Frames& frames, const TrackletOptions& options, const Motions& motions = {}) {
  return LinkAll(frames, options, motions, [](std::size_t) { return Cut::kNone; });
}

std::vector<std::int64_t> TrackletIdsOf(const EmulatedStore& store) {
  std::vector<std::int64_t> tracklets;
  for (const SightingRecord& sighting : store.sightings) tracklets.push_back(sighting.tracklet);
  return tracklets;
}

TEST(TrackletLinker, OverlappingSightingsExtendOneTracklet) {
  const EmulatedStore store = LinkAll({{Sighting(2, {10, 10, 40, 40}, kModel, 0.6)},
                                       {Sighting(3, {14, 12, 40, 40}, kModel, 0.9)},
                                       {Sighting(5, {20, 14, 40, 40}, kModel, 0.7)}},
                                      TrackletOptions{});
  EXPECT_THAT(TrackletIdsOf(store), ElementsAre(1, 1, 1));
  const TrackletRecord& tracklet = store.tracklets.at(1);
  EXPECT_EQ(tracklet.video, 3);
  EXPECT_EQ(tracklet.model, kModel);
  EXPECT_EQ(tracklet.frames, 3);
  EXPECT_DOUBLE_EQ(tracklet.score, 0.9);
  EXPECT_DOUBLE_EQ(tracklet.first_time_s, 0.2);
  EXPECT_DOUBLE_EQ(tracklet.last_time_s, 0.5);
}

TEST(TrackletLinker, GapAboveLimitEndsATracklet) {
  const TrackletOptions options{.gap_s = 1.05, .min_overlap = 0.1};
  const Box box{10, 10, 40, 40};
  EXPECT_THAT(TrackletIdsOf(LinkAll({{Sighting(0, box)}, {Sighting(10, box)}}, options)), ElementsAre(1, 1));
  EXPECT_THAT(TrackletIdsOf(LinkAll({{Sighting(0, box)}, {Sighting(11, box)}}, options)), ElementsAre(1, 2));
  // Frames without sightings change nothing.
  EXPECT_THAT(TrackletIdsOf(LinkAll({{Sighting(0, box)}, {}, {}, {Sighting(11, box)}}, options)), ElementsAre(1, 2));
}

TEST(TrackletLinker, OverlapBelowMinimumStartsANewTracklet) {
  const Box box{0, 0, 30, 10};
  const Box shifted{20, 0, 30, 10};  // 100 of 500 px: IoU 0.2
  const Frames frames = {{Sighting(0, box)}, {Sighting(1, shifted)}};
  EXPECT_THAT(TrackletIdsOf(LinkAll(frames, {.gap_s = 1, .min_overlap = 0.19})), ElementsAre(1, 1));
  EXPECT_THAT(TrackletIdsOf(LinkAll(frames, {.gap_s = 1, .min_overlap = 0.21})), ElementsAre(1, 2));
  // Even with a minimum overlap of 0, boxes without any overlap are different tracklets.
  EXPECT_THAT(TrackletIdsOf(LinkAll({{Sighting(0, box)}, {Sighting(1, {31, 0, 30, 10})}}, {.min_overlap = 0})),
              ElementsAre(1, 2));
}

TEST(TrackletLinker, OverlapIsComputedWithTheLastSighting) {
  Frames frames;
  for (int i = 0; i < 20; ++i) frames.push_back({Sighting(i, {10.0 * i, 0, 40, 40})});
  EXPECT_THAT(TrackletIdsOf(LinkAll(frames, TrackletOptions{})), ::testing::Each(1));
}

TEST(TrackletLinker, AssignmentIsOneToOneByDescendingOverlap) {
  const Box left{0, 0, 40, 40};
  const Box right{30, 0, 40, 40};
  // Both sightings of the second frame overlap both tracklets; they come in the opposite order.
  const Frames frames = {{Sighting(0, left), Sighting(0, right)},
                         {Sighting(1, {31, 0, 40, 40}), Sighting(1, {1, 0, 40, 40})},
                         {Sighting(2, {2, 0, 40, 40}), Sighting(2, {4, 0, 40, 40}), Sighting(2, {32, 0, 40, 40})}};
  EXPECT_THAT(TrackletIdsOf(LinkAll(frames, TrackletOptions{})), ElementsAre(1, 2, 2, 1, 1, 3, 2));
}

TEST(TrackletLinker, SightingsOfDifferentModelsAreNotLinked) {
  const Box box{0, 0, 40, 40};
  const Frames frames = {{Sighting(0, box, 7), Sighting(0, box, 8)}, {Sighting(1, box, 8), Sighting(1, box, 9)}};
  const EmulatedStore store = LinkAll(frames, TrackletOptions{});
  EXPECT_THAT(TrackletIdsOf(store), ElementsAre(1, 2, 2, 3));
  EXPECT_EQ(store.tracklets.at(2).model, 8);
}

SightingRecord WithTrack(SightingRecord sighting, std::int64_t track) {
  sighting.track = track;
  return sighting;
}

TEST(TrackletLinker, SightingsOfOneTrackAreOneTracklet) {
  const Box here{0, 0, 40, 40};
  const Box there{300, 0, 40, 40};
  const Frames frames = {{WithTrack(Sighting(0, here), 5), WithTrack(Sighting(0, there), 6)},
                         {WithTrack(Sighting(1, here), 6), WithTrack(Sighting(1, there), 5)}};
  EXPECT_THAT(TrackletIdsOf(LinkAll(frames, TrackletOptions{})), ElementsAre(1, 2, 2, 1));
  // A new track continues the tracklet at its first box.
  EXPECT_THAT(
      TrackletIdsOf(LinkAll({{WithTrack(Sighting(0, here), 5)}, {WithTrack(Sighting(1, here), 9)}}, TrackletOptions{})),
      ElementsAre(1, 1));
}

Similarity2 Shift(double x, double y) { return {.translation = {x, y}}; }

TEST(TrackletLinker, GivenTracksAreNotJoinedByOverlap) {
  const Box box{10, 10, 20, 20};
  const Frames frames = {{WithTrack(Sighting(0, box), 1)}, {WithTrack(Sighting(1, box), 2)}, {Sighting(2, box)}};
  EXPECT_EQ(LinkAll(frames, {}).tracklets.size(), 1U);
  EXPECT_EQ(LinkAll(frames, {.are_tracks_given = true}).tracklets.size(), 2U);
}

TEST(TrackletLinker, StaticObjectIsPredictedByImageMotion) {
  const Box first{300, 100, 50, 40};
  // The background moves 30 px per frame to the left; after ten frames another object is at the image position of the
  // first.
  const Motions motions(11, Shift(-30, 0));
  Frames frames(11);
  frames[0] = {Sighting(0, first)};
  frames[10] = {Sighting(10, first), Sighting(10, {3, 101, 50, 40})};
  EXPECT_THAT(TrackletIdsOf(LinkAll(frames, TrackletOptions{}, motions)), ElementsAre(1, 2, 1));
  EXPECT_THAT(TrackletIdsOf(LinkAll(frames, TrackletOptions{})), ElementsAre(1, 1, 2))
      << "without motions it is taken as static";
}

TEST(TrackletLinker, MovingObjectIsPredictedByItsVelocity) {
  // The camera follows a driving object: it stays at the image centre while the background moves.
  const Box middle{300, 200, 40, 40};
  const Motions motions(26, Shift(0, 15));
  Frames frames(26);
  for (int i = 0; i <= 10; ++i) frames[i] = {Sighting(i, middle)};
  frames[25] = {Sighting(25, {303, 198, 40, 40})};
  EXPECT_THAT(TrackletIdsOf(LinkAll(frames, TrackletOptions{}, motions)), ::testing::Each(1));
}

// A static object, initially 100 m north of the camera, which flies east at 20 m/s.
SightingRecord Standing(std::int64_t frame, double east_m, double range_m = 0) {
  const GeodeticPoint origin{RadiansFromDegrees(48), RadiansFromDegrees(11), 500};
  SightingRecord sighting = Sighting(frame, {300, 200, 40, 40});
  const Eigen::Vector3d camera(20 * sighting.time_s, 0, 100);
  const Eigen::Vector3d to = Eigen::Vector3d(east_m, 100, 0) - camera;
  sighting.observation = BearingObservation{.line = {.time_s = sighting.time_s,
                                                     .camera = TangentPlane(origin).GeodeticFromEnu(camera),
                                                     .azimuth_rad = std::atan2(to.x(), to.y()),
                                                     .elevation_rad = std::asin(to.z() / to.norm()),
                                                     .range_m = range_m > 0 ? range_m : to.norm(),
                                                     .sigma_rad = 2e-3,
                                                     .sigma_range_m = 3}};
  return sighting;
}

TEST(TrackletLinker, InconsistentObservationsSplitATracklet) {
  const auto tracklets_with = [](const SightingRecord& last) {
    Frames frames(18);
    for (int i = 0; i < 6; ++i) frames[i] = {Standing(i, 10)};
    frames[17] = {last};
    return LinkAll(frames, TrackletOptions{}).tracklets.size();
  };
  EXPECT_EQ(tracklets_with(Standing(17, 10)), 1U);
  EXPECT_EQ(tracklets_with(Standing(17, 22)), 2U) << "beside it";
  EXPECT_EQ(tracklets_with(Standing(17, 10, 200)), 2U) << "behind it";
  SightingRecord unknown = Standing(17, 22);
  unknown.observation.reset();
  EXPECT_EQ(tracklets_with(unknown), 1U) << "without an observation there is no gate";
  // The gate is that of the error model given.
  ObjectOptions vague;
  vague.locate.common.position_m = 10;
  Frames apart(18);
  for (int i = 0; i < 6; ++i) apart[i] = {Standing(i, 10)};
  apart[17] = {Standing(17, 22)};
  const auto no_cut = [](std::size_t) { return Cut::kNone; };
  EXPECT_EQ(LinkAll(apart, TrackletOptions{}, {}, no_cut, vague).tracklets.size(), 1U);
  // The same track overrides the gate: an error of telemetry does not split the tracklet.
  const Frames tracked = {{WithTrack(Standing(0, 10), 4)}, {WithTrack(Standing(1, 30), 4)}};
  EXPECT_THAT(TrackletIdsOf(LinkAll(tracked, TrackletOptions{})), ElementsAre(1, 1));
}

TEST(TrackletLinker, WhiteTelemetryNoiseDoesNotSplitTracklets) {
  int apart = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    Frames frames(18);
    for (const int i : {0, 1, 2, 3, 4, 5, 17}) {
      SightingRecord sighting = Standing(i, 10);
      LineOfSight& line = sighting.observation->line;
      line.camera =
          TangentPlane(line.camera).GeodeticFromEnu({2 * random.Normal(), 2 * random.Normal(), 2 * random.Normal()});
      line.azimuth_rad += RadiansFromDegrees(0.5) * random.Normal();
      line.elevation_rad += RadiansFromDegrees(0.5) * random.Normal();
      frames[static_cast<std::size_t>(i)] = {sighting};
    }
    apart += LinkAll(frames, TrackletOptions{}).tracklets.size() > 1 ? 1 : 0;
  }
  EXPECT_LE(apart, 2);
}

// Two models with several instances that move, vanish and return; some have tracks for a while.
Frames RandomFrames(std::uint64_t seed) {
  Random random(seed);
  std::vector<Box> places;
  for (int i = 0; i < 5; ++i) places.push_back({random.Uniform(0, 150), random.Uniform(0, 80), 40, 30});
  Frames frames(120);
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      places[i].x += random.Uniform(-6, 6);
      places[i].y += random.Uniform(-6, 6);
      if ((frame / 9 + i) % 3 == 0 || random.Below(5) == 0) continue;
      frames[frame].push_back(Sighting(static_cast<std::int64_t>(frame), places[i],
                                       kModel + static_cast<std::int64_t>(i % 2), random.Uniform()));
      if (random.Below(3) == 0) frames[frame].back().track = static_cast<std::int64_t>(100 * (frame / 8) + i);
      if (i == 0) continue;
      frames[frame].back().observation = Standing(static_cast<std::int64_t>(frame), places[i].x / 10).observation;
      if (random.Below(2) == 0) frames[frame].back().source = SightingSource::kTracked;
    }
  }
  return frames;
}

std::vector<std::tuple<std::int64_t, double, std::int64_t, double, double>> Summary(const EmulatedStore& store) {
  std::vector<std::tuple<std::int64_t, double, std::int64_t, double, double>> summary;
  for (const auto& [id, tracklet] : store.tracklets) {
    summary.emplace_back(tracklet.model, tracklet.score, tracklet.frames, tracklet.first_time_s, tracklet.last_time_s);
  }
  return summary;
}

TEST(TrackletLinker, ResultDoesNotDependOnBatchesOrRestarts) {
  const TrackletOptions options{.gap_s = 0.65, .min_overlap = 0.1};
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Frames frames = RandomFrames(seed);
    Random moves(seed);
    Motions motions;
    for (std::size_t i = 0; i < frames.size(); ++i)
      motions.push_back(Shift(moves.Uniform(-4, 4), moves.Uniform(-4, 4)));
    const EmulatedStore whole = LinkAll(frames, options, motions);
    ASSERT_GT(whole.tracklets.size(), 10U) << "seed " << seed;
    ASSERT_LT(whole.tracklets.size(), whole.sightings.size() / 3) << "seed " << seed;
    for (const std::uint32_t spacing : {1U, 3U, 20U}) {
      for (const Cut kind : {Cut::kCommit, Cut::kKill}) {
        Random random(100 * seed + spacing);
        const EmulatedStore cut = LinkAll(frames, options, motions,
                                          [&](std::size_t) { return random.Below(spacing) == 0 ? kind : Cut::kNone; });
        EXPECT_EQ(TrackletIdsOf(cut), TrackletIdsOf(whole)) << "seed " << seed << ", one cut in " << spacing;
        EXPECT_EQ(Summary(cut), Summary(whole)) << "seed " << seed << ", one cut in " << spacing;
      }
    }
  }
}

}  // namespace
}  // namespace victorious
