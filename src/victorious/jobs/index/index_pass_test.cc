#include "victorious/jobs/index/index_pass.h"

#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/drawn_flight.h"
#include "testing/klv_tools.h"
#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

using ::testing::AllOf;
using testing::CameraPacket;
using testing::DrawnFlight;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::ShortFlight;
using testing::SightingsOf;
using testing::VideosOf;

constexpr std::int64_t kPassFrames = 200;

// Grey images, 10 per second; `before_frame` is called with the index of each.
class FakeReader final : public VideoReader {
 public:
  FakeReader(bool live, std::function<void(std::int64_t)> before_frame) : before_frame_(std::move(before_frame)) {
    info_.live = live;
    info_.frame_count = kPassFrames;
  }

  [[nodiscard]] const VideoInfo& info() const override { return info_; }
  [[nodiscard]] Expected<std::string> ContentId(const CancelToken& /*cancel*/,
                                                const ByteProgress& /*progress*/) const override {
    return "fake";
  }
  Expected<std::optional<Frame>> NextFrame() override {
    if (next_ == kPassFrames) return std::nullopt;
    before_frame_(next_);
    if (next_ == broken_at) return Fail(ErrorCode::kInternal, "broken");
    const std::int64_t index = next_++;
    if (packet_of) packets_ = packet_of(index);
    const cv::Mat image = image_of ? image_of(index) : cv::Mat(32, 32, CV_8UC1, 128.0);
    const double time_s = static_cast<double>(index) / 10 + (index >= interrupted_at ? kInterruption_s : 0);
    return Frame{.index = index, .time_s = time_s, .image = image};
  }
  [[nodiscard]] std::optional<std::int64_t> ArrivalUtc(double time_s) const override {
    return info_.live ? std::optional(kFirstUtc_us + std::llround(1e6 * time_s)) : std::nullopt;
  }
  std::vector<DataPacket> TakeDataPackets() override { return std::exchange(packets_, {}); }
  bool SeekTo(double /*time_s*/) override { return false; }
  void SkipToEnd() override { next_ = kPassFrames; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }
  [[nodiscard]] const std::vector<std::string>& notes() const override { return is_note ? warnings_ : none_; }

  void AddStream(StreamType type) { info_.streams.push_back({.index = 1, .type = type, .codec = {}}); }

  static constexpr std::int64_t kFirstUtc_us = 1'700'000'000'000'000;
  static constexpr double kInterruption_s = 5;
  std::int64_t interrupted_at = kPassFrames;  // from this frame on, frames are later
  std::int64_t broken_at = -1;
  bool is_note = false;                                            // the warning is no damage
  std::function<cv::Mat(std::int64_t)> image_of;                   // grey image; default: a uniform one
  std::function<std::vector<DataPacket>(std::int64_t)> packet_of;  // data packets that arrive with a frame

 private:
  VideoInfo info_;
  std::vector<DataPacket> packets_;
  std::function<void(std::int64_t)> before_frame_;
  std::int64_t next_ = 0;
  std::vector<std::string> warnings_ = {"at 0.10 s: something damaged"};
  std::vector<std::string> none_;
};

// One pass over a fake video, into its own index.
class IndexPassTest : public ::testing::Test {
 protected:
  Status Run(VideoReader& reader, std::int64_t first_frame = 0) {
    const VideoRecord video = store_
                                  ->PutVideo({.content_id = "fake",
                                              .name = "fake.mp4",
                                              .width = 32,
                                              .height = 32,
                                              .frame_count = {},
                                              .duration_s = {},
                                              .features_json = {}})
                                  .value();
    const ObjectModel model = flight_.Model(0);
    const ModelRecord stored =
        store_->PutModel({.name = model.name, .content_id = model.id, .kind = model.kind}).value();
    const IndexOptions options;
    const std::vector<SearchRecord> searches = {{.video = video.id,
                                                 .model = stored.id,
                                                 .next_frame = first_frame,
                                                 .finished = false,
                                                 .options_json = "{}",
                                                 .program_version = "test"}};
    const Recognizer recognizer = Recognizer::Create({model}, options.features.engine, options.recognize).value();
    const auto extractor = MakeFeatureExtractor(options.features).value();
    CameraStates cameras = CameraStates::ForLive(reader.info(), options.telemetry);
    const IndexJob job{.video = video.name, .threads = 2};
    const IndexPass pass{.job = job,
                         .video = video,
                         .searches = searches,
                         .recognizer = recognizer,
                         .extractor = *extractor,
                         .kept_extractor = *extractor,
                         .options = options,
                         .cameras = cameras,
                         .source = source_,
                         .recorded_utc_us = recorded_utc_us_};
    const Status status = RunIndexPass(
        pass, reader, cancel_, *store_, [&](const std::string& warning) { warnings_.push_back(warning); }, report_);
    search_ = store_->FindSearch(video.id, stored.id).value();
    return status;
  }

