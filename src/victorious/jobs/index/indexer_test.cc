#include "victorious/jobs/index/indexer_test.h"

#include <map>
#include <set>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/drawn_flight.h"
#include "testing/fault_injecting_store.h"
#include "victorious/base/file.h"
#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

using testing::Contents;
using testing::DrawnFlight;
using testing::FaultInjectingStore;
using testing::ObjectsOf;
using testing::PhotoOf;
using testing::ShortFlight;
using testing::SightingsOf;
using testing::VideosOf;

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

TEST(Indexer, FindsObjectsAtTheirTruePosition) {
  const DrawnFlight flight(ShortFlight());
  const auto store = flight.Store("index.db");
  const IndexReport report =
      Index(flight.video(), flight.Models(), *store, {}, [](const std::string& warning) { ADD_FAILURE() << warning; });
  EXPECT_EQ(report.frames_searched, flight.flight().options().frames);

  const std::vector<SightingRecord> sightings = SightingsOf(*store);
  EXPECT_EQ(report.sightings, static_cast<std::int64_t>(sightings.size()));
  const std::vector<ModelRecord> models = store->Models().value();
  int findable = 0;
  int found = 0;
  int wrong = 0;
  for (int frame = 0; frame < flight.flight().options().frames; ++frame) {
    std::set<std::size_t> right;  // indices into `sightings`
    for (const testing::TruthRow& row : flight.flight().Truth(frame)) {
      const bool clear = row.visible > 0.8;
      findable += clear ? 1 : 0;
      for (std::size_t i = 0; i < sightings.size(); ++i) {
        const SightingRecord& sighting = sightings[i];
        if (sighting.frame != frame || models.at(sighting.model - 1).name != row.model) continue;
        EXPECT_NEAR(sighting.time_s, row.time_s, 0.001);
        if (IntersectionOverUnion(sighting.box, row.box) < 0.6) continue;
        right.insert(i);
        found += clear ? 1 : 0;
      }
    }
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      wrong += sightings[i].frame == frame && !right.contains(i) ? 1 : 0;
    }
  }
  EXPECT_GT(findable, 15);
  EXPECT_GE(found, 0.9 * findable);
  EXPECT_EQ(wrong, 0);

  const VideoRecord video = VideosOf(*store).at(0);
  EXPECT_EQ(video.name, flight.video());
  EXPECT_EQ(video.frame_count, flight.flight().options().frames);
  EXPECT_EQ(video.width, 256);
  EXPECT_EQ(video.height, 192);
}

TEST(Indexer, SecondRunDoesNothing) {
  const DrawnFlight flight(ShortFlight());
  const auto store = flight.Store("index.db");
  Index(flight.video(), flight.Models(), *store);
  const std::string before = Contents(*store);
  const IndexReport again = Index(flight.video(), flight.Models(), *store);
  EXPECT_EQ(again.frames_searched, 0);
  EXPECT_EQ(again.sightings, 0);
  EXPECT_EQ(Contents(*store), before);
}

TEST(Indexer, OnlyNewModelsAreSearched) {
  const DrawnFlight flight(ShortFlight());
  const auto store = flight.Store("index.db");
  Index(flight.video(), {flight.Model(0)}, *store);
  const SightingFilter first{.model_name = flight.flight().ObjectName(0)};
  const std::size_t sightings = SightingsOf(*store, first).size();
  const std::vector<ObjectRecord> objects = ObjectsOf(*store, first);

  const IndexReport report = Index(flight.video(), flight.Models(), *store);
  EXPECT_EQ(report.frames_searched, flight.flight().options().frames);
  EXPECT_EQ(report.sightings,
            static_cast<std::int64_t>(SightingsOf(*store, {.model_name = flight.flight().ObjectName(1)}).size()));
  EXPECT_GT(report.sightings, 0);
  EXPECT_THAT(SightingsOf(*store, first), SizeIs(sightings));
  EXPECT_THAT(ObjectsOf(*store, first), SizeIs(objects.size()));

  // The same as both in one call, except for the object ids.
  const auto both = flight.Store("both.db");
  Index(flight.video(), flight.Models(), *both);
  EXPECT_EQ(SightingsOf(*store).size(), SightingsOf(*both).size());
  EXPECT_EQ(ObjectsOf(*store).size(), ObjectsOf(*both).size());
}

