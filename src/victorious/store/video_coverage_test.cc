#include "victorious/store/video_coverage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Ten frames a second.
SearchPart Part(std::int64_t from_frame, std::int64_t to_frame, SearchPartKind kind = SearchPartKind::kSearched,
                std::int64_t model = 1) {
  return {.video = 1,
          .model = model,
          .kind = kind,
          .from_frame = from_frame,
          .to_frame = to_frame,
          .from_s = static_cast<double>(from_frame) / 10,
          .to_s = static_cast<double>(to_frame - 1) / 10};
}

SearchRecord Search(bool finished, std::int64_t model = 1) {
  return {.video = 1, .model = model, .next_frame = 1, .finished = finished, .options_json = {}, .program_version = {}};
}

std::vector<ModelRecord> Models(std::int64_t number) {
  std::vector<ModelRecord> models;
  for (std::int64_t id = 1; id <= number; ++id) models.push_back({.id = id, .name = {}, .content_id = {}});
  return models;
}

class VideoCoverageTest : public ::testing::Test {
 protected:
  SearchCoverage Of(bool finished, const std::vector<SearchPart>& parts) {
    const SearchRecord search = Search(finished);
    return CoverageOf(video_, &search, parts);
  }

  VideoRecord video_{.id = 1, .content_id = {}, .name = {}, .frame_count = 101, .duration_s = 10};
};

TEST_F(VideoCoverageTest, WholeVideo) {
  const SearchCoverage coverage = Of(true, {Part(0, 101)});
  EXPECT_THAT(coverage.searched, ElementsAre(TimeInterval{0, 10}));
  EXPECT_THAT(coverage.left_out, IsEmpty());
  EXPECT_EQ(coverage.frames, 101);
}

TEST_F(VideoCoverageTest, PartThatWasAskedFor) {
  const SearchCoverage both = Of(true, {Part(20, 41)});
  EXPECT_THAT(both.searched, ElementsAre(TimeInterval{2, 4}));
  EXPECT_THAT(both.left_out, ElementsAre(LeftOutTime{0, 2, LeftOutReason::kNotWanted, {}},
                                         LeftOutTime{4, 10, LeftOutReason::kNotWanted, {}}));
  video_.duration_s.reset();
  EXPECT_THAT(Of(true, {Part(0, 41)}).left_out,
              ElementsAre(LeftOutTime{4, std::nullopt, LeftOutReason::kNotWanted, {}}));
}

TEST_F(VideoCoverageTest, StoppedRun) {
  EXPECT_THAT(Of(false, {Part(0, 41)}).left_out, ElementsAre(LeftOutTime{4, 10, LeftOutReason::kNotYet, {}}));
  EXPECT_THAT(Of(false, {}).left_out, ElementsAre(LeftOutTime{0, 10, LeftOutReason::kNotYet, {}}));
  EXPECT_THAT(CoverageOf(video_, nullptr, {}).left_out, ElementsAre(LeftOutTime{0, 10, LeftOutReason::kNotBegun, {}}));
}

TEST_F(VideoCoverageTest, PaceAndDamage) {
  SearchPart damaged = Part(60, 60, SearchPartKind::kDamaged);
  damaged.from_s = 5.9;
  damaged.to_s = 8;
  SearchPart last = Part(60, 81);
  last.from_s = 8;
  last.to_s = 10;
  const SearchCoverage coverage =
      Of(true, {Part(0, 21), Part(21, 41, SearchPartKind::kThinned), Part(41, 60), damaged, last});
  EXPECT_THAT(coverage.searched, ElementsAre(TimeInterval{0, 2.1}, TimeInterval{4.1, 5.9}, TimeInterval{8, 10}));
  EXPECT_THAT(coverage.left_out, ElementsAre(LeftOutTime{2.1, 4.1, LeftOutReason::kThinned, {}},
                                             LeftOutTime{5.9, 8, LeftOutReason::kDamaged, {}}));
  EXPECT_EQ(coverage.frames, 81);
}

