#include "victorious/apps/serve/object_tiles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/vector_tile_reader.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using testing::ReadLayer;
using testing::ReadTile;
using ::testing::SizeIs;

class ObjectTilesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto store = OpenSqliteStore(folder_ / "index.db", StoreMode::kCreate);
    ASSERT_TRUE(store) << store.error().message;
    store_ = *std::move(store);
    video_ = store_->PutVideo({.content_id = "c", .name = "a.mp4", .width = 640, .height = 480})->id;
    model_ = store_->PutModel({.name = "jeep", .content_id = "m", .kind = ModelKind::kCad})->id;
  }

  // Objects at places, degrees, with the standard deviation of the places; the first has the highest score.
  void Place(const std::vector<std::pair<double, double>>& places, double sigma_m) {
    IndexBatch batch;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double score = 0.9 - 0.5 * static_cast<double>(i) / static_cast<double>(places.size());
      batch.tracklets.push_back(
          {std::nullopt, {.video = video_, .model = model_, .score = score, .frames = 1, .last_time_s = 1}});
    }
    const auto ids = store_->Commit(batch);
    ASSERT_TRUE(ids) << ids.error().message;
    std::vector<ObjectRecord> objects;
    for (std::size_t i = 0; i < places.size(); ++i) {
      Geolocation place{.point = {RadiansFromDegrees(places[i].first), RadiansFromDegrees(places[i].second), 40},
                        .time_s = 1};
      place.covariance_enu_m2 = sigma_m * sigma_m * Eigen::Matrix3d::Identity();
      place.ce90_m = 2.146 * sigma_m;
      objects.push_back(
          {.id = (*ids)[i], .model = model_, .tracklets = {(*ids)[i]}, .place = place, .heading_rad = kPi / 2});
    }
    ASSERT_TRUE(store_->PutObjects(objects));
    ids_ = *ids;
    auto reader = OpenTriageStore(folder_ / "index.db");
    ASSERT_TRUE(reader) << reader.error().message;
    reader_ = *std::move(reader);
  }

  std::vector<ReadLayer> Tile(const TileAddress& address, const ObjectQuery& query = {}) {
    const auto tile = MakeObjectTile(*reader_, address, query);
    EXPECT_TRUE(tile);
    return tile ? ReadTile(*tile) : std::vector<ReadLayer>();
  }

  static const ReadLayer* Find(const std::vector<ReadLayer>& tile, std::string_view name) {
    const auto found = std::ranges::find(tile, name, &ReadLayer::name);
    return found == tile.end() ? nullptr : &*found;
  }

  testing::ScratchFolder folder_;
  std::unique_ptr<IndexStore> store_;
  std::unique_ptr<TriageStore> reader_;
  std::int64_t video_ = 0;
  std::int64_t model_ = 0;
  std::vector<std::int64_t> ids_;
};

TEST_F(ObjectTilesTest, PointLiesWhereWebMercatorPutsIt) {
  Place({{52, 13}}, 1);
  // The whole world: x = (13 / 360 + 1/2) * 4096; y by the formula of the projection.
  const auto world = Tile({0, 0, 0});
  const ReadLayer* objects = Find(world, "objects");
  ASSERT_NE(objects, nullptr);
  ASSERT_THAT(objects->features, SizeIs(1));
  EXPECT_THAT(objects->features[0].geometry, ::testing::ElementsAre(9, 2 * 2196, 2 * 1353));
  EXPECT_EQ(objects->features[0].id, static_cast<std::uint64_t>(ids_[0]));
  EXPECT_EQ(std::get<std::int64_t>(*objects->Find(0, "model")), model_);
  EXPECT_EQ(std::get<double>(*objects->Find(0, "heading")), 90.0);
  EXPECT_EQ(Find(world, "ellipses"), nullptr) << "far too small to be seen";
  // Of the four tiles of the next level, the north-eastern one.
  EXPECT_NE(Find(Tile({1, 1, 0}), "objects"), nullptr);
  for (const TileAddress other : {TileAddress{1, 0, 0}, {1, 0, 1}, {1, 1, 1}}) {
    EXPECT_EQ(Find(Tile(other), "objects"), nullptr) << other.x << other.y;
  }
}

