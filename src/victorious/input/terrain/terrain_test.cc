// The tests write their GeoTIFFs with GDAL.
#include "victorious/input/terrain/terrain.h"

#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gdal.h>
#include <gdal_frmts.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogr_srs_api.h>

#include "testing/data.h"
#include "testing/geoid_grid.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/geoid.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

// The content of a test GeoTIFF.
struct Written {
  int width = 50;
  int height = 40;
  std::array<double, 6> file_from_pixel = {500000, 2, 0, 4600000, 0, -2};  // 2 m per pixel, north up
  std::string system = "EPSG:32633";                                       // UTM 33 N; its central meridian is 15 E
  std::function<float(int column, int row)> height_of = [](int, int) { return 100.0F; };
  const char* unit = nullptr;
  const char* no_data = nullptr;
  int bands = 1;
};

std::filesystem::path Write(const std::filesystem::path& path, const Written& file) {
  GDALRegister_GTiff();
  void* driver = GDALGetDriverByName("GTiff");
  void* dataset = GDALCreate(driver, path.c_str(), file.width, file.height, file.bands, GDT_Float32, nullptr);
  EXPECT_NE(dataset, nullptr);
  std::array<double, 6> transform = file.file_from_pixel;
  GDALSetGeoTransform(dataset, transform.data());
  if (!file.system.empty()) {
    OGRSpatialReferenceH system = OSRNewSpatialReference(nullptr);
    EXPECT_EQ(OSRSetFromUserInput(system, file.system.c_str()), OGRERR_NONE) << file.system;
    GDALSetSpatialRef(dataset, system);
    OSRRelease(system);
  }
  void* band = GDALGetRasterBand(dataset, 1);
  if (file.no_data != nullptr) GDALSetRasterNoDataValue(band, std::stod(file.no_data));
  if (file.unit != nullptr) GDALSetRasterUnitType(band, file.unit);
  std::vector<float> row(static_cast<std::size_t>(file.width));
  for (int y = 0; y < file.height; ++y) {
    for (int x = 0; x < file.width; ++x) row[static_cast<std::size_t>(x)] = file.height_of(x, y);
    EXPECT_EQ(GDALRasterIO(band, GF_Write, 0, y, file.width, 1, row.data(), file.width, 1, GDT_Float32, 0, 0), CE_None);
  }
  GDALClose(dataset);
  return path;
}

class TerrainTest : public ::testing::Test {
 protected:
  std::shared_ptr<const Ground> Read(const Written& file,
                                     GroundOptions options = {.vertical_datum = VerticalDatum::kEllipsoid}) {
    auto ground = ReadTerrain(Write(folder_ / "a.tif", file), options);
    EXPECT_TRUE(ground) << ground.error().message;
    return ground ? *ground : std::make_shared<const FlatGround>(-1);
  }

  std::string Refusal(const Written& file, const GroundOptions& options = {}) {
    const auto ground = ReadTerrain(Write(folder_ / "a.tif", file), options);
    EXPECT_FALSE(ground);
    const std::string message = ground ? "" : ground.error().message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_THAT(message, HasSubstr("a.tif"));
    return message;
  }

  testing::ScratchFolder folder_;
};

// Geodetic point from UTM coordinates, by PROJ.
GeodeticPoint AtUtm(double east_m, double north_m) {
  OGRSpatialReferenceH utm = OSRNewSpatialReference(nullptr);
  OGRSpatialReferenceH geodetic = OSRNewSpatialReference(nullptr);
  OSRImportFromEPSG(utm, 32633);
  OSRImportFromEPSG(geodetic, 4326);
  OSRSetAxisMappingStrategy(geodetic, OAMS_TRADITIONAL_GIS_ORDER);
  OGRCoordinateTransformationH transform = OCTNewCoordinateTransformation(utm, geodetic);
  EXPECT_EQ(OCTTransform(transform, 1, &east_m, &north_m, nullptr), 1);
  OCTDestroyCoordinateTransformation(transform);
  OSRRelease(utm);
  OSRRelease(geodetic);
  return {RadiansFromDegrees(north_m), RadiansFromDegrees(east_m), 0};
}