TEST(Indexer, ChangedModelReplacesItsSightings) {
  const DrawnFlight flight(ShortFlight());
  const auto store = flight.Store("index.db");
  Index(flight.video(), flight.Models(), *store);
  Index(flight.video(), {flight.Model(0, 0.8), flight.Model(1)}, *store);
  EXPECT_THAT(store->Models().value(), SizeIs(2));

  const auto fresh = flight.Store("fresh.db");
  Index(flight.video(), {flight.Model(0, 0.8), flight.Model(1)}, *fresh);
  for (int object : {0, 1}) {
    const SightingFilter filter{.model_name = flight.flight().ObjectName(object)};
    const std::vector<SightingRecord> got = SightingsOf(*store, filter);
    const std::vector<SightingRecord> expected = SightingsOf(*fresh, filter);
    ASSERT_THAT(got, SizeIs(expected.size()));
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_EQ(got[i].frame, expected[i].frame);
      EXPECT_EQ(got[i].box, expected[i].box);
      EXPECT_EQ(got[i].matches, expected[i].matches);
    }
    EXPECT_THAT(ObjectsOf(*store, filter), SizeIs(ObjectsOf(*fresh, filter).size()));
  }
}

TEST(Indexer, SearchesEveryNthFrame) {
  const DrawnFlight flight(ShortFlight());
  const auto all = flight.Store("all.db");
  Index(flight.video(), flight.Models(), *all);
  RunSetup run;
  run.options.every = 5;
  run.options.follow.enabled = false;
  const auto store = flight.Store("fifth.db");
  const IndexReport report = Index(flight.video(), flight.Models(), *store, run);
  EXPECT_EQ(report.frames_searched, 4);  // 0, 5, 10, 15
  // Compares frame and matches: the object of a sighting may differ.
  std::set<std::pair<std::int64_t, int>> expected;
  for (const SightingRecord& sighting : SightingsOf(*all)) {
    if (sighting.frame % 5 == 0) expected.emplace(sighting.frame, sighting.matches);
  }
  std::set<std::pair<std::int64_t, int>> got;
  for (const SightingRecord& sighting : SightingsOf(*store)) got.emplace(sighting.frame, sighting.matches);
  EXPECT_EQ(got, expected);
  EXPECT_FALSE(got.empty());
  EXPECT_EQ(VideosOf(*store).at(0).frame_count, flight.flight().options().frames) << "all of them, searched or not";
}

// Interrupted after each first commit until the end is reached.
TEST(Indexer, ResumedRunEqualsUninterruptedRun) {
  constexpr int kFrames = 80;  // two commits, each after 32 kept frames and those in flight, and the end
  const DrawnFlight flight(ShortFlight(kFrames));
  const RunSetup run = ManyCommits();  // a run that goes on tracks at most seven frames again
  const auto whole = flight.Store("whole.db");
  Index(flight.video(), flight.Models(), *whole, run);

  const auto store = flight.Store("cut.db");
  const Indexer indexer = Indexer::Create(flight.Models(), run.options).value();
  int runs = 0;
  std::int64_t frames = 0;
  while (true) {
    ASSERT_LT(++runs, kFrames) << "each does a frame at least";
    CancelToken cancel;
    FaultInjectingStore hooked(*store, [&]() -> Status {
      cancel.Cancel();
      return {};
    });
    const Expected<IndexReport> report = indexer.Index({.video = flight.video(), .threads = 2}, cancel, hooked);
    if (report) {
      frames += report->frames_searched;
      break;
    }
    ASSERT_EQ(report.error().code, ErrorCode::kCancelled) << report.error().message;
    EXPECT_THAT(report.error().message, AllOf(HasSubstr(flight.video()), HasSubstr("run again")));
    const std::int64_t next = store->FindSearch(1, 1).value().value().next_frame;
    EXPECT_GT(next, frames);
    EXPECT_LE(next, kFrames);  // the last commit may be the cancelled one: its objects are not computed yet
    frames = 0;
  }
  EXPECT_GE(runs, 3);
  EXPECT_EQ(Contents(*store), Contents(*whole));
}