  DrawnFlight flight_{ShortFlight(1)};
  std::unique_ptr<IndexStore> store_ = flight_.Store("index.db");
  std::string source_;
  std::optional<std::int64_t> recorded_utc_us_;
  CancelToken cancel_;
  IndexReport report_;
  std::vector<std::string> warnings_;
  std::optional<SearchRecord> search_;
};

TEST_F(IndexPassTest, CancelledLiveSourceIsComplete) {
  FakeReader reader(/*live=*/true, [&](std::int64_t frame) {
    if (frame == 20) cancel_.Cancel();
  });
  const Status status = Run(reader);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_TRUE(report_.stopped_live);
  EXPECT_EQ(report_.frames_searched + report_.frames_left_out, 21);
  ASSERT_TRUE(search_);
  EXPECT_TRUE(search_->finished);
  EXPECT_EQ(search_->next_frame, 21);
  EXPECT_EQ(VideosOf(*store_).at(0).frame_count, 21);
  EXPECT_THAT(warnings_, ElementsAre("at 0.10 s: something damaged"));
}

TEST_F(IndexPassTest, TimesOfALiveSourceAreCovered) {
  FakeReader reader(/*live=*/true, [&](std::int64_t frame) {
    if (frame == 40) cancel_.Cancel();
  });
  reader.interrupted_at = 20;
  source_ = "udp://a";
  ASSERT_TRUE(Run(reader));
  const std::vector<CoveredTime> covered = store_->CoveredTimes("udp://a").value();
  ASSERT_EQ(covered.size(), 2U);
  EXPECT_EQ(covered[0].from_utc_us, FakeReader::kFirstUtc_us);
  EXPECT_EQ(covered[0].to_utc_us, FakeReader::kFirstUtc_us + 1'900'000);
  EXPECT_EQ(covered[1].from_frame, 20);
  EXPECT_EQ(covered[1].from_utc_us, FakeReader::kFirstUtc_us + 7'000'000);
  EXPECT_EQ(covered[1].to_utc_us, FakeReader::kFirstUtc_us + 9'000'000);
}

TEST_F(IndexPassTest, PartsThatWereSearchedAreStored) {
  FakeReader reader(/*live=*/false, [](std::int64_t /*frame*/) {});
  reader.interrupted_at = 20;
  ASSERT_TRUE(Run(reader));
  const std::vector<SearchPart> parts = store_->SearchParts(search_->video).value();
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[0].to_frame, 20);
  EXPECT_NEAR(parts[0].to_s, 1.9, 1e-9);
  EXPECT_EQ(parts[1].kind, SearchPartKind::kDamaged);
  EXPECT_NEAR(parts[1].to_s, 7, 1e-9);
  EXPECT_EQ(parts[2].from_frame, 20);
  EXPECT_EQ(parts[2].to_frame, kPassFrames);
}

TEST_F(IndexPassTest, ANoteOfTheReaderIsNoDamage) {
  FakeReader reader(/*live=*/false, [](std::int64_t /*frame*/) {});
  reader.interrupted_at = 20;
  reader.is_note = true;
  ASSERT_TRUE(Run(reader));
  EXPECT_EQ(
      std::ranges::count(store_->SearchParts(search_->video).value(), SearchPartKind::kDamaged, &SearchPart::kind), 0);
}

