#include "victorious/show/sighting_evidence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/drawn_flight.h"
#include "testing/drawn_objects.h"

namespace victorious {
namespace {

using testing::DrawnFlight;
using ::testing::HasSubstr;
using testing::ShortFlight;

cv::Mat FrameAt(const std::string& video, std::int64_t number) {
  const auto reader = VideoReader::Open(video, {}).value();
  while (std::optional<Frame> frame = reader->NextFrame().value()) {
    if (frame->index == number) return frame->image;
  }
  return {};
}

// The sightings of an index are explained from what the store keeps of them: each inlier of the stored pose is found
// again.
TEST(ExplainSighting, FindsTheStoredPoseAgain) {
  const DrawnFlight flight(ShortFlight());
  const ObjectModel model = flight.Model(0);
  const std::unique_ptr<IndexStore> store = flight.Store("index.db");
  IndexOptions options;
  options.follow.enabled = false;  // a tracked sighting need not match
  const IndexJob job{.video = flight.video(), .threads = 2, .from_s = 0.0};
  ASSERT_TRUE(Indexer::Create({model}, options).value().Index(job, CancelToken(), *store));
  const std::vector<SightingRecord> sightings = store->Sightings({.include_rejected = true}).value();
  ASSERT_GE(sightings.size(), 3U);
  const SearchRecord search = store->FindSearch(sightings.front().video, sightings.front().model).value().value();
  for (const SightingRecord& sighting : {sightings.front(), sightings[sightings.size() / 2], sightings.back()}) {
    const cv::Mat grey = FrameAt(flight.video(), sighting.frame);
    ASSERT_FALSE(grey.empty());
    const auto evidence = ExplainSighting(sighting, search.options_json, model, grey, {});
    ASSERT_TRUE(evidence) << evidence.error().message;
    ASSERT_TRUE(evidence->detection.has_value());
    EXPECT_EQ(evidence->stages.back().matches, static_cast<std::size_t>(sighting.matches));
    EXPECT_NEAR(evidence->detection->score, sighting.score, 1e-6);
    EXPECT_GT(IntersectionOverUnion(evidence->detection->box, sighting.box), 0.99);
  }
}

// Between full-frame searches a sighting was recognised in its region, in which it is found again.
TEST(ExplainSighting, FindsWhatWasRecognisedInARegion) {
  const DrawnFlight flight(ShortFlight());
  const ObjectModel model = flight.Model(0);
  const std::unique_ptr<IndexStore> store = flight.Store("index.db");
  IndexOptions options;
  options.every = 4;
  const IndexJob job{.video = flight.video(), .threads = 2, .from_s = 0.0};
  ASSERT_TRUE(Indexer::Create({model}, options).value().Index(job, CancelToken(), *store));
  const std::vector<SightingRecord> sightings = store->Sightings({.include_rejected = true}).value();
  int in_regions = 0;
  for (const SightingRecord& sighting : sightings) {
    if (sighting.source != SightingSource::kRecognised || sighting.frame % options.every == 0) continue;
    ++in_regions;
    const SearchRecord search = store->FindSearch(sighting.video, sighting.model).value().value();
    const auto evidence =
        ExplainSighting(sighting, search.options_json, model, FrameAt(flight.video(), sighting.frame), {});
    ASSERT_TRUE(evidence) << evidence.error().message;
    ASSERT_TRUE(evidence->detection.has_value()) << sighting.frame;
    EXPECT_NEAR(static_cast<double>(evidence->stages.back().matches), sighting.matches, 0.2 * sighting.matches);
    EXPECT_GT(IntersectionOverUnion(evidence->detection->box, sighting.box), 0.9);
  }
  EXPECT_GE(in_regions, 3);
}

TEST(ExplainSighting, RefusesOptionsOfAnotherVersion) {
  for (const char* const options : {"", "[]", R"({"no_such_option": 1})"}) {
    const auto evidence = ExplainSighting({}, options, {}, {}, {});
    ASSERT_FALSE(evidence) << options;
    EXPECT_EQ(evidence.error().code, ErrorCode::kUnsupported);
    EXPECT_THAT(evidence.error().message, HasSubstr("--redo"));
    EXPECT_FALSE(TelemetryOptionsOf(options));
  }
}

}  // namespace
}  // namespace victorious