TEST_F(ObjectTilesTest, EllipsesReachOverBordersOfTiles) {
  // Column 140536 of level 18 begins at 13.0 degrees plus 0.00038; the object lies east of the border by a metre.
  const double border_deg = 140'536 / 262'144.0 * 360 - 180;
  Place({{0.001, border_deg + 1e-5}}, 4);
  const std::int64_t row = 131'071;
  const auto east = Tile({18, 140'536, row});
  const auto west = Tile({18, 140'535, row});
  EXPECT_NE(Find(east, "objects"), nullptr);
  EXPECT_NE(Find(east, "ellipses"), nullptr);
  EXPECT_EQ(Find(west, "objects"), nullptr) << "a point is in one tile only";
  EXPECT_NE(Find(west, "ellipses"), nullptr) << "or the ellipse would be cut at the border";
}

TEST_F(ObjectTilesTest, ManyObjectsBecomeBoundedClusters) {
  std::vector<std::pair<double, double>> places;
  for (int i = 0; i < 1000; ++i) places.emplace_back(50 + 0.01 * (i / 40), 10 + 0.02 * (i % 40));
  Place(places, 1);
  const auto tile = Tile({5, 16, 10});
  EXPECT_EQ(Find(tile, "objects"), nullptr);
  const ReadLayer* clusters = Find(tile, "clusters");
  ASSERT_NE(clusters, nullptr);
  EXPECT_LE(clusters->features.size(), 256U);
  std::int64_t count = 0;
  for (std::size_t i = 0; i < clusters->features.size(); ++i) {
    count += std::get<std::int64_t>(*clusters->Find(i, "count"));
    EXPECT_EQ(*clusters->Find(i, "matches"), *clusters->Find(i, "count"));
  }
  EXPECT_EQ(count, 1000) << "no object is left out or counted twice";
  const auto best = Tile({5, 16, 10}, {.min_score = 0.65});
  std::int64_t matches = 0;
  const ReadLayer* filtered = Find(best, "clusters");
  for (std::size_t i = 0; i < filtered->features.size(); ++i) {
    matches += std::get<std::int64_t>(*filtered->Find(i, "matches"));
  }
  EXPECT_EQ(matches, 501) << "scores from 0.9 down to 0.65";
}

TEST_F(ObjectTilesTest, GroupOnTheBorderOfCellsIsOneCluster) {
  // Around the middle of the tile 0/0/0, where four cells meet.
  std::vector<std::pair<double, double>> places;
  for (int i = 0; i < 400; ++i) places.emplace_back(0.01 * (i % 20) - 0.095, 0.01 * (i / 20) - 0.095);
  Place(places, 1);
  const auto tile = Tile({0, 0, 0});
  const ReadLayer* clusters = Find(tile, "clusters");
  ASSERT_NE(clusters, nullptr);
  ASSERT_THAT(clusters->features, SizeIs(1));
  EXPECT_EQ(std::get<std::int64_t>(*clusters->Find(0, "count")), 400);
  EXPECT_EQ(std::get<std::string>(*clusters->Find(0, "label")), "400");
}

TEST_F(ObjectTilesTest, LastLevelShowsTheBestOfTooMany) {
  Place(std::vector<std::pair<double, double>>(kMaxLastTileObjects * 4 + 10, {0.0005, 0.0005}), 0.1);
  const auto tile = Tile({18, 131'072, 131'071});
  const ReadLayer* objects = Find(tile, "objects");
  ASSERT_NE(objects, nullptr);
  EXPECT_THAT(objects->features, SizeIs(kMaxLastTileObjects * 4));
  double worst = 1;
  for (std::size_t i = 0; i < objects->features.size(); ++i) {
    worst = std::min(worst, std::get<double>(*objects->Find(i, "score")));
  }
  EXPECT_GT(worst, 0.4) << "those left out have the lowest scores";
}

TEST_F(ObjectTilesTest, FilteredObjectsAreMarkedNotLeftOut) {
  Place({{52, 13}, {52.1, 13.1}}, 1);
  const auto tile = Tile({0, 0, 0}, {.min_score = 0.8});
  const ReadLayer* objects = Find(tile, "objects");
  ASSERT_NE(objects, nullptr);
  ASSERT_THAT(objects->features, SizeIs(2));
  EXPECT_EQ(std::get<bool>(*objects->Find(0, "matches")), true);
  EXPECT_EQ(std::get<bool>(*objects->Find(1, "matches")), false);
}

}  // namespace
}  // namespace victorious
