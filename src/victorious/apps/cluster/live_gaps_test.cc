#include "victorious/apps/cluster/live_gaps.h"

#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/apps/cluster/cluster_test.h"

namespace victorious {
namespace {

using postgres::Recording;
using postgres::Task;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr const char* kSource = "udp://a:1";

CoveredTime Covered(double from_s, double to_s) {
  return {.source = kSource,
          .from_utc_us = static_cast<std::int64_t>(1e6 * from_s),
          .to_utc_us = static_cast<std::int64_t>(1e6 * to_s)};
}

Recording File(double from_s, double to_s) {
  return {.path = "/r/" + std::to_string(static_cast<int>(from_s)) + ".ts",
          .source = kSource,
          .from_utc_us = static_cast<std::int64_t>(1e6 * from_s),
          .to_utc_us = static_cast<std::int64_t>(1e6 * to_s)};
}

TEST(PartsToSearchTest, AreWhatIsNotCoveredOfARecording) {
  const std::vector<CoveredTime> covered = {Covered(100, 130), Covered(145, 190), Covered(191, 210)};
  EXPECT_THAT(PartsToSearch(File(110, 125), covered), IsEmpty());
  EXPECT_THAT(PartsToSearch(File(120, 160), covered), ElementsAre(UtcInterval{130'015'000, 144'985'000}));
  EXPECT_THAT(PartsToSearch(File(120, 131), covered), ElementsAre(UtcInterval{130'015'000, 131'000'000}));
  EXPECT_THAT(PartsToSearch(File(131, 140), covered), ElementsAre(UtcInterval{131'000'000, 140'000'000}));
  EXPECT_THAT(PartsToSearch(File(144, 200), covered), ElementsAre(UtcInterval{144'000'000, 144'985'000}));
  EXPECT_THAT(PartsToSearch(File(185, 195), covered), IsEmpty()) << "a second is no gap";
  EXPECT_THAT(PartsToSearch(File(90, 220), covered),
              ElementsAre(UtcInterval{90'000'000, 99'985'000}, UtcInterval{130'015'000, 144'985'000},
                          UtcInterval{210'015'000, 220'000'000}));
  EXPECT_THAT(PartsToSearch(File(10, 20), {}), ElementsAre(UtcInterval{10'000'000, 20'000'000}));
}

class PostgresLiveGapsTest : public PostgresClusterTest {
 protected:
  void SetUp() override {
    PostgresClusterTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    gaps_ = LiveGaps::Open(url_, "this").value();
    recordings_ = postgres::RecordingStore::Open(url_).value();
    SubmitLive(kSource);
  }

  void Cover(const std::vector<CoveredTime>& covered) {
    const VideoRecord video = store_->PutVideo({.content_id = "live", .name = kSource}).value();
    IndexBatch batch;
    batch.covered = covered;
    std::int64_t frame = 0;
    for (CoveredTime& one : batch.covered) {
      one.video = video.id;
      one.from_frame = frame++;
    }
    ASSERT_TRUE(store_->Commit(batch));
  }

  std::unique_ptr<LiveGaps> gaps_;
  std::unique_ptr<postgres::RecordingStore> recordings_;
};

TEST_F(PostgresLiveGapsTest, GapsAreSearchedFromRecordings) {
  const std::optional<Task> owner = queue_->Claim().value();
  ASSERT_TRUE(owner);
  Cover({Covered(100, 130), Covered(145, 150)});
  for (const Recording& file : {File(90, 120), File(120, 160)}) ASSERT_TRUE(recordings_->Put(file));
  EXPECT_EQ(gaps_->Queue().value(), 1) << "of the first file; the owner may still search the end of the other one";
  EXPECT_EQ(gaps_->Queue().value(), 0) << "once";
  Cover({Covered(100, 130), Covered(145, 170)});
  EXPECT_EQ(gaps_->Queue().value(), 1);

  const Task first = queue_->Claim().value().value();
  const IndexTask work = FromQueue(first.kind, first.payload).value();
  EXPECT_EQ(work.video, "/r/90.ts");
  EXPECT_EQ(work.covers, kSource);
  EXPECT_FALSE(work.is_live);
  EXPECT_THAT(work.options, ElementsAre("--from", "0.000000", "--to", "9.985000"));
  const Task second = queue_->Claim().value().value();
  EXPECT_THAT(FromQueue(second.kind, second.payload)->options, ElementsAre("--from", "10.015000", "--to", "24.985000"));
  EXPECT_FALSE(queue_->Claim().value());
}

TEST_F(PostgresLiveGapsTest, RecordingsAreSearchedWithoutAnOwner) {
  ASSERT_TRUE(recordings_->Put(File(10, 20)));
  Recording other = File(30, 40);
  other.source = "udp://b:1";
  ASSERT_TRUE(recordings_->Put(other));
  EXPECT_EQ(gaps_->Queue().value(), 1) << "of the source that was submitted";
  EXPECT_THAT(recordings_->Unsettled().value(), ElementsAre(other));
  const auto live = queue_->ListLasting().value();
  ASSERT_TRUE(queue_->End(live.front().id));
  ASSERT_TRUE(recordings_->Put(File(50, 60)));
  EXPECT_EQ(gaps_->Queue().value(), 1) << "also once it was ended";
}

}  // namespace
}  // namespace victorious
