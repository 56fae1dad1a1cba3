#include "victorious/show/contact_sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/drawn_flight.h"

namespace victorious {
namespace {

using ::testing::AllOf;
using testing::DrawnFlight;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ObjectsOf;
using testing::ShortFlight;
using testing::SightingsOf;

constexpr ContactSheetOptions kSmallTiles = {.max_tiles = 24, .columns = 2, .tile_width_px = 160};

class ContactSheet : public ::testing::Test {
 protected:
  void SetUp() override {
    IndexOptions options;
    options.tracklets.gap_s = 0.3;  // the crate returns after a longer gap, as another object
    options.follow.enabled = false;
    const auto report =
        Indexer::Create(flight_.Models(), options).value().Index({.video = flight_.video()}, CancelToken(), *store_);
    ASSERT_TRUE(report) << report.error().message;
    objects_ = ObjectsOf(*store_);
    ASSERT_GE(objects_.size(), 3U);
  }

  cv::Mat Draw(const SightingFilter& filter, const ContactSheetOptions& options) {
    Expected<cv::Mat> sheet = DrawContactSheet(filter, options, *store_);
    EXPECT_TRUE(sheet) << sheet.error().message;
    return sheet.value_or(cv::Mat());
  }

  std::string ErrorOf(const SightingFilter& filter, const ContactSheetOptions& options) {
    const Expected<cv::Mat> sheet = DrawContactSheet(filter, options, *store_);
    EXPECT_FALSE(sheet);
    return sheet ? "" : sheet.error().message;
  }

  DrawnFlight flight_{ShortFlight()};
  std::unique_ptr<IndexStore> store_ = flight_.Store("index.db");
  std::vector<ObjectRecord> objects_;
};

// Pixels of the outlines' yellow, which the rendered town does not contain.
int Yellow(const cv::Mat& image) {
  cv::Mat yellow;
  cv::inRange(image, cv::Scalar(0, 250, 250), cv::Scalar(5, 255, 255), yellow);
  return cv::countNonZero(yellow);
}

// Tiles that differ from the background between them.
int Tiles(const cv::Mat& sheet, int columns, int rows) {
  int tiles = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const cv::Rect cell(column * sheet.cols / columns, row * sheet.rows / rows, sheet.cols / columns,
                          sheet.rows / rows);
      tiles += Yellow(sheet(cell)) > 100 ? 1 : 0;
    }
  }
  return tiles;
}

TEST_F(ContactSheet, ShowsEachObjectOnceWithItsOutline) {
  const cv::Mat sheet = Draw({}, kSmallTiles);
  ASSERT_EQ(sheet.type(), CV_8UC3);
  const int rows = (static_cast<int>(objects_.size()) + 1) / 2;
  EXPECT_GE(sheet.cols, 2 * 160);
  EXPECT_GE(sheet.rows, rows * 120);
  EXPECT_EQ(Tiles(sheet, 2, rows), static_cast<int>(objects_.size()));
}

TEST_F(ContactSheet, RespectsLimitAndFilter) {
  EXPECT_EQ(Tiles(Draw({}, {.max_tiles = 1, .columns = 2, .tile_width_px = 160}), 1, 1), 1);
  const SightingFilter trucks{.model_name = flight_.flight().ObjectName(1)};
  const auto count = static_cast<int>(ObjectsOf(*store_, trucks).size());
  EXPECT_EQ(Tiles(Draw(trucks, {.max_tiles = 9, .columns = 1, .tile_width_px = 160}), 1, count), count);
}

