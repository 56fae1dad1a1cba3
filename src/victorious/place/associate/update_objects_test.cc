#include "victorious/place/associate/update_objects.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/fault_injecting_store.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/place/associate/packed_fit.h"
#include "victorious/store/index_store.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

constexpr double kFrame_s = 0.2;

Status Update(IndexStore& store, const ObjectOptions& options = {}) {
  return UpdateObjects(options, store, CancelToken(), [](const VideoRecord&, const FlightNotes&) {});
}

// Whole objects as text, to the last bit.
std::vector<std::string> ObjectsOf(IndexStore& store) {
  std::vector<std::string> texts;
  const std::vector<ObjectRecord> objects = store.Objects({.include_rejected = true}).value();
  for (const ObjectRecord& object : objects) {
    ObjectPlace place{.place = object.place, .heading_rad = object.heading_rad};
    std::string text;
    for (const std::byte byte : Pack(HypothesisFits{.absolute = place})) text += static_cast<char>(byte);
    text += object.rejected + "|" + object.place_rejected + "|" + object.evidence_json;
    for (const std::int64_t tracklet : object.tracklets) text += "," + std::to_string(tracklet);
    texts.push_back(std::to_string(object.id) + ":" + std::to_string(object.model) + text);
  }
  std::ranges::sort(texts);
  return texts;
}

// Vehicles on a square, some of which drive, and videos by cameras that circle or fly past. What each store gets is
// the same, so that it has the same ids.
class World {
 public:
  explicit World(std::uint64_t seed) : random_(seed), flights_seed_(1000 * seed) {
    for (int i = 0; i < 7; ++i) {
      Vehicle vehicle{.model = static_cast<int>(random_.Below(4)),
                      .place = {random_.Uniform(-25, 25), random_.Uniform(-25, 25), 1},
                      .velocity = Eigen::Vector3d::Zero()};
      if (random_.Uniform() < 0.35) vehicle.velocity = {random_.Uniform(-6, 6), random_.Uniform(-6, 6), 0};
      vehicles_.push_back(vehicle);
    }
  }

  // Adds a video to a store, in two batches, of which the second lets tracklets of the first grow. `between`: after the
  // first.
  void AddVideo(int number, IndexStore& store, const std::function<void()>& between = [] {}) const {
    std::vector<std::int64_t> models;
    const auto put_model = [&](const std::string& name, ModelKind kind) {
      models.push_back(store.PutModel({.name = name, .content_id = name, .kind = kind})->id);
    };
    put_model("jeep", ModelKind::kCad);
    put_model("truck", ModelKind::kCad);
    put_model("sign", ModelKind::kPhotos);
    put_model("vehicle/car", ModelKind::kCategory);
    const std::string name = "v" + std::to_string(number);
    const std::int64_t video =
        store.PutVideo({.content_id = name, .name = name, .width = 640, .height = 480, .is_of_photos = number == 4})
            ->id;
    std::map<std::size_t, std::int64_t> ids;  // of tracklets, by vehicle
    for (int part = 0; part < 2; ++part) {
      IndexBatch batch;
      std::vector<std::size_t> updated;
      for (std::size_t i = 0; i < vehicles_.size(); ++i) {
        Random random(flights_seed_ + static_cast<std::uint64_t>(100 * number) + i);
        if (random.Uniform() < 0.3) continue;
        const int begin = static_cast<int>(random.Below(10));
        const int end = begin + 6 + static_cast<int>(random.Below(12));
        const int from = part == 0 ? begin : std::max(begin, 12);
        const int to = part == 0 ? std::min(end, 12) : end;
        if (from >= to) continue;
        const std::int64_t model = models.at(static_cast<std::size_t>(vehicles_[i].model));
        const auto known = ids.find(i);
        updated.push_back(i);
        batch.tracklets.push_back({known == ids.end() ? std::nullopt : std::optional(known->second),
                                   {.video = video,
                                    .model = model,
                                    .score = 0.95,
                                    .frames = to - begin,
                                    .first_time_s = kFrame_s * begin,
                                    .last_time_s = kFrame_s * (to - 1)}});
        for (int frame = from; frame < to; ++frame)
          batch.sightings.push_back({batch.tracklets.size() - 1, MakeSighting(number, vehicles_[i], frame, random)});
      }
      for (const std::int64_t model : models) {
        batch.progress.push_back(
            {{.video = video, .model = model, .next_frame = 12 * (part + 1), .options_json = R"({"every": 4})"},
             12 * part});
      }
      const auto committed = store.Commit(batch);
      ASSERT_TRUE(committed) << committed.error().message;
      for (std::size_t k = 0; k < updated.size(); ++k) ids[updated[k]] = committed->at(k);
      if (part == 0) between();
    }
  }

