// Formats of one video: CVAT, WebVTT, VMTI. And CZML.
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "testing/data.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/st0601.h"
#include "victorious/show/export/export.h"

namespace victorious {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

// A video of 100 frames, 10 a second. A jeep is seen in frames 10, 12 and 50, a box <&> in the last frame.
class ExportVideoTest : public ::testing::Test {
 protected:
  void SetUp() override {
    store_ = *OpenSqliteStore(folder_ / "index.db", StoreMode::kCreate);
    video_ = {.content_id = "1", .name = "a.mp4", .width = 640, .height = 480, .start_utc_us = kStart_us};
    video_.id = store_->PutVideo(video_)->id;
    const auto jeep = *store_->PutModel({.name = "jeep", .content_id = "1", .kind = ModelKind::kCad});
    const auto box = *store_->PutModel({.name = "box <&>", .content_id = "2", .kind = ModelKind::kPhotos});
    IndexBatch batch;
    batch.tracklets.push_back(
        {std::nullopt,
         {.video = video_.id, .model = jeep.id, .score = 0.9, .frames = 3, .first_time_s = 1, .last_time_s = 5}});
    batch.tracklets.push_back(
        {std::nullopt,
         {.video = video_.id, .model = box.id, .score = 0.8, .frames = 1, .first_time_s = 9.9, .last_time_s = 9.9}});
    for (const std::int64_t frame : {10, 12, 50}) batch.sightings.push_back({0, SightingIn(frame)});
    batch.sightings.push_back({1, SightingIn(99)});
    ASSERT_TRUE(store_->Commit(batch));
  }

  static SightingRecord SightingIn(std::int64_t frame) {
    return {.frame = frame, .time_s = static_cast<double>(frame) / 10, .box = {10, 20, 20, 30}, .score = 0.9};
  }

  std::string Text(std::string_view format) {
    std::ostringstream out;
    const Status status = Export(*store_, **FindExportFormat(format), {}, out);
    EXPECT_TRUE(status) << status.error().message;
    return out.str();
  }

  std::string Refusal(std::string_view format) {
    std::ostringstream out;
    const Status status = Export(*store_, **FindExportFormat(format), {}, out);
    return status ? "" : status.error().message;
  }