// Below the frame stand cut-outs of the object itself, enlarged, of different moments, without the outline.
TEST_F(ContactSheet, CutsTheObjectOutAtSeveralMoments) {
  const auto seen_often = std::ranges::find_if(objects_, [](const ObjectRecord& one) { return one.frames >= 4; });
  ASSERT_NE(seen_often, objects_.end());
  constexpr ContactSheetOptions kOne = {.max_tiles = 1, .columns = 1, .tile_width_px = 400, .moments = 4};
  const cv::Mat sheet = Draw({.object = seen_often->id}, kOne);
  constexpr int kGap = 6;
  constexpr int kFrameHeight = 400 * 192 / 256;
  const auto cut_out = [&](int i) { return sheet(cv::Rect(kGap + 100 * i + 1, kGap + kFrameHeight, 99, 86)); };
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(Yellow(cut_out(i)), 0) << i;
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(cut_out(i), mean, deviation);
    EXPECT_GT(deviation[0], 8) << "cut-out " << i << " is not empty";
    if (i > 0) {
      EXPECT_GT(cv::norm(cut_out(i), cut_out(i - 1), cv::NORM_INF), 20) << "of another moment";
    }
  }
  EXPECT_EQ(sheet.cols, 400 + 2 * kGap);
  EXPECT_EQ(sheet.rows, kFrameHeight + 100 + 34 + 2 * kGap);
}

// At the frame's edge the cut-out moves inside: no black bars.
TEST_F(ContactSheet, CutOutsAtTheEdgeShowTheFrameOnly) {
  const auto reaches_the_edge = [](const SightingRecord& one) {
    return one.box.x < 0.1 * one.box.width || one.box.x + 1.1 * one.box.width > 256;
  };
  ASSERT_TRUE(std::ranges::any_of(SightingsOf(*store_, {}), reaches_the_edge));
  constexpr int kSide = 25;
  constexpr int kGap = 6;
  const cv::Mat sheet = Draw({}, {.max_tiles = 24, .columns = 1, .tile_width_px = 16 * kSide, .moments = 16});
  constexpr int kFrameHeight = 16 * kSide * 192 / 256;
  constexpr int kTileHeight = kFrameHeight + kSide + 34 + kGap;
  for (std::size_t tile = 0; tile < objects_.size(); ++tile) {
    const int top = kGap + static_cast<int>(tile) * kTileHeight + kFrameHeight;
    for (int x = kGap; x < kGap + 16 * kSide; ++x) {
      const cv::Mat column = sheet(cv::Rect(x, top, 1, kSide / 2));
      EXPECT_GT(cv::norm(column, cv::NORM_INF), 0) << "tile " << tile << ", column " << x;
    }
  }
}

// An object passes the time filter if its interval overlaps it, even without a sighting in it: then there is no tile.
TEST_F(ContactSheet, ExcludesObjectsOutsideTheTimeRange) {
  for (const ObjectRecord& object : objects_) {
    if (object.frames < 2) continue;
    const SightingFilter between{.from_s = object.first_time_s + 0.01, .to_s = object.first_time_s + 0.02};
    ASSERT_TRUE(SightingsOf(*store_, between).empty());
    ASSERT_FALSE(ObjectsOf(*store_, between).empty());
    EXPECT_THAT(ErrorOf(between, kSmallTiles), HasSubstr("no object in the index passes the filter"));
    return;
  }
  FAIL() << "no object was seen twice";
}

TEST_F(ContactSheet, ErrorsNameTheReason) {
  EXPECT_THAT(ErrorOf({.from_s = 1000}, kSmallTiles),
              AllOf(HasSubstr("no object in the index passes the filter"), Not(HasSubstr("\n"))));
  EXPECT_THAT(ErrorOf({.model_name = "nobody"}, kSmallTiles), HasSubstr("nobody"));
  EXPECT_THAT(ErrorOf({}, {.max_tiles = 0, .columns = 0, .tile_width_px = 1}),
              AllOf(HasSubstr("max_tiles = 0"), HasSubstr("columns = 0"), HasSubstr("tile_width_px = 1")));
  EXPECT_THAT(ErrorOf({}, {.moments = 0}), HasSubstr("moments = 0"));
  std::filesystem::rename(flight_.video(), flight_ / "moved.mkv");
  EXPECT_THAT(ErrorOf({}, kSmallTiles), AllOf(HasSubstr(flight_.video()), Not(HasSubstr("\n"))));
}

}  // namespace
}  // namespace victorious