// A full-frame search that comes late finds an object in the frames before, too.
TEST(Indexer, ObjectsAreFollowedBackward) {
  constexpr std::int64_t kSearched = 20;
  const DrawnFlight flight(ShortFlight(40));
  RunSetup run;
  run.options.every = kSearched;
  // The sightings of the frames between the first two full-frame searches.
  const auto sightings_between = [&](int backward_frames, const char* name) {
    run.options.follow.backward_frames = backward_frames;
    const auto store = flight.Store(name);
    Index(flight.video(), flight.Models(), *store, run);
    std::multiset<std::int64_t> frames;
    for (const SightingRecord& one : SightingsOf(*store, {.include_rejected = true})) {
      if (one.frame < kSearched) frames.insert(one.frame);
    }
    return frames;
  };
  const std::multiset<std::int64_t> forward = sightings_between(0, "forward.db");
  const std::multiset<std::int64_t> both = sightings_between(30, "both.db");
  const std::multiset<std::int64_t> one = sightings_between(1, "one.db");
  EXPECT_GT(both.size(), forward.size() + 3);
  EXPECT_EQ(one.size(), forward.size() + 1);
  EXPECT_EQ(one.count(kSearched - 1), forward.count(kSearched - 1) + 1) << "the frame before the search";
}

// Between full-frame searches the result depends on earlier frames: those since the last restart of tracking are
// tracked again.
class ResumedBetweenFullFrames : public ::testing::TestWithParam<double> {};

TEST_P(ResumedBetweenFullFrames, EqualsUninterruptedRun) {
  const DrawnFlight flight(ShortFlight(40));
  RunSetup run;
  run.options.every = 6;
  run.options.follow.frame_interval_s = GetParam();
  run.options.follow.restart_interval_frames = GetParam() > 0.1 ? 6 : 16;
  const auto whole = flight.Store("whole.db");
  Index(flight.video(), flight.Models(), *whole, run);
  const std::vector<SightingRecord> sightings = SightingsOf(*whole);
  EXPECT_TRUE(std::ranges::any_of(sightings, [](const SightingRecord& s) { return s.frame % 16 % 6 != 0; }));

  const auto store = flight.Store("cut.db");
  const Indexer indexer = Indexer::Create(flight.Models(), run.options).value();
  // The token is polled once a frame, and a few times before the first. Each call gets further than the one before it.
  int stops = 0;
  for (;; ++stops) {
    ASSERT_LT(stops, 40);
    CancelToken cancel;
    cancel.CancelAtPoll(8 + 5 * stops);
    const Expected<IndexReport> report = indexer.Index({.video = flight.video(), .threads = 2}, cancel, *store);
    if (report) break;
    ASSERT_EQ(report.error().code, ErrorCode::kCancelled) << report.error().message;
  }
  EXPECT_GE(stops, 3);
  EXPECT_EQ(Contents(*store), Contents(*whole));
}

INSTANTIATE_TEST_SUITE_P(Indexer, ResumedBetweenFullFrames, ::testing::Values(0.1, 0.3));