TEST_F(IndexPassTest, TimesOfARecordingAreCovered) {
  FakeReader reader(/*live=*/false, [](std::int64_t /*frame*/) {});
  source_ = "udp://a";
  recorded_utc_us_ = 1'000'000;
  ASSERT_TRUE(Run(reader));
  const std::vector<CoveredTime> covered = store_->CoveredTimes("udp://a").value();
  ASSERT_EQ(covered.size(), 1U);
  EXPECT_EQ(covered[0].from_utc_us, 1'000'000);
  EXPECT_EQ(covered[0].to_utc_us, 1'000'000 + (kPassFrames - 1) * 100'000);
}

// The frames since the last restart of the tracks are held for what later frames may add.
TEST_F(IndexPassTest, CancelledFileNamesVideoAndFrame) {
  FakeReader reader(/*live=*/false, [&](std::int64_t frame) {
    if (frame == 80) cancel_.Cancel();
  });
  const Status status = Run(reader);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kCancelled);
  EXPECT_EQ(status.error().message, "fake.mp4: stopped at frame 60; run again to resume");
  EXPECT_FALSE(report_.stopped_live);
  ASSERT_TRUE(search_);
  EXPECT_FALSE(search_->finished);
  EXPECT_THAT(warnings_, ElementsAre("at 0.10 s: something damaged"));
}

TEST_F(IndexPassTest, FailedLiveSourceIsNotComplete) {
  FakeReader reader(/*live=*/true, [](std::int64_t /*frame*/) {});
  reader.broken_at = 20;
  const Status status = Run(reader);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message, "broken");
  EXPECT_FALSE(report_.stopped_live);
  EXPECT_FALSE(search_.value().finished);
  EXPECT_THAT(warnings_, ElementsAre("at 0.10 s: something damaged"));
}

TEST_F(IndexPassTest, SightingsOfALiveSourceAreStoredAtOnce) {
  std::size_t stored = 0;
  FakeReader reader(/*live=*/true, [&](std::int64_t frame) {
    // The frames that are read ahead are fewer.
    if (frame == 12) stored = SightingsOf(*flight_.Store("index.db")).size();
    if (frame == 12) cancel_.Cancel();
  });
  reader.image_of = [&](std::int64_t /*frame*/) { return GreyFromBgr(flight_.flight().Render(0).image); };
  ASSERT_TRUE(Run(reader));
  EXPECT_GT(stored, 0U) << "while the source goes on";
}

TEST_F(IndexPassTest, ProgressIncludesFramesBeforeTheFirst) {
  FakeReader reader(/*live=*/false, [&](std::int64_t frame) {
    if (frame == 20) cancel_.Cancel();
  });
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(Run(reader, /*first_frame=*/100));
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), AllOf(HasSubstr("fake.mp4"), HasSubstr("21 of 200 frames")));
}

TEST_F(IndexPassTest, LiveTelemetryGivesPlaces) {
  FakeReader reader(/*live=*/true, [&](std::int64_t frame) {
    if (frame == 14) cancel_.Cancel();
  });
  reader.AddStream(StreamType::kData);
  reader.image_of = [&](std::int64_t /*frame*/) { return GreyFromBgr(flight_.flight().Render(0).image); };
  reader.packet_of = [](std::int64_t frame) -> std::vector<DataPacket> {
    if (frame % 5 != 0) return {};  // 2 per second, from an altitude of 1000 m
    const std::string text = CameraPacket(1'700'000'000'000'000 + static_cast<std::uint64_t>(frame) * 100'000);
    const Bytes bytes = AsBytes(text);
    return {{.stream = 1,
             .kind = DataKind::kKlv,
             .time_s = static_cast<double>(frame) / 10,
             .bytes = {bytes.begin(), bytes.end()}}};
  };
  const Status status = Run(reader);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(VideosOf(*store_).at(0).frame_count, 15);
  const std::vector<SightingRecord> sightings = SightingsOf(*store_);
  ASSERT_EQ(sightings.size(), 15U);
  for (const SightingRecord& sighting : sightings) {
    EXPECT_EQ(sighting.observation.has_value(), sighting.frame <= 10) << sighting.frame;  // up to the last packet
  }
}

}  // namespace
}  // namespace victorious
