// Fuzzes the terrain reader: it reads the file or fails with a one-line error; heights must be plausible or unknown.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gdal.h>
#include <gdal_frmts.h>
#include <ogr_srs_api.h>

#include "testing/data.h"
#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/geometry/ground.h"
#include "victorious/input/terrain/terrain.h"

namespace {

namespace fs = std::filesystem;

fs::path Folder() {
  static const victorious::testing::ScratchFolder folder;
  return folder.path();
}

std::string BytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A hill of 40 x 30 height samples near (10 N, 20 E).
std::string Hill(const char* system_name, const std::vector<const char*>& creation) {
  GDALRegister_GTiff();
  std::vector<char*> options;
  for (const char* option : creation) options.push_back(const_cast<char*>(option));
  options.push_back(nullptr);
  const fs::path path = Folder() / "seed.tif";
  constexpr int kWidth = 40;
  constexpr int kHeight = 30;
  void* dataset =
      GDALCreate(GDALGetDriverByName("GTiff"), path.c_str(), kWidth, kHeight, 1, GDT_Float32, options.data());
  double transform[6] = {20, 0.0001, 0, 10, 0, -0.0001};
  GDALSetGeoTransform(dataset, transform);
  OGRSpatialReferenceH system = OSRNewSpatialReference(nullptr);
  OSRSetFromUserInput(system, system_name);
  GDALSetSpatialRef(dataset, system);
  OSRRelease(system);
  std::vector<float> heights;
  for (int i = 0; i < kWidth * kHeight; ++i) heights.push_back(static_cast<float>(50 + i % kWidth));
  const CPLErr written = GDALRasterIO(GDALGetRasterBand(dataset, 1), GF_Write, 0, 0, kWidth, kHeight, heights.data(),
                                      kWidth, kHeight, GDT_Float32, 0, 0);
  VICTORIOUS_CHECK(written == CE_None);
  GDALClose(dataset);
  return BytesOf(path);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fs::path path = Folder() / "input.tif";
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  const auto ground = victorious::ReadTerrain(path, {.vertical_datum = victorious::VerticalDatum::kEllipsoid});
  if (!ground) {
    VICTORIOUS_CHECK(ground.error().message.find('\n') == std::string::npos);
    return 0;
  }
  VICTORIOUS_CHECK((*ground)->Spacing() > 0);
  constexpr double kRad = 0.017453292519943295;
  const victorious::GeodeticPoint camera{9.9985 * kRad, 20.002 * kRad, 300};
  const auto height_m = (*ground)->HeightAt(camera);
  VICTORIOUS_CHECK(!height_m || (*height_m >= -1000 && *height_m <= 10000));
  const victorious::TangentPlane plane(camera);
  for (const auto& along : {Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(0.6, 0, -0.8), Eigen::Vector3d(0.6, 0.8, 0)}) {
    const auto met = victorious::IntersectGround(**ground, plane, Eigen::Vector3d::Zero(), along, 5);
    VICTORIOUS_CHECK(!met || (met->point.allFinite() && met->normal.allFinite()));
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  return {"", "II*", Hill("EPSG:4326", {}), Hill("EPSG:4979", {"COMPRESS=DEFLATE", "PREDICTOR=3"}),
          Hill("EPSG:4326+5773", {"TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=16", "COMPRESS=LZW"})};
}
