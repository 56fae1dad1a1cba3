#include "victorious/show/export/export_cot.h"

#include <cmath>
#include <memory>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/geometry/angles.h"
#include "victorious/show/export/export.h"
#include "victorious/show/export/xml_text.h"

namespace victorious {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr std::int64_t kVideoStart_us = 1'700'000'000'000'000;            // 2023-11-14T22:13:20Z
constexpr std::int64_t kNow_us = kVideoStart_us + 60LL * 60 * 1'000'000;  // an hour later

TEST(EscapedXml, HoldsAnyText) {
  EXPECT_EQ(EscapedXml("a<b>&\"c'"), "a&lt;b&gt;&amp;&quot;c&apos;");
  EXPECT_EQ(EscapedXml("]]>"), "]]&gt;");
  EXPECT_EQ(EscapedXml("one\ntwo\t\x01\x1f\r"), "one&#10;two&#9;") << "on one line, without control bytes";
  EXPECT_EQ(EscapedXml("Zürich"), "Zürich");
  EXPECT_EQ(EscapedXml("\xEF\xBF\xBE.\xEF\xBF\xBF"), "\xEF\xBF\xBD.\xEF\xBF\xBD") << "U+FFFE and U+FFFF";
  EXPECT_EQ(EscapedXml("\xC3"), "\xEF\xBF\xBD");
}

TEST(Cot, TypesFollowFromNames) {
  EXPECT_EQ(CotTypeOf("jeep"), "a-u-G-E-V");
  EXPECT_EQ(CotTypeOf("vehicle/Car"), "a-u-G-E-V-C") << "the last known word";
  EXPECT_EQ(CotTypeOf("fire_truck-2"), "a-u-G-E-V");
  EXPECT_EQ(CotTypeOf("container ship"), "a-u-S");
  EXPECT_EQ(CotTypeOf("carpet"), "a-u-G") << "no word of the table";
  EXPECT_EQ(CotTypeOf(""), "a-u-G");
}

TEST(Cot, RefusesTypesThatAreNone) {
  EXPECT_TRUE(CheckCotType("a-h-G-E-V"));
  for (const char* wrong : {"", "-a", "a-", "a--b", "a b", "a\"", "ä"}) {
    EXPECT_EQ(CheckCotType(wrong).error().code, ErrorCode::kInvalidArgument) << wrong;
  }
}

class ExportCotTest : public ::testing::Test {
 protected:
  void SetUp() override { store_ = MakeStore("index.db", "jeep"); }

  // One object of a model, seen in a video with UTC from 1 to 2 s.
  std::unique_ptr<IndexStore> MakeStore(const std::string& file, const std::string& name) {
    std::unique_ptr<IndexStore> store = *OpenSqliteStore(folder_ / file, StoreMode::kCreate);
    const VideoRecord video = *store->PutVideo({.content_id = "of " + file,
                                                .name = "/srv/films/a.mp4",
                                                .width = 64,
                                                .height = 48,
                                                .start_utc_us = kVideoStart_us});
    const ModelRecord model = *store->PutModel({.name = name, .content_id = "m", .kind = ModelKind::kCad});
    IndexBatch batch;
    batch.tracklets.push_back(
        {std::nullopt,
         {.video = video.id, .model = model.id, .score = 0.9, .frames = 2, .first_time_s = 1, .last_time_s = 2}});
    EXPECT_TRUE(store->Commit(batch));
    return store;
  }

  static void Place(IndexStore& store, std::optional<Eigen::Vector3d> velocity_enu = {}) {
    ObjectRecord object = store.Objects({}).value().front();
    Geolocation& place = object.place.emplace();
    place.point = {RadiansFromDegrees(52.5), RadiansFromDegrees(-13.25), 81.5};
    place.covariance_enu_m2 = Eigen::Vector3d(4, 4, 9).asDiagonal();
    place.ce90_m = 2 * std::sqrt(2 * std::log(10.0));  // of a circular error of 2 m a side
    place.le90_m = 3 * 1.6449;
    place.velocity_enu = velocity_enu;
    if (velocity_enu) place.velocity_covariance_enu = 0.01 * Eigen::Matrix3d::Identity();
    ASSERT_TRUE(store.PutObjects(std::span(&object, 1)));
  }

  static std::string Text(IndexStore& store, const std::string& type = "") {
    std::ostringstream out;
    const Status status = Export(store, kCotFormat, {}, out, {.cot_type = type, .now_utc_us = kNow_us});
    EXPECT_TRUE(status) << status.error().message;
    return out.str();
  }

  testing::ScratchFolder folder_;
  std::unique_ptr<IndexStore> store_;
};

TEST_F(ExportCotTest, EventHasPlaceErrorsAndTimes) {
  EXPECT_THAT(Text(*store_), IsEmpty()) << "objects without a place are left out";
  Place(*store_);
  const std::string event = Text(*store_);
  EXPECT_THAT(event, AllOf(HasSubstr("<event version=\"2.0\" uid=\"victorious-"), HasSubstr("type=\"a-u-G-E-V\"")));
  EXPECT_THAT(event,
              HasSubstr("<point lat=\"52.50000000\" lon=\"-13.25000000\" hae=\"81.50\" ce=\"2.00\" le=\"3.00\"/>"))
      << "one standard deviation";
  EXPECT_THAT(event, HasSubstr("time=\"2023-11-14T23:13:20.000Z\" start=\"2023-11-14T22:13:22.000Z\" "
                               "stale=\"2023-11-15T23:13:20.000Z\""));
  EXPECT_THAT(event, HasSubstr("CE90 4.29 m, LE90 4.93 m; a.mp4</remarks>"));
  EXPECT_THAT(event, Not(HasSubstr("<track")));
  EXPECT_THAT(Text(*store_, "a-h-G"), HasSubstr("type=\"a-h-G\""));
}

TEST_F(ExportCotTest, MovingObjectsGoStaleSoonAfterTheyWereSeen) {
  Place(*store_, Eigen::Vector3d(0, -5, 0));
  EXPECT_THAT(Text(*store_), AllOf(HasSubstr("<track course=\"180.0\" speed=\"5.00\"/>"),
                                   HasSubstr("stale=\"2023-11-14T22:18:22.000Z\"")));
}

TEST_F(ExportCotTest, IdsAreStableAndDifferBetweenIndexes) {
  const auto uid = [](const std::string& event) { return event.substr(0, event.find(" type=")); };
  Place(*store_);
  EXPECT_EQ(uid(Text(*store_)), uid(Text(*store_)));
  const std::unique_ptr<IndexStore> other = MakeStore("other.db", "jeep");
  Place(*other);
  EXPECT_NE(uid(Text(*other)), uid(Text(*store_)));
}

}  // namespace
}  // namespace victorious
