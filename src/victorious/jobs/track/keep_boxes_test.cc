#include "victorious/jobs/track/keep_boxes.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/drawn_flight.h"
#include "victorious/place/associate/update_objects.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class KeepBoxesTest : public ::testing::Test {
 protected:
  KeepBoxesTest() : store_(OpenSqliteStore(folder_ / "index.db", StoreMode::kCreate).value()) {
    for (const char* name : {"a.mp4", "b.mp4"}) {
      videos_.push_back(store_->PutVideo({.content_id = name, .name = name, .width = 640, .height = 480}).value());
    }
  }

  // Ten frames of a box, of which the fifth is found by the recogniser.
  void See(std::size_t box_index, std::size_t video, const Box& box) {
    for (std::int64_t frame = 0; frame < 10; ++frame) {
      sightings_.push_back({.box_index = box_index,
                            .video = video,
                            .frame = frame,
                            .time_s = static_cast<double>(frame) / 10,
                            .box = box,
                            .extent = box,
                            .score = frame == 0 ? 1 : 0.5,
                            .matches = frame == 5 ? std::optional<std::size_t>(12) : std::nullopt});
    }
  }

  Expected<std::vector<std::int64_t>> Keep(const std::vector<UserBox>& boxes) {
    return KeepBoxes(sightings_, boxes, videos_, *store_);
  }

  testing::ScratchFolder folder_;
  std::unique_ptr<IndexStore> store_;
  std::vector<VideoRecord> videos_;
  std::vector<BoxSighting> sightings_;
};

TEST_F(KeepBoxesTest, BoxesBecomeObjectsOfTheirCategories) {
  See(0, 0, {10, 10, 40, 20});
  See(1, 0, {200, 100, 40, 20});
  const std::vector<std::int64_t> objects = Keep({{.box = {}, .type = "van"}, {.box = {}}}).value();
  ASSERT_THAT(objects, SizeIs(2));
  const auto van = store_->Objects({.category_name = "boxed/van"}).value();
  ASSERT_THAT(van, SizeIs(1));
  EXPECT_EQ(van[0].id, objects[0]);
  EXPECT_EQ(van[0].frames, 10);
  EXPECT_EQ(van[0].score, 1);
  EXPECT_DOUBLE_EQ(van[0].last_time_s, 0.9);
  EXPECT_THAT(store_->Objects({.category_name = "boxed"}).value(), SizeIs(2));
  const auto sightings = store_->Sightings({.object = objects[0]}).value();
  ASSERT_THAT(sightings, SizeIs(10));
  EXPECT_EQ(sightings[4].source, SightingSource::kTracked);
  EXPECT_EQ(sightings[5].source, SightingSource::kRecognised);
  EXPECT_EQ(sightings[5].box.x, 10);
}

TEST_F(KeepBoxesTest, TwiceIsAsOnce) {
  See(0, 0, {10, 10, 40, 20});
  const std::vector<std::int64_t> first = Keep({{.box = {}, .type = "van"}}).value();
  sightings_.clear();
  See(0, 0, {12, 11, 40, 20});
  EXPECT_EQ(Keep({{.box = {}, .type = "van"}}).value(), first);
  EXPECT_THAT(store_->Sightings({}).value(), SizeIs(10));
  // Another place in the frame, or another type, is another object.
  sightings_.clear();
  See(0, 0, {300, 10, 40, 20});
  EXPECT_NE(Keep({{.box = {}, .type = "van"}}).value(), first);
  sightings_.clear();
  See(0, 0, {10, 10, 40, 20});
  EXPECT_NE(Keep({{.box = {}}}).value(), first);
  EXPECT_THAT(store_->Objects({}).value(), SizeIs(3));
}

TEST_F(KeepBoxesTest, TwoBoxesOfOneObjectAreOne) {
  See(0, 0, {10, 10, 40, 20});
  See(1, 0, {12, 11, 40, 20});
  const std::vector<std::int64_t> objects = Keep({{.box = {}, .type = "van"}, {.box = {}, .type = "van"}}).value();
  ASSERT_THAT(objects, SizeIs(2));
  EXPECT_EQ(objects[0], objects[1]);
  EXPECT_THAT(store_->Sightings({}).value(), SizeIs(10));
}

TEST_F(KeepBoxesTest, IsOneObjectInAllVideosAtItsLastPlace) {
  See(0, 0, {10, 10, 40, 20});
  See(0, 1, {50, 10, 40, 20});
  sightings_[3].place = {.point = {.latitude_rad = 0.5}};
  sightings_[12].place = {.point = {.latitude_rad = 0.6}};
  const std::vector<std::int64_t> objects = Keep({{.box = {}, .type = "van"}}).value();
  const auto expect_one = [&](const std::vector<ObjectRecord>& all) {
    ASSERT_THAT(all, SizeIs(1));
    EXPECT_THAT(objects, ElementsAre(all[0].id));
    EXPECT_THAT(all[0].videos, ElementsAre(videos_[0].id, videos_[1].id));
    ASSERT_TRUE(all[0].place);
    EXPECT_DOUBLE_EQ(all[0].place->point.latitude_rad, 0.6);
  };
  expect_one(store_->Objects({}).value());
  // Data association, of an index or of its own next video, leaves it as it is.
  ASSERT_TRUE(UpdateObjects({}, *store_, {}, [](const VideoRecord&, const FlightNotes&) {}).has_value());
  expect_one(store_->Objects({}).value());
  // It is found in a third video: the object grows.
  videos_.push_back(store_->PutVideo({.content_id = "c", .name = "c.mp4", .width = 640, .height = 480}).value());
  See(0, 2, {70, 10, 40, 20});
  EXPECT_EQ(Keep({{.box = {}, .type = "van"}}).value(), objects);
  EXPECT_THAT(store_->Objects({}).value().at(0).videos, SizeIs(3));
  // Without telemetry, it keeps its place.
  for (BoxSighting& one : sightings_) one.place.reset();
  EXPECT_EQ(Keep({{.box = {}, .type = "van"}}).value(), objects);
  EXPECT_TRUE(store_->Objects({}).value().at(0).place.has_value());
}

TEST_F(KeepBoxesTest, TheNameOfWhatIsSearchedForIsRefused) {
  ASSERT_TRUE(store_->PutModel({.name = "boxed/van", .content_id = "x", .kind = ModelKind::kCategory}).has_value());
  See(0, 0, {10, 10, 40, 20});
  const auto kept = Keep({{.box = {}, .type = "van"}});
  ASSERT_FALSE(kept.has_value());
  EXPECT_EQ(kept.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(kept.error().message, HasSubstr("boxed/van: is the name of a category"));
  EXPECT_THAT(store_->Tracklets().value(), SizeIs(0));
}

TEST_F(KeepBoxesTest, AVideoMustBeInTheIndex) {
  const testing::SyntheticFlight flight(testing::ShortFlight(3));
  testing::WriteVideo(flight, folder_ / "flight.mkv");
  const std::vector<std::string> videos = {(folder_ / "flight.mkv").string()};
  const auto found = FindTrackedVideos(videos, *store_, {});
  ASSERT_FALSE(found.has_value());
  EXPECT_EQ(found.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(found.error().message, HasSubstr("flight.mkv: is not in the index"));
}

}  // namespace
}  // namespace victorious