 private:
  struct Vehicle {
    int model = 0;
    Eigen::Vector3d place;
    Eigen::Vector3d velocity;
  };

  // Even videos circle with a wrong yaw, odd ones fly past; one has a wrong field of view.
  static SightingRecord MakeSighting(int number, const Vehicle& vehicle, int frame, Random& random) {
    const double time_s = kFrame_s * frame;
    const double angle = 0.12 * frame + number;
    const Eigen::Vector3d camera = number % 2 == 0 ? Eigen::Vector3d(70 * std::sin(angle), -70 * std::cos(angle), 90)
                                                   : Eigen::Vector3d(-50 + 14 * time_s, -60 - number, 80);
    const Eigen::Vector3d object = vehicle.place + time_s * vehicle.velocity;
    const Eigen::Vector3d line = object - camera;
    const double yaw_error_rad = number == 2 ? RadiansFromDegrees(4) : 0;
    SightingRecord sighting{.frame = frame,
                            .time_s = time_s,
                            .box = {300 + 5 * object.x(), 200 + 5 * object.y(), 40, 30},
                            .outline = {{0, 0}, {9, 0}, {9, 9}},
                            .score = 0.7 + 0.3 * random.Uniform(),
                            .source = frame % 4 == 0 ? SightingSource::kRecognised : SightingSource::kTracked,
                            .matches = 10};
    BearingObservation observation;
    observation.line = {.time_s = time_s,
                        .camera = TangentPlane({0.8, 0.2, 500}).GeodeticFromEnu(camera),
                        .azimuth_rad = std::atan2(line.x(), line.y()) + yaw_error_rad + 1e-3 * random.Normal(),
                        .elevation_rad = std::asin(line.z() / line.norm()) + 1e-3 * random.Normal(),
                        .range_m = line.norm() * (number == 3 ? 0.85 : 1) * (1 + 0.02 * random.Normal()),
                        .sigma_rad = 1e-3};
    observation.line.sigma_range_m = 0.02 * *observation.line.range_m;
    if (vehicle.model == 3) observation.line.range_m.reset();
    if (vehicle.model == 3) observation.line.sigma_range_m.reset();
    if (number == 1) observation.line.clock_shift = ClockShift{.camera_enu_m = {3, 0, 0}};
    observation.heading_rad = WrapAngle(1 + 0.1 * random.Normal());
    sighting.observation = observation;
    return sighting;
  }

  Random random_;
  std::uint64_t flights_seed_;
  std::vector<Vehicle> vehicles_;
};

class UpdateObjectsTest : public ::testing::Test {
 protected:
  std::unique_ptr<IndexStore> MakeStore(const std::string& name) {
    return OpenSqliteStore(folder_.path() / name, StoreMode::kCreate).value();
  }

  std::size_t CountKept(IndexStore& store) {
    std::size_t count = 0;
    EXPECT_TRUE(store.VisitKeptFits([&](KeptFit&&) {
      ++count;
      return true;
    }));
    return count;
  }

  testing::ScratchFolder folder_;
};

