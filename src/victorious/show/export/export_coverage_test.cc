#include "victorious/show/export/export_coverage.h"

#include <memory>
#include <sstream>
#include <string>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "testing/data.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// 4 x 3 cells of 10 m. The last column is outside of the area; the first row is a gap.
GroundCoverage SmallCoverage() {
  GroundCoverage coverage{.north_rad = RadiansFromDegrees(48.001),
                          .west_rad = RadiansFromDegrees(11.0),
                          .row_rad = RadiansFromDegrees(0.0001),
                          .column_rad = RadiansFromDegrees(0.0002),
                          .cell_m = 10,
                          .columns = 4,
                          .rows = 3,
                          .in_area = {1, 1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 0},
                          .looks = {0, 1, 1, 0, 5, 5, 5, 0, 7, 7, 7, 0},
                          .views = {0, 1, 1, 0, 2, 2, 2, 0, 3, 3, 3, 0},
                          .off_nadir_rad = std::vector<float>(12, static_cast<float>(RadiansFromDegrees(30)))};
  coverage.models.push_back({.model = "jeep",
                             .diagonal_m = 4.5,
                             .probability = {0, 0.55F, 0.55F, 0, 0.95F, 0.95F, 0.95F, 0, 0.97F, 0.97F, 0.93F, 0},
                             .size_px = std::vector<float>(12, 33)});
  return coverage;
}

TEST(ExportCoverage, GeoTiffIsReadBackByGdal) {
  std::ostringstream out;
  ASSERT_TRUE(WriteCoverageTiff(SmallCoverage(), out));
  std::ostringstream again;
  ASSERT_TRUE(WriteCoverageTiff(SmallCoverage(), again));
  EXPECT_EQ(out.str(), again.str()) << "the same content, the same bytes";
  EXPECT_TRUE(out.str().substr(0, 65536).contains("victorious coverage"));
  const testing::ScratchFolder folder;
  const std::filesystem::path path = folder / "coverage.tif";
  ASSERT_TRUE(WriteFileAtomically(path, out.str()));

  const std::unique_ptr<GDALDataset> file(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER));
  ASSERT_TRUE(file);
  EXPECT_EQ(file->GetRasterXSize(), 4);
  EXPECT_EQ(file->GetRasterYSize(), 3);
  ASSERT_EQ(file->GetRasterCount(), 5);
  double transform[6];
  ASSERT_EQ(file->GetGeoTransform(transform), CE_None);
  EXPECT_NEAR(transform[0], 11.0, 1e-12);
  EXPECT_NEAR(transform[1], 0.0002, 1e-12);
  EXPECT_NEAR(transform[3], 48.001, 1e-12);
  EXPECT_NEAR(transform[5], -0.0001, 1e-12);
  EXPECT_STREQ(file->GetRasterBand(4)->GetDescription(), "jeep probability");
  float cells[12];
  ASSERT_EQ(file->GetRasterBand(4)->RasterIO(GF_Read, 0, 0, 4, 3, cells, 4, 3, GDT_Float32, 0, 0, nullptr), CE_None);
  EXPECT_FLOAT_EQ(cells[1], 0.55F);
  EXPECT_FLOAT_EQ(cells[10], 0.93F);
  EXPECT_FLOAT_EQ(cells[3], -1) << "outside of the area";
  EXPECT_EQ(file->GetRasterBand(4)->GetNoDataValue(), -1);
  ASSERT_EQ(file->GetRasterBand(3)->RasterIO(GF_Read, 0, 0, 4, 3, cells, 4, 3, GDT_Float32, 0, 0, nullptr), CE_None);
  EXPECT_NEAR(cells[0], 30, 1e-4);
}

TEST(ExportCoverage, GeoJsonHasClassesGapsAndTheSummary) {
  std::ostringstream out;
  ASSERT_TRUE(WriteCoverageGeoJson(SmallCoverage(), 0.9, out));
  const nlohmann::json json = nlohmann::json::parse(out.str());
  EXPECT_EQ(json["type"], "FeatureCollection");
  EXPECT_NEAR(json["coverage"]["area_m2"].get<double>(), 900, 1e-9);
  EXPECT_NEAR(json["coverage"]["models"][0]["searched_fraction"].get<double>(), 0.6667, 1e-9);
  int gaps = 0;
  double classes_m2 = 0;
  for (const auto& feature : json["features"]) {
    const auto& properties = feature["properties"];
    EXPECT_EQ(properties["model"], "jeep");
    if (properties["kind"] == "gap") {
      ++gaps;
      EXPECT_NEAR(properties["area_m2"].get<double>(), 300, 1e-9);
      const auto& ring = feature["geometry"]["coordinates"][0];
      EXPECT_EQ(ring.front(), ring.back());
      double twice = 0;
      for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
        twice += ring[i][0].get<double>() * ring[i + 1][1].get<double>() -
                 ring[i + 1][0].get<double>() * ring[i][1].get<double>();
        EXPECT_TRUE(ring[i][0] >= 10.99999 && ring[i][0] <= 11.00061) << "longitude first";
      }
      EXPECT_GT(twice, 0) << "the exterior ring runs anticlockwise";
    } else {
      classes_m2 += properties["area_m2"].get<double>();
    }
  }
  EXPECT_EQ(gaps, 1) << "the cells of the first row are one gap";
  EXPECT_NEAR(classes_m2, 900, 1e-9) << "each cell of the area is in one class";
}

TEST(ExportCoverage, FractionCountsCellsOfTheAreaOnly) {
  const GroundCoverage coverage = SmallCoverage();
  EXPECT_NEAR(FractionFound(coverage, coverage.models[0], 0.96), 2.0 / 9, 1e-12);
  EXPECT_EQ(AreaOf(coverage), 900);
  EXPECT_EQ(FractionFound({}, {}, 0.5), 0);
}

}  // namespace
}  // namespace victorious