// Of 10 frames a second each third is tracked, and the one before a restart.
TEST(Indexer, FramesBetweenTrackedOnesShowTheObjectsAtTheirTruePosition) {
  const DrawnFlight flight(ShortFlight(40));
  RunSetup run;
  run.options.every = 12;
  run.options.follow.restart_interval_frames = 8;
  run.options.follow.frame_interval_s = 0.3;
  const auto store = flight.Store("index.db");
  Index(flight.video(), flight.Models(), *store, run);
  EXPECT_THAT(store->FindSearch(1, 1).value().value().options_json, HasSubstr("\"restart_interval_frames\":24"))
      << "of the video";
  const std::vector<ModelRecord> models = store->Models().value();
  int between = 0;
  for (const SightingRecord& one : SightingsOf(*store)) {
    if (one.frame % 3 == 0 || one.frame % 24 == 23) continue;
    ++between;
    EXPECT_EQ(one.source, SightingSource::kTracked);
    for (const testing::TruthRow& row : flight.flight().Truth(static_cast<int>(one.frame))) {
      if (row.model != models.at(one.model - 1).name) continue;
      EXPECT_GT(IntersectionOverUnion(one.box, row.box), 0.5) << one.frame;
    }
  }
  EXPECT_GT(between, 10);
}

TEST(Indexer, CancelBeforeStartStopsImmediately) {
  const DrawnFlight flight(ShortFlight(12));
  const auto store = flight.Store("index.db");
  CancelToken cancel;
  cancel.Cancel();
  const Indexer indexer = Indexer::Create(flight.Models(), {}).value();
  const Expected<IndexReport> report = indexer.Index({.video = flight.video(), .threads = 2}, cancel, *store);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kCancelled);
  EXPECT_EQ(Index(flight.video(), flight.Models(), *store).frames_searched, 12);
}

// A model that is added while another is half done is searched for from the beginning; both results equal those of one
// run.
TEST(Indexer, ModelsResumeAtTheirOwnFrame) {
  const DrawnFlight flight(ShortFlight(48));
  const auto store = flight.Store("index.db");
  CancelToken cancel;
  FaultInjectingStore hooked(*store, [&]() -> Status {
    cancel.Cancel();
    return {};
  });
  const Indexer first = Indexer::Create({flight.Model(0)}, ManyCommits().options).value();
  ASSERT_FALSE(first.Index({.video = flight.video(), .threads = 1}, cancel, hooked));
  const std::int64_t done = store->FindSearch(1, 1).value().value().next_frame;
  ASSERT_GT(done, 0);
  ASSERT_LT(done, 48);
  const IndexReport report = Index(flight.video(), flight.Models(), *store, ManyCommits());
  EXPECT_EQ(report.frames_searched, 48 + (48 - done));

  const auto whole = flight.Store("whole.db");
  Index(flight.video(), flight.Models(), *whole, ManyCommits());
  for (int object : {0, 1}) {
    const SightingFilter filter{.model_name = flight.flight().ObjectName(object)};
    EXPECT_THAT(SightingsOf(*store, filter), SizeIs(SightingsOf(*whole, filter).size()));
    EXPECT_THAT(ObjectsOf(*store, filter), SizeIs(ObjectsOf(*whole, filter).size()));
  }
}

TEST(Indexer, ResultDoesNotDependOnThreads) {
  const DrawnFlight flight(ShortFlight());
  std::vector<std::string> contents;
  for (const int threads : {1, 4}) {
    const auto store = flight.Store("threads-" + std::to_string(threads));
    RunSetup run = ManyCommits();
    run.threads = threads;
    Index(flight.video(), flight.Models(), *store, run);
    contents.push_back(Contents(*store));
  }
  EXPECT_EQ(contents[0], contents[1]);
  EXPECT_THAT(contents[0], HasSubstr("crate"));
}

