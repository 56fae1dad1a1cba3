#include "victorious/input/terrain/terrain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal.h>
#include <gdal_frmts.h>
#include <ogr_srs_api.h>

#include "victorious/base/missing_path.h"
#include "victorious/base/text.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/geoid.h"
#include "victorious/types/vertical_datum.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// Captures GDAL's error messages on this thread instead of printing them.
class GdalErrorCapture {
 public:
  GdalErrorCapture() {
    CPLPushErrorHandler(CPLQuietErrorHandler);
    CPLErrorReset();
  }
  ~GdalErrorCapture() { CPLPopErrorHandler(); }
  GdalErrorCapture(const GdalErrorCapture&) = delete;
  GdalErrorCapture& operator=(const GdalErrorCapture&) = delete;

  // The last message, in one line.
  [[nodiscard]] static std::string Message() {
    std::string message = CPLGetLastErrorMsg();
    std::ranges::replace_if(message, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
    return message.empty() ? "no reason given" : message;
  }
};

struct DatasetCloser {
  void operator()(void* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<void, DatasetCloser>;

struct SpatialReferenceReleaser {
  void operator()(void* system) const { OSRRelease(static_cast<OGRSpatialReferenceH>(system)); }
};
using Coordinates = std::unique_ptr<std::remove_pointer_t<OGRSpatialReferenceH>, SpatialReferenceReleaser>;

struct TransformDestroyer {
  void operator()(void* transform) const { OCTDestroyCoordinateTransformation(transform); }
};
using Transform = std::unique_ptr<std::remove_pointer_t<OGRCoordinateTransformationH>, TransformDestroyer>;

// Opens a GeoTIFF; null on errors. Reads only the file itself: no external overviews, world file or metadata.
Dataset Open(const fs::path& path) {
  GDALRegister_GTiff();
  CPLSetThreadLocalConfigOption("GTIFF_REPORT_COMPD_CS", "YES");
  CPLSetThreadLocalConfigOption("GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR");
  CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO");
  const std::array<const char*, 2> drivers = {"GTiff", nullptr};
  return Dataset(GDALOpenEx(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers.data(), nullptr, nullptr));
}

// The vertical datum given in the file: std::nullopt if there is none or it is unknown; its name, for error messages.
struct FileDatum {
  std::optional<VerticalDatum> datum;
  std::string name;
};

FileDatum ReadFileDatum(OGRSpatialReferenceH system) {
  if (OSRIsCompound(system) == 0) {
    constexpr int kAxesWithHeight = 3;
    if (OSRGetAxesCount(system) == kAxesWithHeight) return {VerticalDatum::kEllipsoid, {}};
    return {};
  }
  const char* const named = OSRGetAttrValue(system, "VERT_CS", 0);
  const char* const code = OSRGetAuthorityCode(system, "VERT_CS");
  const std::string name = named != nullptr ? named : "unnamed";
  const std::string_view epsg = code != nullptr ? code : "";
  const std::string lower_name = LowerCase(name);
  if (epsg == "5773" || lower_name.contains("egm96") || lower_name.contains("egm 96"))
    return {VerticalDatum::kEgm96, name};
  if (epsg == "3855" || lower_name.contains("egm2008") || lower_name.contains("egm 2008"))
    return {VerticalDatum::kEgm2008, name};
  if (lower_name.contains("ellipsoid")) return {VerticalDatum::kEllipsoid, name};
  return {std::nullopt, name};
}

// The length of the file's unit of height in metres: that of the band, else that of the vertical coordinate system.
Expected<double> MetresPerUnit(GDALRasterBandH band, OGRSpatialReferenceH system, const fs::path& path) {
  constexpr std::array<std::pair<std::string_view, double>, 11> kUnits = {{{"m", 1},
                                                                           {"metre", 1},
                                                                           {"metres", 1},
                                                                           {"meter", 1},
                                                                           {"meters", 1},
                                                                           {"ft", 0.3048},
                                                                           {"foot", 0.3048},
                                                                           {"feet", 0.3048},
                                                                           {"us survey foot", 1200.0 / 3937},
                                                                           {"us-ft", 1200.0 / 3937},
                                                                           {"ftus", 1200.0 / 3937}}};
  const std::string unit = LowerCase(GDALGetRasterUnitType(band));
  if (unit.empty()) return OSRIsCompound(system) != 0 ? OSRGetTargetLinearUnits(system, "VERT_CS", nullptr) : 1.0;
  const auto* const known = std::ranges::find(kUnits, unit, &std::pair<std::string_view, double>::first);
  if (known != kUnits.end()) return known->second;
  return Fail(ErrorCode::kUnsupported,
              fmt::format("{}: heights in \"{}\": must be in metres or feet", path.string(), unit));
}

// The number of blocks of heights that end beyond the end of the file (truncated), and of all blocks. GDAL itself
// reports them only when it reads them.
std::pair<std::int64_t, std::int64_t> CountTruncatedBlocks(GDALRasterBandH band, std::uintmax_t file_size) {
  int block_width = 0;
  int block_height = 0;
  GDALGetBlockSize(band, &block_width, &block_height);
  if (block_width <= 0 || block_height <= 0) return {0, 0};
  const int across = (GDALGetRasterBandXSize(band) - 1) / block_width + 1;
  const int down = (GDALGetRasterBandYSize(band) - 1) / block_height + 1;
  std::int64_t missing = 0;
  for (int y = 0; y < down; ++y) {
    for (int x = 0; x < across; ++x) {
      const auto given = [&](const char* what) {
        const char* text = GDALGetMetadataItem(band, fmt::format("BLOCK_{}_{}_{}", what, x, y).c_str(), "TIFF");
        return static_cast<std::uintmax_t>(text != nullptr ? ParseInteger(text).value_or(0) : 0);
      };
      missing += given("OFFSET") + given("SIZE") > file_size ? 1 : 0;
    }
  }
  return {missing, static_cast<std::int64_t>(across) * down};
}

class Terrain final : public Ground {
 public:
  static Expected<std::shared_ptr<const Ground>> Read(const fs::path& path, const GroundOptions& options,
                                                      const std::function<void(const std::string&)>& warn);

  [[nodiscard]] std::optional<double> HeightAt(const GeodeticPoint& point) const override;
  [[nodiscard]] double Spacing() const override { return spacing_m_; }
  [[nodiscard]] double MaxSlope() const override { return kMaxSlope; }

 private:
  static constexpr double kMaxSlope = 4;  // tangent of 76 degrees
  static constexpr int kTilePx = 256;
  static constexpr std::size_t kMaxTiles = 1024;  // 256 MiB

  Status SetGeoreference(const fs::path& path);
  Status SetDatum(const fs::path& path, const GroundOptions& options);

  // Column and row in pixels from the file's upper left corner; std::nullopt outside the file.
  [[nodiscard]] std::optional<std::pair<double, double>> PixelFromGeodetic(const GeodeticPoint& point) const;
  [[nodiscard]] std::optional<double> Sample(std::int64_t column, std::int64_t row) const;
  [[nodiscard]] const std::vector<float>& TileAt(int across, int down) const;

  Dataset dataset_;
  GDALRasterBandH band_ = nullptr;
  OGRSpatialReferenceH system_ = nullptr;  // owned by the dataset
  Transform file_from_geodetic_;
  std::array<double, 6> pixel_from_file_{};
  bool geographic_ = false;
  int width_ = 0;
  int height_ = 0;
  double spacing_m_ = 0;
  double metres_per_unit_ = 1;
  double offset_ = 0;
  double scale_ = 1;
  std::optional<float> no_data_;
  std::optional<Geoid> geoid_;
  mutable std::mutex mutex_;  // GDAL handles are not thread-safe
  mutable std::map<std::pair<int, int>, std::vector<float>> tiles_;
};

Expected<std::shared_ptr<const Ground>> Terrain::Read(const fs::path& path, const GroundOptions& options,
                                                      const std::function<void(const std::string&)>& warn) {
  std::error_code error;
  if (!fs::exists(path, error)) {
    return std::unexpected(NoSuchFile(path.string(), "must be a GeoTIFF of heights"));
  }
  const GdalErrorCapture error_capture;
  auto terrain = std::make_shared<Terrain>();
  if (fs::is_regular_file(path, error)) terrain->dataset_ = Open(path);
  if (!terrain->dataset_) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: not a readable GeoTIFF: {}", path.string(), GdalErrorCapture::Message()));
  }
  terrain->width_ = GDALGetRasterXSize(terrain->dataset_.get());
  terrain->height_ = GDALGetRasterYSize(terrain->dataset_.get());
  terrain->band_ = GDALGetRasterBand(terrain->dataset_.get(), 1);
  if (GDALGetRasterCount(terrain->dataset_.get()) != 1 ||
      GDALDataTypeIsComplex(GDALGetRasterDataType(terrain->band_)) != 0) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: an image, not heights: must be a GeoTIFF with one band of heights", path.string()));
  }
  VICTORIOUS_RETURN_IF_ERROR(terrain->SetGeoreference(path));
  VICTORIOUS_RETURN_IF_ERROR(terrain->SetDatum(path, options));
  VICTORIOUS_ASSIGN_OR_RETURN(terrain->metres_per_unit_, MetresPerUnit(terrain->band_, terrain->system_, path));
  terrain->offset_ = GDALGetRasterOffset(terrain->band_, nullptr);
  terrain->scale_ = GDALGetRasterScale(terrain->band_, nullptr);
  int has = 0;
  const double no_data = GDALGetRasterNoDataValue(terrain->band_, &has);
  if (has != 0) terrain->no_data_ = static_cast<float>(no_data);
  const auto [missing, blocks] = CountTruncatedBlocks(terrain->band_, fs::file_size(path, error));
  if (missing == blocks) {
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: truncated before the first height", path.string()));
  }
  if (missing > 0 && warn) {
    warn(fmt::format("{}: truncated: {} of its {} blocks of heights are missing; the ground is unknown there",
                     path.string(), missing, blocks));
  }
  return terrain;
}

Status Terrain::SetGeoreference(const fs::path& path) {
  const auto not_georeferenced = [&] {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: not georeferenced: must be a GeoTIFF with a coordinate system", path.string()));
  };
  system_ = GDALGetSpatialRef(dataset_.get());
  std::array<double, 6> file_from_pixel{};
  if (system_ == nullptr || GDALGetGeoTransform(dataset_.get(), file_from_pixel.data()) != CE_None ||
      GDALInvGeoTransform(file_from_pixel.data(), pixel_from_file_.data()) == 0) {
    return not_georeferenced();
  }
  geographic_ = OSRIsGeographic(system_) != 0;
  if (!geographic_ && OSRIsProjected(system_) == 0) return not_georeferenced();
  const Coordinates level(OSRClone(system_));
  if (OSRIsCompound(level.get()) != 0) OSRStripVertical(level.get());
  OSRDemoteTo2D(level.get(), nullptr);
  const Coordinates geodetic(OSRNewSpatialReference(nullptr));
  OSRSetWellKnownGeogCS(geodetic.get(), "WGS84");
  for (const Coordinates* system : {&level, &geodetic}) {
    OSRSetAxisMappingStrategy(system->get(), OAMS_TRADITIONAL_GIS_ORDER);
  }
  file_from_geodetic_.reset(OCTNewCoordinateTransformation(geodetic.get(), level.get()));
  const Transform geodetic_from_file(OCTNewCoordinateTransformation(level.get(), geodetic.get()));
  if (!file_from_geodetic_ || !geodetic_from_file) return not_georeferenced();

  // Pixel spacing on the ground at the centre of the file.
  std::array<GeodeticPoint, 3> corners;
  constexpr std::array<std::pair<int, int>, 3> kSteps = {{{0, 0}, {1, 0}, {0, 1}}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    double x = 0;
    double y = 0;
    GDALApplyGeoTransform(file_from_pixel.data(), width_ / 2.0 + kSteps[i].first, height_ / 2.0 + kSteps[i].second, &x,
                          &y);
    if (OCTTransform(geodetic_from_file.get(), 1, &x, &y, nullptr) == 0 || !(std::abs(y) <= 90))
      return not_georeferenced();
    corners[i] = {RadiansFromDegrees(y), RadiansFromDegrees(x), 0};
  }
  const TangentPlane plane(corners[0]);
  spacing_m_ = std::min(plane.EnuFromGeodetic(corners[1]).norm(), plane.EnuFromGeodetic(corners[2]).norm());
  constexpr double kMinSpacingM = 0.01;
  if (!(spacing_m_ >= kMinSpacingM && spacing_m_ < 1e6)) return not_georeferenced();
  return {};
}

Status Terrain::SetDatum(const fs::path& path, const GroundOptions& options) {
  const FileDatum given = ReadFileDatum(system_);
  const std::optional<VerticalDatum> datum = options.vertical_datum ? options.vertical_datum : given.datum;
  if (!datum) {
    const std::string says = given.name.empty() ? "gives no vertical datum for its heights"
                                                : fmt::format("its vertical datum \"{}\" is not known", given.name);
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: {}: give it (--terrain-datum ellipsoid, egm96 or egm2008)", path.string(), says));
  }
  if (*datum == VerticalDatum::kEllipsoid) return {};
  fs::path grid = options.geoid_grid;
  if (grid.empty() && *datum == VerticalDatum::kEgm96) grid = FindEgm96Grid().value_or(fs::path());
  if (grid.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: its vertical datum is {}, and there is no grid of it: give a .gtx grid (--geoid)",
                            path.string(), ToText(kVerticalDatumTexts, *datum)));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(geoid_, Geoid::Read(grid));
  return {};
}