TEST_F(TerrainTest, HeightsAreBilinearBetweenPixelCentres) {
  const auto ground = Read({.height_of = [](int x, int y) { return static_cast<float>(100 + 3 * x - 2 * y); }});
  EXPECT_NEAR(ground->Spacing(), 2, 0.01);
  // The centre of pixel (10, 20), then a quarter of a pixel from it along each axis.
  EXPECT_NEAR(*ground->HeightAt(AtUtm(500021, 4599959)), 100 + 30 - 40, 1e-3);
  EXPECT_NEAR(*ground->HeightAt(AtUtm(500021.5, 4599959)), 100 + 30 - 40 + 0.75, 1e-3);
  EXPECT_NEAR(*ground->HeightAt(AtUtm(500021, 4599958.5)), 100 + 30 - 40 - 0.5, 1e-3);
  EXPECT_NEAR(*ground->HeightAt(AtUtm(500022, 4599958)), 100 + 30 - 40 + 1.5 - 1, 1e-3);
}

TEST_F(TerrainTest, IsUnknownOutsideTheRaster) {
  const auto ground = Read({});
  EXPECT_EQ(ground->HeightAt(AtUtm(500000.1, 4599999.9)), 100) << "half a pixel from the centre of the first";
  EXPECT_EQ(ground->HeightAt(AtUtm(500099.9, 4599920.1)), 100);
  EXPECT_FALSE(ground->HeightAt(AtUtm(499999.9, 4599999.9)));
  EXPECT_FALSE(ground->HeightAt(AtUtm(500100.1, 4599920.1)));
  EXPECT_FALSE(ground->HeightAt({0, 0, 0}));
  EXPECT_FALSE(ground->HeightAt({1.5, -2.9, 0}));
}

TEST_F(TerrainTest, NoDataIsUnknownUpToAdjacentPixelCentres) {
  for (const float hole : {-9999.0F, std::numeric_limits<float>::quiet_NaN(), -32768.0F, 3e38F}) {
    const auto ground = Read({.height_of = [&](int x, int y) { return x == 10 && y == 10 ? hole : 100.0F; },
                              .no_data = hole == -9999.0F ? "-9999" : nullptr});
    EXPECT_FALSE(ground->HeightAt(AtUtm(500021, 4599979))) << hole;
    EXPECT_FALSE(ground->HeightAt(AtUtm(500022.9, 4599979))) << hole;
    EXPECT_EQ(ground->HeightAt(AtUtm(500023.1, 4599979)), 100) << hole;
  }
}

TEST_F(TerrainTest, HeightsAboveSeaLevelAreConvertedToTheEllipsoid) {
  const auto grid = FindEgm96Grid();
  if (!grid) GTEST_SKIP() << "SKIPPED: no grid of EGM96 on this machine";
  const GeodeticPoint point = AtUtm(500021, 4599959);
  const double sea_m = *Geoid::Read(*grid)->UndulationAt(point.latitude_rad, point.longitude_rad);
  ASSERT_GT(sea_m, 30);
  EXPECT_NEAR(*Read({.system = "EPSG:32633+5773"}, {})->HeightAt(point), 100 + sea_m, 1e-3)
      << "datum given by the file";
  EXPECT_NEAR(*Read({}, {.vertical_datum = VerticalDatum::kEgm96})->HeightAt(point), 100 + sea_m, 1e-3)
      << "datum given by the user";
  EXPECT_NEAR(*Read({.system = "EPSG:32633+5773"})->HeightAt(point), 100, 1e-3) << "the user overrides the file";
}

TEST_F(TerrainTest, MissingDatumIsAnError) {
  EXPECT_THAT(Refusal({}), HasSubstr("gives no vertical datum"));
  EXPECT_THAT(Refusal({.system = "EPSG:32633+5703"}), HasSubstr("NAVD88"));
  EXPECT_THAT(Refusal({}, {.vertical_datum = VerticalDatum::kEgm2008}), HasSubstr("grid"));
  const auto ground = ReadTerrain(Write(folder_ / "a.tif", {}),
                                  {.vertical_datum = VerticalDatum::kEgm96, .geoid_grid = "/nowhere.gtx"});
  EXPECT_THAT(ground.error().message, HasSubstr("/nowhere.gtx"));
}