// Law: with kept fits, after each half of each video, the objects are those made anew, to the last bit.
TEST_F(UpdateObjectsTest, KeptFitsGiveTheSameObjectsAsNone) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const World world(seed);
    const auto kept = MakeStore("kept" + std::to_string(seed));
    for (int videos = 1; videos <= 5; ++videos) {
      world.AddVideo(videos, *kept, [&] { EXPECT_TRUE(Update(*kept)); });
      ASSERT_TRUE(Update(*kept));
      if (videos % 2 == 0) continue;
      SCOPED_TRACE(videos);
      const auto anew = MakeStore("anew" + std::to_string(seed) + "_" + std::to_string(videos));
      for (int i = 1; i <= videos; ++i) world.AddVideo(i, *anew);
      ASSERT_TRUE(Update(*anew));
      EXPECT_EQ(ObjectsOf(*kept), ObjectsOf(*anew));
      EXPECT_EQ(CountKept(*kept), CountKept(*anew)) << "what is no longer used goes";
    }
    // Without the sightings of one model in one video, which leave objects of several videos.
    const auto anew = MakeStore("less" + std::to_string(seed));
    for (int i = 1; i <= 5; ++i) world.AddVideo(i, *anew);
    for (IndexStore* store : {kept.get(), anew.get()}) {
      ASSERT_TRUE(store->DeleteSearch(3, 1));
      ASSERT_TRUE(Update(*store));
    }
    EXPECT_EQ(ObjectsOf(*kept), ObjectsOf(*anew));
    // Parameters of fits, and those of merging only.
    for (const ObjectOptions& options :
         {ObjectOptions{.merge_gate_sigma = 2}, ObjectOptions{.min_inlier_fraction = 0.8}}) {
      const auto other = MakeStore("other" + std::to_string(seed) + std::to_string(options.merge_gate_sigma));
      for (int i = 1; i <= 5; ++i) world.AddVideo(i, *other);
      ASSERT_TRUE(other->DeleteSearch(3, 1));
      ASSERT_TRUE(Update(*other, options));
      ASSERT_TRUE(Update(*kept, options));
      EXPECT_EQ(ObjectsOf(*kept), ObjectsOf(*other));
    }
  }
}

// An archive that grows changes neither the objects of other videos nor their scores.
TEST_F(UpdateObjectsTest, SearchesOfAnotherVideoChangeNoObject) {
  const World world(5);
  const auto store = MakeStore("index.db");
  world.AddVideo(1, *store);
  ASSERT_TRUE(Update(*store));
  const std::vector<std::string> before = ObjectsOf(*store);
  ASSERT_FALSE(before.empty());
  const auto other = store->PutVideo({.content_id = "other", .name = "other", .width = 640, .height = 480});
  ASSERT_TRUE(other);
  IndexBatch batch;
  batch.progress.push_back(
      {{.video = other->id, .model = 1, .next_frame = 10'000'000, .options_json = R"({"every": 1})"}, 0});
  ASSERT_TRUE(store->Commit(batch));
  ASSERT_TRUE(Update(*store));
  EXPECT_EQ(ObjectsOf(*store), before);
}