// More threads than the machine has processors: only progress may be written to stderr.
TEST(Indexer, ManyThreadsGiveNoWarning) {
  const DrawnFlight flight(ShortFlight(4));
  const auto store = flight.Store("index.db");
  RunSetup run;
  run.threads = static_cast<int>(std::thread::hardware_concurrency()) + 3;
  ::testing::internal::CaptureStderr();
  Index(flight.video(), flight.Models(), *store, run);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), Not(HasSubstr("Warning")));
}

TEST(Indexer, SameContentUnderAnotherNameIsTheSameVideo) {
  const DrawnFlight flight(ShortFlight(12));
  const auto store = flight.Store("index.db");
  Index(flight.video(), flight.Models(), *store);
  const std::size_t sightings = SightingsOf(*store).size();
  const std::string copy = (flight / "copy.mkv").string();
  fs::copy_file(flight.video(), copy);
  const IndexReport report = Index(copy, flight.Models(), *store);
  EXPECT_EQ(report.frames_searched, 0);
  EXPECT_THAT(SightingsOf(*store), SizeIs(sightings));
  ASSERT_THAT(VideosOf(*store), SizeIs(1));
  EXPECT_EQ(VideosOf(*store).at(0).name, copy) << "named as last given";
}

TEST(Indexer, FolderFrameRateIsAnOption) {
  const DrawnFlight flight(ShortFlight(3));
  const fs::path folder = flight / "frames";
  fs::create_directory(folder);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(WriteImage(folder / ("frame" + std::to_string(i) + ".png"), flight.flight().Render(i).image));
  }
  RunSetup run;
  run.options.video.folder_frame_rate = 4;
  const auto store = flight.Store("index.db");
  Index(folder.string(), flight.Models(), *store, run);
  EXPECT_EQ(VideosOf(*store).at(0).duration_s, 0.5);
}

// An index or a log file beside the images does not change the content id.
TEST(Indexer, FolderIdIgnoresOtherFiles) {
  const DrawnFlight flight(ShortFlight(3));
  const fs::path folder = flight / "frames";
  fs::create_directory(folder);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(WriteImage(folder / ("frame" + std::to_string(i) + ".png"), flight.flight().Render(i).image));
  }
  const auto store = flight.Store("frames/index.db");
  EXPECT_EQ(Index(folder.string(), flight.Models(), *store).frames_searched, 3);
  ASSERT_TRUE(WriteFileAtomically(folder / "run.log", "a log\n"));
  EXPECT_EQ(Index(folder.string(), flight.Models(), *store).frames_searched, 0);
  EXPECT_EQ(Index("file://" + folder.string(), flight.Models(), *store).frames_searched, 0);
  EXPECT_THAT(VideosOf(*store), SizeIs(1));
}

TEST(Indexer, DamagedVideoIsSearchedUpToTheDamage) {
  const DrawnFlight flight(ShortFlight());
  const std::string whole = ReadFile(flight.video()).value();
  const std::string cut = (flight / "cut.mkv").string();
  ASSERT_TRUE(WriteFileAtomically(cut, whole.substr(0, whole.size() * 6 / 10)));
  std::string hole_bytes = whole;
  std::fill_n(hole_bytes.begin() + static_cast<std::ptrdiff_t>(whole.size() / 2), whole.size() / 8, '\x5a');
  const std::string hole = (flight / "hole.mkv").string();
  ASSERT_TRUE(WriteFileAtomically(hole, hole_bytes));

  const auto store = flight.Store("index.db");
  for (const std::string& video : {cut, hole}) {
    std::vector<std::string> warnings;
    const IndexReport report =
        Index(video, flight.Models(), *store, {}, [&](const std::string& warning) { warnings.push_back(warning); });
    ASSERT_FALSE(warnings.empty()) << video;
    EXPECT_THAT(warnings[0], AllOf(HasSubstr(" s"), Not(HasSubstr("\n"))));
    EXPECT_GT(report.frames_searched, 5);
    EXPECT_LT(report.frames_searched, 20);
    EXPECT_GT(report.sightings, 5);
    EXPECT_EQ(Index(video, flight.Models(), *store).frames_searched, 0) << "its end was reached";
  }
  EXPECT_THAT(VideosOf(*store), SizeIs(2));
}

