#include <filesystem>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/drawn_flight.h"
#include "victorious/pipeline/indexer_test.h"

namespace victorious {
namespace {

using testing::Contents;
using testing::DrawnFlight;
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

}  // namespace
}  // namespace victorious