TEST_F(UpdateObjectsTest, SightingsOfKeptFitsAreNotRead) {
  const World world(4);
  const auto store = MakeStore("index.db");
  for (int i = 1; i <= 3; ++i) world.AddVideo(i, *store);
  ASSERT_TRUE(Update(*store));
  const std::vector<std::string> before = ObjectsOf(*store);
  testing::FaultInjectingStore blind(
      *store, [] { return Status(); }, []() -> Status { return Fail(ErrorCode::kDataLoss, "sightings"); });
  const auto is_blind = [&](const ObjectOptions& options) {
    const Status status = Update(blind, options);
    return !status && status.error().code == ErrorCode::kDataLoss;
  };
  ASSERT_TRUE(Update(blind));
  EXPECT_EQ(ObjectsOf(*store), before);
  EXPECT_TRUE(Update(blind, {.false_alarm_rate = 0.01})) << "no parameter of a fit";
  EXPECT_TRUE(is_blind({.motion_window_s = 4}));
  const auto damage = [&]() -> Expected<ObjectUpdate> {
    ObjectUpdate update{
        .objects = store->Objects({.include_rejected = true}).value(), .put_fits = {}, .deleted_fits = {}};
    EXPECT_TRUE(store->VisitKeptFits([&](KeptFit&& kept) {
      update.put_fits.push_back({kept.key, {std::byte{0}, std::byte{0xff}}, {}});
      return true;
    }));
    return update;
  };
  ASSERT_TRUE(store->UpdateObjects(damage, CancelToken()));
  EXPECT_TRUE(is_blind({})) << "fits that cannot be read are made again";
  ASSERT_TRUE(Update(*store));
  EXPECT_EQ(ObjectsOf(*store), before);
}

// A new version of the program makes all fits again, which takes hours in a large index.
TEST_F(UpdateObjectsTest, RunThatIsStoppedLeavesItsFitsToTheNext) {
  const World world(6);
  const auto stopped = MakeStore("stopped.db");
  const auto whole = MakeStore("whole.db");
  for (int i = 1; i <= 4; ++i) {
    world.AddVideo(i, *stopped);
    world.AddVideo(i, *whole);
  }
  ASSERT_TRUE(Update(*whole));
  CancelToken cancel;
  cancel.Cancel();
  const auto update = [&](std::chrono::milliseconds interval) {
    return UpdateObjects({}, *stopped, cancel, [](const VideoRecord&, const FlightNotes&) {}, interval);
  };
  int stops = 0;
  Status status;
  while (!(status = update(std::chrono::milliseconds(0))) && stops < 10'000) {
    ASSERT_EQ(status.error().code, ErrorCode::kCancelled) << status.error().message;
    ++stops;
  }
  ASSERT_TRUE(status) << "each run makes some of the fits";
  EXPECT_GT(stops, 4) << "within flights, too";
  EXPECT_EQ(ObjectsOf(*stopped), ObjectsOf(*whole));
  world.AddVideo(5, *stopped);
  EXPECT_TRUE(update(std::chrono::hours(1))) << "one that is short ends";
}

// A store as after an older version of the program, which does not count revisions.
class UncountedStore final : public testing::FaultInjectingStore {
 public:
  explicit UncountedStore(IndexStore& store) : FaultInjectingStore(store, [] { return Status(); }) {}

  [[nodiscard]] Expected<std::vector<TrackletRecord>> Tracklets() override {
    auto records = FaultInjectingStore::Tracklets();
    if (!records) return records;
    for (TrackletRecord& record : *records) record.revision = 0;
    return records;
  }
};

TEST_F(UpdateObjectsTest, TrackletsThatGrewWithoutARevisionAreFittedAgain) {
  const World world(5);
  const auto kept = MakeStore("kept.db");
  const auto anew = MakeStore("anew.db");
  UncountedStore uncounted(*kept);
  world.AddVideo(1, *kept, [&] { EXPECT_TRUE(Update(uncounted)); });
  ASSERT_TRUE(Update(uncounted));
  world.AddVideo(1, *anew);
  ASSERT_TRUE(Update(*anew));
  EXPECT_EQ(ObjectsOf(*kept), ObjectsOf(*anew));
}