TEST(Indexer, TrackedSightingsHaveALineOfSight) {
  const DrawnFlight flight(ShortFlight());
  const std::filesystem::path table = flight / "flight.telemetry.csv";
  std::string text = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n";
  for (const int s : {0, 1, 2}) text += std::to_string(s) + ",48,11.000" + std::to_string(s) + ",600,0,-60,0,30\n";
  ASSERT_TRUE(WriteFileAtomically(table, text));
  RunSetup run{.telemetry = table.string()};
  run.options.every = 4;
  run.options.follow.search_interval_s = 1;
  const auto store = flight.Store("index.db");
  Index(flight.video(), flight.Models(), *store, run);
  const std::vector<SightingRecord> sightings = SightingsOf(*store, {.include_rejected = true});
  std::map<std::int64_t, double> recognised_rad;  // by tracklet
  for (const SightingRecord& sighting : sightings) {
    ASSERT_TRUE(sighting.observation) << sighting.frame;
    if (sighting.source != SightingSource::kRecognised) continue;
    recognised_rad[sighting.tracklet] = sighting.observation->line.sigma_rad.value();
  }
  int followed = 0;
  for (const SightingRecord& sighting : sightings) {
    if (sighting.source == SightingSource::kRecognised) continue;
    ++followed;
    EXPECT_NEAR(sighting.observation->line.sigma_rad.value() / recognised_rad.at(sighting.tracklet), 1, 0.3);
  }
  EXPECT_GT(followed, 5);
}

TEST(Indexer, TelemetryThatWasGivenIsUsedAgain) {
  const DrawnFlight flight(ShortFlight());
  const std::filesystem::path table = flight / "given.csv";
  std::string text = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n";
  for (const int s : {0, 1, 2}) text += std::to_string(s) + ",48,11.000" + std::to_string(s) + ",600,0,-60,0,30\n";
  ASSERT_TRUE(WriteFileAtomically(table, text));
  const auto store = flight.Store("index.db");
  Index(flight.video(), {flight.Model(0)}, *store, {.telemetry = table.string()});
  EXPECT_EQ(VideosOf(*store).front().telemetry, table.string());
  Index(flight.video(), {flight.Model(1)}, *store);
  EXPECT_THAT(SightingsOf(*store, {.model_name = flight.flight().ObjectName(1)}), Not(IsEmpty()));
  for (const SightingRecord& sighting : SightingsOf(*store, {.include_rejected = true})) {
    EXPECT_TRUE(sighting.observation) << sighting.model << ' ' << sighting.frame;
  }
  std::filesystem::remove(table);
  std::string warnings;
  Index(flight.video(), {flight.Model(0, 0.5)}, *store, {.redo = Redo::kAlways},
        [&](const auto& said) { warnings += said; });
  EXPECT_THAT(warnings, HasSubstr(table.string() + " that was given for the video is gone"));
}

TEST(Indexer, UnreadableVideoIsAnErrorAndNotStored) {
  const DrawnFlight flight(ShortFlight(12));
  const auto store = flight.Store("index.db");
  ASSERT_TRUE(WriteFileAtomically(flight / "text.mp4", "this is no video\n"));
  for (const auto& [name, code] :
       {std::pair{"none.mp4", ErrorCode::kNotFound}, std::pair{"text.mp4", ErrorCode::kDataLoss}}) {
    const Expected<IndexReport> report = TryIndex((flight / name).string(), flight.Models(), *store);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, code);
    EXPECT_THAT(report.error().message, AllOf(HasSubstr(name), Not(HasSubstr("\n"))));
  }
  EXPECT_THAT(VideosOf(*store), IsEmpty());
}