TEST_F(VideoCoverageTest, QuarantinedSegments) {
  const auto failed = LeftOutTime{2, 4, LeftOutReason::kFailed, {}};
  const SearchCoverage known = Of(true, {Part(0, 20), Part(20, 40, SearchPartKind::kFailed), Part(40, 101)});
  EXPECT_THAT(known.left_out, ElementsAre(failed));
  EXPECT_THAT(known.searched, ElementsAre(TimeInterval{0, 2}, TimeInterval{4, 10}));
  const SearchCoverage older = Of(true, {Part(0, 101), Part(20, 40, SearchPartKind::kFailed)});
  EXPECT_THAT(older.searched, ElementsAre(TimeInterval{0, 2}, TimeInterval{3.9, 10})) << "made by an older version";
  EXPECT_EQ(older.left_out.size(), 1U);
  EXPECT_EQ(Of(true, {Part(0, 20), Part(40, 101)}).left_out.front().reason, LeftOutReason::kFailed);
}

TEST_F(VideoCoverageTest, OfAllModels) {
  const std::vector<SearchRecord> searches = {Search(true, 1), Search(true, 2)};
  const std::vector<SearchPart> parts = {Part(0, 101, {}, 1), Part(20, 41, {}, 2)};
  const VideoCoverage coverage = CoverageOf(video_, Models(3), searches, parts);
  EXPECT_THAT(coverage.searched, IsEmpty());
  EXPECT_THAT(coverage.left_out, ElementsAre(LeftOutTime{0, 2, LeftOutReason::kNotWanted, {2}},
                                             LeftOutTime{0, 10, LeftOutReason::kNotBegun, {3}},
                                             LeftOutTime{4, 10, LeftOutReason::kNotWanted, {2}}));
  EXPECT_EQ(coverage.searched_s, 10);
  EXPECT_FALSE(coverage.IsWhole());
  const VideoCoverage of_two = CoverageOf(video_, Models(2), searches, parts);
  EXPECT_THAT(of_two.searched, ElementsAre(TimeInterval{2, 4}));
  const VideoCoverage of_one = CoverageOf(video_, Models(1), searches, parts);
  EXPECT_TRUE(of_one.IsWhole());
}

TEST_F(VideoCoverageTest, ModelsThatAgreeAreOne) {
  const std::vector<SearchRecord> searches = {Search(true, 1), Search(true, 2)};
  const VideoCoverage coverage =
      CoverageOf(video_, Models(2), searches, std::vector{Part(0, 51, {}, 1), Part(0, 51, {}, 2)});
  EXPECT_THAT(coverage.left_out, ElementsAre(LeftOutTime{5, 10, LeftOutReason::kNotWanted, {}}));
  EXPECT_THAT(CoverageOf(video_, {}, {}, {}).left_out, ElementsAre(LeftOutTime{0, 10, LeftOutReason::kNotBegun, {}}));
  EXPECT_FALSE(CoverageOf(video_, {}, {}, {}).IsWhole());
}

TEST_F(VideoCoverageTest, NothingIsSearchedForWhatWasBoxed) {
  std::vector<ModelRecord> models = Models(2);
  models[1].kind = ModelKind::kCategory;
  models[1].content_id = kBoxedContentId;
  const std::vector<SearchRecord> searches = {Search(true)};
  EXPECT_TRUE(CoverageOf(video_, models, searches, std::vector{Part(0, 101)}).IsWhole());
  EXPECT_THAT(CoverageOf(video_, models, {}, {}).left_out,
              ElementsAre(LeftOutTime{0, 10, LeftOutReason::kNotBegun, {}}));
  EXPECT_FALSE(CoverageOf(video_, std::vector{models[1]}, {}, {}).IsWhole());
}

}  // namespace
}  // namespace victorious