TEST_F(UpdateObjectsTest, UnreadableSearchOptionsAreDataLoss) {
  const auto store = MakeStore("index.db");
  const std::int64_t video = store->PutVideo({.content_id = "v", .name = "a.mp4", .width = 64, .height = 48})->id;
  const std::int64_t model = store->PutModel({.name = "jeep", .content_id = "m", .kind = ModelKind::kCad})->id;
  const auto search_with = [&](const std::string& options, std::int64_t from, std::int64_t to) {
    IndexBatch batch;
    batch.progress = {{{.video = video, .model = model, .next_frame = to, .options_json = options}, from}};
    ASSERT_TRUE(store->Commit(batch));
  };
  search_with(R"({"every": 5})", 0, 10);
  EXPECT_TRUE(Update(*store));
  search_with(R"({"every": "5"})", 10, 20);
  const Status status = Update(*store);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kDataLoss);
  EXPECT_THAT(status.error().message, ::testing::AllOf(HasSubstr("a.mp4"), HasSubstr("jeep"), HasSubstr("every")));
}

TEST(PackedFit, IsReadAsItWasWritten) {
  Geolocation place{.point = {0.5, -1, 300}, .time_s = 4, .covariance_enu_m2 = 2 * Eigen::Matrix3d::Identity()};
  place.velocity_enu = Eigen::Vector3d(1, 2, 3);
  place.ce90_m = 7;
  const HypothesisFits fits{
      .relative = ObjectPlace{.place = place, .path_size = 300, .heading_rad = 0.25, .inlier_fraction = 0.5},
      .absolute = std::nullopt,
      .on_level =
          HypothesisFits::LevelFit{.level = {200, 1.5},
                                   .place = {.relative = {.place = place, .path_size = 300}, .absolute = place}},
      .tracklet = HypothesisFits::Tracklet{
          .summary = {.log_odds = 1.5, .recognitions = 2, .by_shape = 1, .missed = 2, .size_px = 80, .observations = 4},
          .frames = {0, 1, 500, 100'000}}};
  const std::vector<std::byte> bytes = Pack(fits);
  const auto read = UnpackHypothesisFits(bytes);
  ASSERT_TRUE(read);
  EXPECT_EQ(Pack(*read), bytes);
  EXPECT_EQ(read->relative->place->point, place.point);
  EXPECT_EQ(read->relative->place->velocity_enu, place.velocity_enu);
  EXPECT_EQ(read->relative->path_size, 300U);
  EXPECT_EQ(read->on_level->level, (Level{200, 1.5}));
  EXPECT_EQ(read->on_level->place.relative.path_size, 300U);
  EXPECT_EQ(read->on_level->place.absolute->ce90_m, 7);
  EXPECT_EQ(read->tracklet->frames, fits.tracklet->frames);
  EXPECT_EQ(read->tracklet->summary.missed, 2);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(UnpackHypothesisFits(std::span(bytes).first(size))) << size;
  const std::vector<Geolocation> path = {place, place};
  EXPECT_EQ(UnpackPath(Pack(path))->size(), 2U);
  const FlightFits flight{.errors = {.heading = HeadingError{0.1, 3}, .range = {}, .lengths = {{7, 0.5, 2}}},
                          .overlaps = {{1, 2, 30}}};
  EXPECT_EQ(UnpackFlightFits(Pack(flight))->overlaps.front().frames, 30);
  EXPECT_EQ(UnpackFlightFits(Pack(flight))->errors.heading->objects, 3);
  EXPECT_EQ(UnpackFlightFits(Pack(flight))->errors.lengths.at(0).factor, 0.5);
}

// What a damaged or hostile index may hold: the bytes of fits that no run makes.
class DamagedPackedFitTest : public ::testing::Test {
 protected:
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();

  static Geolocation MakePlace() {
    return {.point = {0.5, -1, 300}, .time_s = 4, .covariance_enu_m2 = Eigen::Matrix3d::Identity()};
  }

  static bool IsRead(const ObjectPlace& place) {
    const bool is_relative = UnpackHypothesisFits(Pack(HypothesisFits{.relative = place})).has_value();
    const HypothesisFits on_level{
        .on_level = HypothesisFits::LevelFit{.level = {200, 1.5}, .place = {.relative = place, .absolute = {}}}};
    EXPECT_EQ(UnpackHypothesisFits(Pack(on_level)).has_value(), is_relative);
    return is_relative;
  }
  static bool IsRead(const Geolocation& place) {
    const bool is_in_path = UnpackPath(Pack(std::vector<Geolocation>{place})).has_value();
    EXPECT_EQ(IsRead(ObjectPlace{.place = place}), is_in_path);
    return is_in_path;
  }
  static bool IsRead(const Level& level) {
    const HypothesisFits fits{.on_level = HypothesisFits::LevelFit{.level = level, .place = {}}};
    return UnpackHypothesisFits(Pack(fits)).has_value();
  }
  static bool IsRead(const TrackletSummary& summary, const std::vector<std::int64_t>& frames) {
    const HypothesisFits fits{.tracklet = HypothesisFits::Tracklet{.summary = summary, .frames = frames}};
    return UnpackHypothesisFits(Pack(fits)).has_value();
  }
  static bool IsRead(const FlightErrors& errors) {
    return UnpackFlightFits(Pack(FlightFits{.errors = errors, .overlaps = {}})).has_value();
  }
  static bool IsRead(const TrackletOverlap& overlap) {
    return UnpackFlightFits(Pack(FlightFits{.errors = {}, .overlaps = {overlap}})).has_value();
  }
};

TEST_F(DamagedPackedFitTest, APathNeedsAPlace) {
  EXPECT_TRUE(IsRead(ObjectPlace{.place = MakePlace(), .path_size = 3}));
  EXPECT_FALSE(IsRead(ObjectPlace{.path_size = 3}));
}

TEST_F(DamagedPackedFitTest, NumbersAreFiniteAndInTheirRange) {
  ASSERT_TRUE(IsRead(MakePlace()));
  for (const double bad : {kNan, kInfinity, -kInfinity, 1e300}) {
    SCOPED_TRACE(bad);
    const auto is_read_with = [&](auto&& set) {
      Geolocation place = MakePlace();
      set(place);
      return IsRead(place);
    };
    EXPECT_FALSE(is_read_with([&](Geolocation& place) { place.point.latitude_rad = bad; }));
    EXPECT_FALSE(is_read_with([&](Geolocation& place) { place.point.longitude_rad = bad; }));
    EXPECT_FALSE(is_read_with([&](Geolocation& place) { place.point.altitude_m = bad; }));
    EXPECT_FALSE(is_read_with([&](Geolocation& place) { place.time_s = bad; }));
    EXPECT_FALSE(is_read_with([&](Geolocation& place) { place.ce90_m = bad; }));
    EXPECT_FALSE(is_read_with([&](Geolocation& place) { place.le90_m = bad; }));
    EXPECT_FALSE(is_read_with([&](Geolocation& place) { place.covariance_enu_m2(0, 1) = bad; }));
    EXPECT_FALSE(is_read_with([&](Geolocation& place) { place.velocity_enu = Eigen::Vector3d(0, bad, 0); }));
    EXPECT_FALSE(
        is_read_with([&](Geolocation& place) { place.velocity_covariance_enu = Eigen::Matrix3d::Constant(bad); }));
    EXPECT_FALSE(IsRead(ObjectPlace{.heading_rad = bad}));
    EXPECT_FALSE(IsRead(ObjectPlace{.inlier_fraction = bad}));
    EXPECT_FALSE(IsRead(ObjectPlace{.consistent_fraction = bad}));
    EXPECT_FALSE(IsRead(ObjectPlace{.size_ratio = bad}));
    EXPECT_FALSE(IsRead(ObjectPlace{.size_ratio = 1.1, .size_sigma = bad}));
    EXPECT_FALSE(IsRead(TrackletSummary{.size_px = bad}, {}));
    EXPECT_FALSE(IsRead(Level{bad, 1}));
    EXPECT_FALSE(IsRead(Level{200, bad}));
    EXPECT_FALSE(IsRead(TrackletSummary{.log_odds = bad}, {}));
    EXPECT_FALSE(IsRead(FlightErrors{.heading = HeadingError{bad, 3}, .range = {}}));
    EXPECT_FALSE(IsRead(FlightErrors{.heading = {}, .range = RangeFactor{bad, 3}}));
  }
  Geolocation negative_variance = MakePlace();
  negative_variance.covariance_enu_m2(2, 2) = -1;
  EXPECT_FALSE(IsRead(negative_variance));
  EXPECT_FALSE(IsRead(ObjectPlace{.inlier_fraction = 1.5}));
  EXPECT_FALSE(IsRead(ObjectPlace{.size_ratio = 0}));
  EXPECT_FALSE(IsRead(Level{200, 0}));
  EXPECT_TRUE(IsRead(FlightErrors{.heading = HeadingError{-0.1, 2}, .range = RangeFactor{0.8, 2}}));
  EXPECT_FALSE(IsRead(FlightErrors{.heading = {}, .range = RangeFactor{0, 2}}));
  EXPECT_FALSE(IsRead(FlightErrors{.heading = {}, .range = RangeFactor{-1, 2}}));
  EXPECT_FALSE(IsRead(FlightErrors{.heading = HeadingError{0.1, 0}, .range = {}}));
}

TEST_F(DamagedPackedFitTest, FramesAscend) {
  EXPECT_TRUE(IsRead(TrackletSummary(), {0, 1, kMax}));
  EXPECT_FALSE(IsRead(TrackletSummary(), {3, 3}));
  EXPECT_FALSE(IsRead(TrackletSummary(), {3, 2})) << "a step beyond the largest frame";
  EXPECT_FALSE(IsRead(TrackletSummary(), {-1}));
  EXPECT_FALSE(IsRead(TrackletSummary{.recognitions = 2}, {3}));
  EXPECT_FALSE(IsRead(TrackletSummary{.recognitions = 1, .by_shape = 2}, {3, 4}));
  EXPECT_FALSE(IsRead(TrackletSummary{.recognitions = 1, .missed = 3}, {3, 4}));
  EXPECT_FALSE(IsRead(TrackletSummary{.observations = -1}, {3}));
}

TEST_F(DamagedPackedFitTest, OverlapsAreOfTwoTracklets) {
  EXPECT_TRUE(IsRead(TrackletOverlap{1, 2, 30}));
  EXPECT_FALSE(IsRead(TrackletOverlap{2, 2, 30}));
  EXPECT_FALSE(IsRead(TrackletOverlap{-1, 2, 30}));
  EXPECT_FALSE(IsRead(TrackletOverlap{1, 2, 0}));
  EXPECT_FALSE(IsRead(TrackletOverlap{1, 2, kMax})) << "sums of them overflow";
}

// A size that the bytes cannot hold reserves no memory.
TEST_F(DamagedPackedFitTest, SizesAreOfItemsInTheBytes) {
  std::vector<std::byte> path = Pack(std::vector<Geolocation>{MakePlace(), MakePlace()});
  ASSERT_EQ(path.front(), std::byte{2});
  for (const std::uint8_t size : {0, 1, 3, 100}) {
    path.front() = std::byte{size};
    EXPECT_FALSE(UnpackPath(path)) << int{size};
  }
  // 2^63 places, a count of more than 64 bits, and one with a byte too many.
  std::vector<std::byte> count(9, std::byte{0x80});
  count.push_back(std::byte{1});
  EXPECT_FALSE(UnpackPath(count));
  count.back() = std::byte{2};
  EXPECT_FALSE(UnpackPath(count));
  EXPECT_FALSE(UnpackPath(std::vector<std::byte>{std::byte{0x80}, std::byte{0}}));
  EXPECT_TRUE(UnpackPath(std::vector<std::byte>{std::byte{0}}));
}

}  // namespace
}  // namespace victorious