TEST(Indexer, StoreErrorsAreReturnedAndTheRunCanResume) {
  const DrawnFlight flight(ShortFlight(48));
  const auto store = flight.Store("index.db");
  int commits = 0;
  FaultInjectingStore full(*store, [&]() -> Status {
    if (++commits < 2) return {};
    return Fail(ErrorCode::kNoSpace, "index.db: no space left");
  });
  const Expected<IndexReport> report = TryIndex(flight.video(), flight.Models(), full, ManyCommits());
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error(), (Error{ErrorCode::kNoSpace, "index.db: no space left"}));
  const std::int64_t done = store->FindSearch(1, 1).value().value().next_frame;
  EXPECT_GT(done, 0) << "committed batches are kept";
  EXPECT_LT(done, 48);

  const IndexReport rest = Index(flight.video(), flight.Models(), *store, ManyCommits());
  EXPECT_EQ(rest.frames_searched, 48 - done);
  const auto whole = flight.Store("whole.db");
  Index(flight.video(), flight.Models(), *whole, ManyCommits());
  EXPECT_EQ(Contents(*store), Contents(*whole));
}

TEST(Indexer, ConcurrentProcessesStoreNoDuplicates) {
  const DrawnFlight flight(ShortFlight(12));
  const auto store = flight.Store("index.db");
  bool first = true;
  // Before this process stores its first batch, another one does all of the work.
  FaultInjectingStore raced(*store, [&]() -> Status {
    if (std::exchange(first, false)) Index(flight.video(), flight.Models(), *store);
    return {};
  });
  const Expected<IndexReport> report = TryIndex(flight.video(), flight.Models(), raced);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kConflict);
  const auto whole = flight.Store("whole.db");
  Index(flight.video(), flight.Models(), *whole);
  EXPECT_EQ(Contents(*store), Contents(*whole));
}

// Models of an earlier default stay usable: the video's features are made by their engine.
TEST(Indexer, SearchesWithTheEngineOfTheModels) {
  const DrawnFlight flight(ShortFlight(2));
  const Photo photo = PhotoOf(flight.flight(), 0);
  PhotoModelOptions made_before;
  made_before.features.engine = "opencv";
  ObjectModel model = MakePhotoModel("crate", std::span(&photo, 1), std::nullopt, made_before).value();
  model.id = "crate of opencv";
  std::vector<std::string> warnings;
  const Indexer indexer =
      Indexer::Create({model}, {}, {}, [&](const std::string& line) { warnings.push_back(line); }).value();
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("engine opencv")));
  const auto store = flight.Store("index.db");
  const Expected<IndexReport> report = indexer.Index({.video = flight.video(), .threads = 2}, CancelToken(), *store);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_GT(report->sightings, 0);
  ASSERT_THAT(VideosOf(*store), SizeIs(1));
  EXPECT_THAT(VideosOf(*store)[0].features_json, HasSubstr(R"("engine":"opencv")"));
}

TEST(Indexer, RefusesInvalidModelsAndOptions) {
  const DrawnFlight flight(ShortFlight(2));
  IndexOptions options;
  options.every = -1;
  options.tracklets.gap_s = -1;
  const Expected<Indexer> out_of_range = Indexer::Create(flight.Models(), options);
  ASSERT_FALSE(out_of_range);
  EXPECT_EQ(out_of_range.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(out_of_range.error().message,
              AllOf(HasSubstr("every = -1"), HasSubstr("tracklets.gap_s = -1"), Not(HasSubstr("\n"))));
  ObjectModel other = flight.Model(0);
  other.engine = "someone-elses";
  const Expected<Indexer> other_engine = Indexer::Create({other}, {});
  ASSERT_FALSE(other_engine);
  EXPECT_EQ(other_engine.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(other_engine.error().message, AllOf(HasSubstr("someone-elses"), Not(HasSubstr("\n"))));
}

}  // namespace
}  // namespace victorious