std::optional<std::pair<double, double>> Terrain::PixelFromGeodetic(const GeodeticPoint& point) const {
  double x = DegreesFromRadians(point.longitude_rad);
  double y = DegreesFromRadians(point.latitude_rad);
  if (OCTTransform(file_from_geodetic_.get(), 1, &x, &y, nullptr) == 0) return std::nullopt;
  std::array<double, 6> pixel_from_file = pixel_from_file_;  // GDAL takes a non-const array
  constexpr double kTurnDeg = 360;
  for (const double turn : {0.0, kTurnDeg, -kTurnDeg}) {
    if (turn != 0 && !geographic_) break;
    double column = 0;
    double row = 0;
    GDALApplyGeoTransform(pixel_from_file.data(), x + turn, y, &column, &row);
    if (column >= 0 && column <= width_ && row >= 0 && row <= height_) return std::pair(column, row);
  }
  return std::nullopt;
}

const std::vector<float>& Terrain::TileAt(int across, int down) const {
  const auto found = tiles_.find({across, down});
  if (found != tiles_.end()) return found->second;
  if (tiles_.size() >= kMaxTiles) tiles_.clear();
  std::vector<float>& tile = tiles_[{across, down}];
  const int columns = std::min(kTilePx, width_ - across * kTilePx);
  const int rows = std::min(kTilePx, height_ - down * kTilePx);
  tile.assign(static_cast<std::size_t>(kTilePx) * kTilePx, std::numeric_limits<float>::quiet_NaN());
  const auto read = [&](int first, int count) {
    float* const to = tile.data() + static_cast<std::size_t>(first) * kTilePx;
    return GDALRasterIO(band_, GF_Read, across * kTilePx, down * kTilePx + first, columns, count, to, columns, count,
                        GDT_Float32, sizeof(float), static_cast<int>(sizeof(float)) * kTilePx) == CE_None;
  };
  if (read(0, rows)) return tile;
  for (int row = 0; row < rows; ++row) {  // damaged tile: keeps the readable rows, the others are unknown
    if (read(row, 1)) continue;
    const auto start = tile.begin() + static_cast<std::ptrdiff_t>(row) * kTilePx;
    std::fill_n(start, kTilePx, std::numeric_limits<float>::quiet_NaN());
  }
  return tile;
}

