#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/drawn_flight.h"
#include "victorious/base/file.h"
#include "victorious/base/options.h"
#include "victorious/jobs/index/indexer_test.h"

namespace victorious {
namespace {

using testing::Contents;
using testing::DrawnFlight;
using testing::FlightOptions;
using testing::ObjectsOf;
using testing::ShortFlight;
using testing::SightingsOf;

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(IndexerParameters, OtherParametersAreRefusedAndChangeNothing) {
  const DrawnFlight flight(ShortFlight(12));
  const auto store = flight.Store("index.db");
  Index(flight.video(), flight.Models(), *store);
  const std::string before = Contents(*store);

  RunSetup ratio;
  ratio.options.recognize.match.ratio = 0.7;
  RunSetup edge;
  edge.options.features.edge_threshold = 12;
  edge.options.tracklets.gap_s = 3;
  for (const auto& [run, difference] : {std::pair<RunSetup, std::string>{ratio, "match.ratio was 0.8, is 0.7"},
                                        std::pair<RunSetup, std::string>{edge, "edge_threshold was 20.0, is 12.0"}}) {
    // A changed model does not drop stored results before it has been searched for.
    const Expected<IndexReport> report = TryIndex(flight.video(), {flight.Model(0, 0.8), flight.Model(1)}, *store, run);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(report.error().message,
                AllOf(HasSubstr(flight.video()), HasSubstr(difference), HasSubstr("--redo"), Not(HasSubstr("\n"))));
    EXPECT_EQ(Contents(*store), before);
    const std::string copy = flight.video() + ".copy.mkv";
    fs::copy_file(flight.video(), copy, fs::copy_options::overwrite_existing);
    EXPECT_FALSE(TryIndex(copy, flight.Models(), *store, run));
    EXPECT_EQ(Contents(*store), before) << "the name, too";
  }
}

TEST(IndexerParameters, RedoIfDifferentKeepsWhatWasMadeWithTheSameParameters) {
  const DrawnFlight flight(ShortFlight(12));
  const auto store = flight.Store("index.db");
  RunSetup run{.redo = Redo::kIfDifferent};
  for (const double ratio : {0.8, 0.7}) {
    run.options.recognize.match.ratio = ratio;
    EXPECT_EQ(Index(flight.video(), flight.Models(), *store, run).frames_searched, 12) << ratio;
    const std::string searched = Contents(*store);
    EXPECT_EQ(Index(flight.video(), flight.Models(), *store, run).frames_searched, 0) << ratio;
    EXPECT_EQ(Contents(*store), searched);
  }
}

TEST(IndexerParameters, RedoSearchesAgainWithOtherParameters) {
  const DrawnFlight flight(ShortFlight());
  RunSetup other = ManyCommits();
  other.options.every = 2;
  other.options.recognize.match.ratio = 0.7;
  const auto fresh = flight.Store("fresh.db");
  Index(flight.video(), flight.Models(), *fresh, other);

  const auto store = flight.Store("index.db");
  Index(flight.video(), flight.Models(), *store, ManyCommits());
  other.redo = Redo::kAlways;
  const IndexReport report = Index(flight.video(), flight.Models(), *store, other);
  EXPECT_EQ(report.frames_searched, flight.flight().options().frames / 2);
  EXPECT_EQ(SightingsOf(*store).size(), SightingsOf(*fresh).size());
  EXPECT_EQ(ObjectsOf(*store).size(), ObjectsOf(*fresh).size());
  int kept = 0;
  ASSERT_TRUE(store->VisitKeptFrames({}, [&](const KeptFrame& frame) {
    EXPECT_EQ(frame.frame % 2, 0) << "kept by the previous run";
    ++kept;
    return true;
  }));
  EXPECT_EQ(kept, flight.flight().options().frames / 2);
}

// From 100 m above the ground, straight down.
constexpr std::string_view kTelemetry =
    "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n"
    "0,48,11,600,0,-90,0,40\n5,48,11,600,0,-90,0,40\n";

TEST(IndexerParameters, LargeFramesAreSearchedShrunkAndFoundInPixelsOfTheFrame) {
  FlightOptions large = ShortFlight(12);
  large.width *= 3;
  large.height *= 3;
  large.object_scale *= 3;
  const DrawnFlight flight(large);
  const std::string telemetry = (flight / "t.csv").string();
  ASSERT_TRUE(WriteFileAtomically(telemetry, kTelemetry));
  std::vector<ObjectModel> models = flight.Models();
  for (ObjectModel& model : models) {
    model.box_m = Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), Eigen::Vector3d(6, 8, 0));  // 10 m across
  }
  RunSetup run{.telemetry = telemetry};
  run.options.ground.height_m = 500;
  run.options.keep.interval_s = -1;

  run.options.resolution.object_px = 0;
  const auto filmed = flight.Store("filmed.db");
  Index(flight.video(), models, *filmed, run);
  const std::vector<SightingRecord> expected = SightingsOf(*filmed);
  ASSERT_GT(expected.size(), 12U);

  // 10 m are some 100 px at the farthest ground, in the corners; 640 px of a side remain.
  ASSERT_TRUE(SetFromJsonText(R"({"resolution.object_px": 40})", CollectFields(run.options)));
  const auto shrunk = flight.Store("shrunk.db");
  Index(flight.video(), models, *shrunk, run);
  const std::vector<SightingRecord> found = SightingsOf(*shrunk);
  EXPECT_GT(found.size(), expected.size() * 8 / 10);
  int same = 0;
  for (const SightingRecord& one : found) {
    same += std::ranges::any_of(expected, [&](const SightingRecord& other) {
      return other.frame == one.frame && other.model == one.model && IntersectionOverUnion(other.box, one.box) > 0.8 &&
             IntersectionOverUnion(BoundingBox(other.outline), BoundingBox(one.outline)) > 0.8 && other.box != one.box;
    });
  }
  EXPECT_GT(same, static_cast<int>(found.size()) * 9 / 10);
}

}  // namespace
}  // namespace victorious
