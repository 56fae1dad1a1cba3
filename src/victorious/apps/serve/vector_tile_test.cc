#include "victorious/apps/serve/vector_tile.h"

#include <bit>
#include <cstring>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/vector_tile_reader.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using testing::ReadTile;
using ::testing::SizeIs;

// The examples of the specification, sections 4.3.5.1 and 4.3.5.6 (first ring).
TEST(TileLayer, GeometriesAreThoseOfTheSpecification) {
  TileLayer layer("shapes", 4096);
  layer.AddPoint(1, {25, 17}, {});
  const TilePoint triangle[] = {{3, 6}, {8, 12}, {20, 34}};
  layer.AddPolygon(2, triangle, {});
  const auto tile = ReadTile(EncodeTile({&layer, 1}));
  ASSERT_THAT(tile, SizeIs(1));
  ASSERT_THAT(tile[0].features, SizeIs(2));
  EXPECT_THAT(tile[0].features[0].geometry, ElementsAre(9, 50, 34));
  EXPECT_EQ(tile[0].features[0].type, 1);
  EXPECT_THAT(tile[0].features[1].geometry, ElementsAre(9, 6, 12, 18, 10, 12, 24, 44, 15));
  EXPECT_EQ(tile[0].features[1].type, 3);
}

TEST(TileLayer, AttributesAreSharedAndKeepTheirTypes) {
  TileLayer layer("objects", 512);
  layer.AddPoint(7, {0, 0}, {{"name", std::string("jeep")}, {"score", 0.25}, {"rank", std::int64_t{-3}}});
  layer.AddPoint(8, {1, 1}, {{"name", std::string("jeep")}, {"is_seen", true}, {"is_far", false}});
  const auto tile = ReadTile(EncodeTile({&layer, 1}));
  ASSERT_THAT(tile, SizeIs(1));
  const auto& read = tile[0];
  EXPECT_EQ(read.name, "objects");
  EXPECT_EQ(read.version, 2U);
  EXPECT_EQ(read.extent, 512U);
  EXPECT_THAT(read.keys, ElementsAre("name", "score", "rank", "is_seen", "is_far"));
  EXPECT_THAT(read.values, SizeIs(5)) << "equal values are stored once";
  EXPECT_EQ(read.features[0].id, 7U);
  EXPECT_EQ(std::get<std::string>(*read.Find(0, "name")), "jeep");
  EXPECT_EQ(std::get<double>(*read.Find(0, "score")), 0.25);
  EXPECT_EQ(std::get<std::int64_t>(*read.Find(0, "rank")), -3);
  EXPECT_EQ(std::get<std::string>(*read.Find(1, "name")), "jeep");
  EXPECT_EQ(std::get<bool>(*read.Find(1, "is_seen")), true);
  EXPECT_EQ(std::get<bool>(*read.Find(1, "is_far")), false);
  EXPECT_FALSE(read.Find(1, "score"));
}

TEST(TileLayer, RingsAreClockwiseOnScreen) {
  TileLayer layer("shapes", 4096);
  const TilePoint clockwise[] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  const TilePoint counter[] = {{0, 10}, {10, 10}, {10, 0}, {0, 0}};
  const TilePoint repeated[] = {{0, 0}, {10, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 0}};
  layer.AddPolygon(1, clockwise, {});
  layer.AddPolygon(2, counter, {});
  layer.AddPolygon(3, repeated, {});
  const auto tile = ReadTile(EncodeTile({&layer, 1}));
  ASSERT_THAT(tile[0].features, SizeIs(3));
  EXPECT_THAT(tile[0].features[0].geometry, ElementsAre(9, 0, 0, 26, 20, 0, 0, 20, 19, 0, 15));
  EXPECT_EQ(tile[0].features[1].geometry, tile[0].features[0].geometry);
  EXPECT_EQ(tile[0].features[2].geometry, tile[0].features[0].geometry);
}

TEST(TileLayer, LeavesOutWhatHasNoArea) {
  TileLayer layer("shapes", 4096);
  const TilePoint line[] = {{0, 0}, {5, 5}, {10, 10}};
  const TilePoint dot[] = {{4, 4}, {4, 4}, {4, 4}};
  layer.AddPolygon(1, line, {});
  layer.AddPolygon(2, dot, {});
  layer.AddPolygon(3, {}, {});
  EXPECT_EQ(EncodeTile({&layer, 1}), "") << "a layer without features is none";
}

TEST(TileLayer, PointsBeyondTheTileKeepTheirSigns) {
  TileLayer layer("objects", 4096);
  layer.AddPoint(1, {-1, 5000}, {});
  EXPECT_THAT(ReadTile(EncodeTile({&layer, 1}))[0].features[0].geometry, ElementsAre(9, 1, 10000));
}

}  // namespace
}  // namespace victorious