std::optional<double> Terrain::Sample(std::int64_t column, std::int64_t row) const {
  const int x = static_cast<int>(std::clamp<std::int64_t>(column, 0, width_ - 1));
  const int y = static_cast<int>(std::clamp<std::int64_t>(row, 0, height_ - 1));
  const std::vector<float>& tile = TileAt(x / kTilePx, y / kTilePx);
  const float raw = tile[static_cast<std::size_t>(y % kTilePx) * kTilePx + static_cast<std::size_t>(x % kTilePx)];
  if (no_data_ && raw == *no_data_) return std::nullopt;
  const double height_m = (offset_ + scale_ * static_cast<double>(raw)) * metres_per_unit_;
  constexpr double kMinTerrainHeightM = -1000;
  constexpr double kMaxTerrainHeightM = 10000;
  if (!(height_m >= kMinTerrainHeightM && height_m <= kMaxTerrainHeightM)) return std::nullopt;
  return height_m;
}

std::optional<double> Terrain::HeightAt(const GeodeticPoint& point) const {
  const std::lock_guard lock(mutex_);
  const GdalErrorCapture error_capture;
  const auto pixel = PixelFromGeodetic(point);
  if (!pixel) return std::nullopt;
  const double x = pixel->first - 0.5;  // relative to the centre of the first pixel
  const double y = pixel->second - 0.5;
  const auto left = static_cast<std::int64_t>(std::floor(x));
  const auto top = static_cast<std::int64_t>(std::floor(y));
  double height_m = 0;
  for (const int down : {0, 1}) {
    for (const int across : {0, 1}) {
      const double weight = (across == 1 ? x - static_cast<double>(left) : 1 - (x - static_cast<double>(left))) *
                            (down == 1 ? y - static_cast<double>(top) : 1 - (y - static_cast<double>(top)));
      if (weight == 0) continue;
      const auto sample = Sample(left + across, top + down);
      if (!sample) return std::nullopt;
      height_m += weight * *sample;
    }
  }
  if (!geoid_) return height_m;
  const auto undulation_m = geoid_->UndulationAt(point.latitude_rad, point.longitude_rad);
  return undulation_m ? std::optional(height_m + *undulation_m) : std::nullopt;
}

}  // namespace

Expected<std::shared_ptr<const Ground>> ReadTerrain(const fs::path& path, const GroundOptions& options,
                                                    const std::function<void(const std::string&)>& warn) {
  return Terrain::Read(path, options, warn);
}

}  // namespace victorious