TEST_F(TerrainTest, FeetAreConvertedToMetres) {
  const GeodeticPoint point = AtUtm(500021, 4599959);
  EXPECT_NEAR(*Read({.unit = "ft"})->HeightAt(point), 30.48, 1e-4);
  EXPECT_NEAR(*Read({.unit = "US survey foot"})->HeightAt(point), 30.48006, 1e-4);
  EXPECT_THAT(Refusal({.unit = "fathom"}, {.vertical_datum = VerticalDatum::kEllipsoid}), HasSubstr("fathom"));
}

TEST_F(TerrainTest, LongitudesBeyond180DegreesWrap) {
  const Written file{.file_from_pixel = {200, 0.0001, 0, 10, 0, -0.0001}, .system = "EPSG:4326"};
  const auto ground = Read(file);
  EXPECT_NEAR(ground->Spacing(), 11, 0.2);
  EXPECT_EQ(ground->HeightAt({RadiansFromDegrees(9.999), RadiansFromDegrees(200.001 - 360), 0}), 100);
  EXPECT_EQ(ground->HeightAt({RadiansFromDegrees(9.999), RadiansFromDegrees(200.001), 0}), 100);
}

TEST_F(TerrainTest, RefusesNonTerrain) {
  EXPECT_THAT(Refusal({.system = ""}), HasSubstr("not georeferenced"));
  EXPECT_THAT(Refusal({.bands = 3}), HasSubstr("one band"));
  const auto path = folder_ / "b.tif";
  std::ofstream(path) << "II*\0 and no more";
  for (const std::filesystem::path& bad : {path, folder_ / "none.tif", folder_.path()}) {
    const auto ground = ReadTerrain(bad, {});
    ASSERT_FALSE(ground) << bad;
    EXPECT_THAT(ground.error().message, HasSubstr(bad.string()));
    EXPECT_EQ(ground.error().message.find('\n'), std::string::npos);
  }
}

TEST_F(TerrainTest, TruncatedPartIsUnknown) {
  const auto path = Write(folder_ / "a.tif", {.width = 400, .height = 400});
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  std::string given;
  const auto ground =
      ReadTerrain(path, {.vertical_datum = VerticalDatum::kEllipsoid}, [&](const std::string& line) { given = line; });
  ASSERT_TRUE(ground) << ground.error().message;
  EXPECT_THAT(given, HasSubstr("truncated"));
  EXPECT_EQ((*ground)->HeightAt(AtUtm(500001, 4599999)), 100);
  EXPECT_FALSE((*ground)->HeightAt(AtUtm(500799, 4599201)));
}

TEST(MakeGround, AcceptsAtMostOneSource) {
  EXPECT_EQ(*MakeGround({}), nullptr);
  EXPECT_EQ((*MakeGround({.height_m = 12}))->HeightAt({}), 12);
  EXPECT_THAT(MakeGround({.height_m = 12, .terrain = "a.tif"}).error().message, HasSubstr("twice"));
  EXPECT_FALSE(MakeGround({.vertical_datum = VerticalDatum::kTakeoff}));
}

TEST_F(TerrainTest, TheGivenGeoidGridConvertsTheHeights) {
  const std::string grid = (folder_ / "grid.gtx").string();
  ASSERT_TRUE(WriteFileAtomically(grid, testing::ConstantGeoidGrid(-27.5F)));
  const auto ground = Read({}, {.vertical_datum = VerticalDatum::kEgm2008, .geoid_grid = grid});
  EXPECT_NEAR(*ground->HeightAt(AtUtm(500021, 4599959)), 100 - 27.5, 1e-3);
}

TEST_F(TerrainTest, TheGroundIsThatOfTheGivenTerrain) {
  const auto ground =
      MakeGround({.terrain = Write(folder_ / "a.tif", {}).string(), .vertical_datum = VerticalDatum::kEllipsoid});
  ASSERT_TRUE(ground) << ground.error().message;
  EXPECT_NEAR(*(*ground)->HeightAt(AtUtm(500021, 4599959)), 100, 1e-3);
}

}  // namespace
}  // namespace victorious