  static constexpr std::int64_t kStart_us = 1'700'000'000'000'000;
  testing::ScratchFolder folder_;
  VideoRecord video_;
  std::unique_ptr<IndexStore> store_;
};

TEST_F(ExportVideoTest, CvatEndsATrackWhereTheObjectIsOutOfView) {
  const std::string text = Text("cvat");
  const auto box = [](int frame, int outside) {
    return "<box frame=\"" + std::to_string(frame) + "\" keyframe=\"1\" outside=\"" + std::to_string(outside) + "\"";
  };
  for (const auto& [frame, outside] : {std::pair(10, 0), {12, 0}, {13, 1}, {50, 0}, {51, 1}, {99, 0}}) {
    EXPECT_THAT(text, HasSubstr(box(frame, outside)));
  }
  EXPECT_THAT(text, Not(HasSubstr(box(11, 1)))) << "two tenths of a second are no gap";
  EXPECT_THAT(text, HasSubstr("xtl=\"10.00\" ytl=\"20.00\" xbr=\"30.00\" ybr=\"50.00\""));
  EXPECT_THAT(text, HasSubstr("label=\"box &lt;&amp;&gt;\""));
  EXPECT_THAT(text, HasSubstr("<width>640</width><height>480</height>"));
}

// A box and its end in one frame contradict each other: of a slow video the next frame is more than a second away.
TEST_F(ExportVideoTest, CvatOfASlowVideoHasOneBoxAFrame) {
  IndexBatch batch;
  const auto slow = store_->PutVideo({.content_id = "slow", .name = "slow.mp4", .width = 640, .height = 480});
  const auto jeep = store_->PutModel({.name = "jeep", .content_id = "1", .kind = ModelKind::kCad});
  batch.tracklets.push_back({std::nullopt, {.video = slow->id, .model = jeep->id, .score = 0.9, .frames = 2}});
  for (const std::int64_t frame : {3, 4, 6}) {
    SightingRecord sighting = SightingIn(frame);
    sighting.time_s = 5 * static_cast<double>(frame);
    batch.sightings.push_back({0, sighting});
  }
  ASSERT_TRUE(store_->Commit(batch));
  std::ostringstream out;
  ASSERT_TRUE(Export(*store_, **FindExportFormat("cvat"), {.video_name = "slow.mp4"}, out));
  const std::string text = out.str();
  for (const auto& [box, count] :
       {std::pair("frame=\"4\"", 1), {"frame=\"5\"", 1}, {"frame=\"7\"", 1}, {"outside=\"1\"", 2}}) {
    int found = 0;
    for (std::size_t at = text.find(box); at != std::string::npos; at = text.find(box, at + 1)) ++found;
    EXPECT_EQ(found, count) << box;
  }
}

TEST_F(ExportVideoTest, WebVttHasACueForEachInterval) {
  EXPECT_EQ(Text("vtt"),
            "WEBVTT - victorious\n\n00:00:01.000 --> 00:00:01.500\njeep 1, score 0.900\n"
            "\n00:00:05.000 --> 00:00:05.500\njeep 1, score 0.900\n"
            "\n00:00:09.900 --> 00:00:10.400\nbox &lt;&amp;&gt; 2, score 0.800\n");
}

TEST_F(ExportVideoTest, VmtiHasAPacketForEachFrameWithTargets) {
  const std::string text = Text("vmti");
  const KlvUnits units = SplitKlv(AsBytes(text));
  ASSERT_EQ(units.units.size(), 4u);
  const KlvPacket second = DecodeSt0601(units.units[1]);
  EXPECT_EQ(second.Number(2), static_cast<double>(kStart_us + 1'200'000));
  EXPECT_TRUE((*FindExportFormat("vmti"))->is_file(text));
  const std::string telemetry = text.substr(0, kUniversalLabelSize) + std::string(40, '\0');
  EXPECT_FALSE((*FindExportFormat("vmti"))->is_file(telemetry)) << "what somebody recorded is not replaced";
}

TEST_F(ExportVideoTest, FormatsOfOneVideoRefuseTwo) {
  ASSERT_TRUE(store_->PutVideo({.content_id = "2", .name = "b.mp4", .width = 64, .height = 48}));
  for (const char* format : {"mot", "cvat", "vtt", "vmti"}) {
    EXPECT_THAT(Refusal(format), HasSubstr("a.mp4, b.mp4: select one with --video")) << format;
  }
}

TEST_F(ExportVideoTest, VmtiNeedsUtc) {
  const auto other = OpenSqliteStore(folder_ / "other.db", StoreMode::kCreate);
  ASSERT_TRUE((*other)->PutVideo({.content_id = "2", .name = "b.mp4", .width = 64, .height = 48}));
  std::ostringstream out;
  const Status status = Export(**other, **FindExportFormat("vmti"), {}, out);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr("b.mp4: its UTC is not known"));
}

TEST_F(ExportVideoTest, CzmlHasADocumentAndNoObjectsWithoutPlaces) {
  const json czml = json::parse(Text("czml"));
  ASSERT_EQ(czml.size(), 1u);
  EXPECT_EQ(czml[0]["id"], "document");
}

TEST_F(ExportVideoTest, FilesOfPersonsAreNotOurs) {
  for (const char* format : {"cvat", "vtt", "czml"}) {
    EXPECT_TRUE((*FindExportFormat(format))->is_file(Text(format))) << format;
  }
  EXPECT_FALSE((*FindExportFormat("cvat"))->is_file("<?xml version=\"1.0\"?>\n<annotations>")) << "corrected in CVAT";
  EXPECT_FALSE((*FindExportFormat("vtt"))->is_file("WEBVTT\n\n")) << "somebody's subtitles";
  EXPECT_FALSE((*FindExportFormat("czml"))->is_file(R"([{"id":"document","version":"1.0"}])"));
}

}  // namespace
}  // namespace victorious
