#include "victorious/show/export/export_coverage.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <cpl_error.h>
#include <cpl_vsi.h>
#include <fmt/format.h>
#include <gdal_alg.h>
#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>

#include "victorious/base/json.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr float kOutside = -1;  // of a cell outside of the area
constexpr int kClasses = 10;    // of probability

class QuietGdal {
 public:
  QuietGdal() {
    static std::once_flag registered;
    std::call_once(registered, [] {
      GDALRegister_GTiff();
      GDALRegister_MEM();
      RegisterOGRMEM();
    });
    CPLPushErrorHandler(CPLQuietErrorHandler);
    CPLErrorReset();
  }
  ~QuietGdal() { CPLPopErrorHandler(); }
  QuietGdal(const QuietGdal&) = delete;
  QuietGdal& operator=(const QuietGdal&) = delete;
};

struct DatasetCloser {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, DatasetCloser>;

std::unexpected<Error> FailWithGdal() {
  std::string message = CPLGetLastErrorMsg();
  std::ranges::replace_if(message, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return Fail(ErrorCode::kInternal,
              fmt::format("write the coverage: {}", message.empty() ? "GDAL gives no reason" : message));
}

OGRSpatialReference Wgs84() {
  OGRSpatialReference wgs84;
  wgs84.SetWellKnownGeogCS("WGS84");
  wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return wgs84;
}

Dataset CreateRaster(const char* driver, const std::string& path, const GroundCoverage& coverage, int bands,
                     GDALDataType type) {
  GDALDriver* found = GetGDALDriverManager()->GetDriverByName(driver);
  if (found == nullptr) return nullptr;
  Dataset raster(found->Create(path.c_str(), coverage.columns, coverage.rows, bands, type, nullptr));
  if (raster == nullptr) return nullptr;
  std::array<double, 6> transform = {DegreesFromRadians(coverage.west_rad),
                                     DegreesFromRadians(coverage.column_rad),
                                     0,
                                     DegreesFromRadians(coverage.north_rad),
                                     0,
                                     -DegreesFromRadians(coverage.row_rad)};
  const OGRSpatialReference wgs84 = Wgs84();
  if (raster->SetGeoTransform(transform.data()) != CE_None || raster->SetSpatialRef(&wgs84) != CE_None) return nullptr;
  return raster;
}

// Writes a band of values of cells.
template <typename Values>
bool WriteBand(GDALDataset& raster, int number, const std::string& name, const GroundCoverage& coverage,
               const Values& values, double factor) {
  std::vector<float> cells(coverage.CellCount(), kOutside);
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    if (coverage.in_area[cell] != 0) cells[cell] = static_cast<float>(factor * values[cell]);
  }
  GDALRasterBand* band = raster.GetRasterBand(number);
  band->SetDescription(name.c_str());
  return band->SetNoDataValue(kOutside) == CE_None &&
         band->RasterIO(GF_Write, 0, 0, coverage.columns, coverage.rows, cells.data(), coverage.columns, coverage.rows,
                        GDT_Float32, 0, 0, nullptr) == CE_None;
}

// A connected piece of cells of one class, as rings of longitude and latitude.
struct Piece {
  int value = 0;
  Json rings = Json::array();
  double cells = 0;
};

Json RingJson(OGRLinearRing& ring, bool clockwise) {
  if ((ring.isClockwise() != 0) != clockwise) ring.reverseWindingOrder();
  Json corners = Json::array();
  for (int i = 0; i < ring.getNumPoints(); ++i) {
    corners.push_back({GeodeticJson(RadiansFromDegrees(ring.getX(i))), GeodeticJson(RadiansFromDegrees(ring.getY(i)))});
  }
  return corners;
}

// The pieces of equal values, without those of value 0.
Expected<std::vector<Piece>> PiecesOf(const GroundCoverage& coverage, std::vector<std::int32_t> values) {
  const Dataset raster = CreateRaster("MEM", "", coverage, 1, GDT_Int32);
  GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("Memory");
  if (raster == nullptr || memory == nullptr) return FailWithGdal();
  GDALRasterBand* band = raster->GetRasterBand(1);
  if (band->RasterIO(GF_Write, 0, 0, coverage.columns, coverage.rows, values.data(), coverage.columns, coverage.rows,
                     GDT_Int32, 0, 0, nullptr) != CE_None) {
    return FailWithGdal();
  }
  const Dataset vectors(memory->Create("", 0, 0, 0, GDT_Unknown, nullptr));
  OGRLayer* layer = vectors == nullptr ? nullptr : vectors->CreateLayer("pieces", nullptr, wkbPolygon, nullptr);
  OGRFieldDefn field("value", OFTInteger);
  if (layer == nullptr || layer->CreateField(&field) != OGRERR_NONE) return FailWithGdal();
  if (GDALPolygonize(GDALRasterBand::ToHandle(band), GDALRasterBand::ToHandle(band), OGRLayer::ToHandle(layer), 0,
                     nullptr, nullptr, nullptr) != CE_None) {
    return FailWithGdal();
  }
  const double cell_deg2 = DegreesFromRadians(coverage.column_rad) * DegreesFromRadians(coverage.row_rad);
  std::vector<Piece> pieces;
  for (const auto& feature : *layer) {
    OGRGeometry* geometry = feature->GetGeometryRef();
    if (geometry == nullptr || wkbFlatten(geometry->getGeometryType()) != wkbPolygon) continue;
    OGRPolygon* polygon = geometry->toPolygon();
    Piece piece{.value = feature->GetFieldAsInteger(0), .cells = std::round(polygon->get_Area() / cell_deg2)};
    piece.rings.push_back(RingJson(*polygon->getExteriorRing(), /*clockwise=*/false));
    for (int i = 0; i < polygon->getNumInteriorRings(); ++i) {
      piece.rings.push_back(RingJson(*polygon->getInteriorRing(i), /*clockwise=*/true));
    }
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

double CellArea(const GroundCoverage& coverage) { return coverage.cell_m * coverage.cell_m; }

Json Feature(const char* geometry, Json coordinates, Json properties) {
  return {{"type", "Feature"},
          {"geometry", {{"type", geometry}, {"coordinates", std::move(coordinates)}}},
          {"properties", std::move(properties)}};
}

// A MultiPolygon for each tenth of probability that the area has.
Status AddProbabilities(const GroundCoverage& coverage, const ModelCoverage& model, Json& features) {
  std::vector<std::int32_t> classes(coverage.CellCount(), 0);
  for (std::size_t cell = 0; cell < classes.size(); ++cell) {
    if (coverage.in_area[cell] == 0) continue;
    classes[cell] = 1 + std::clamp(static_cast<int>(model.probability[cell] * kClasses), 0, kClasses - 1);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<Piece> pieces, PiecesOf(coverage, std::move(classes)));
  std::map<int, Piece> of_class;
  for (Piece& piece : pieces) {
    of_class[piece.value].rings.push_back(std::move(piece.rings));
    of_class[piece.value].cells += piece.cells;
  }
  for (auto& [value, polygons] : of_class) {
    features.push_back(Feature("MultiPolygon", std::move(polygons.rings),
                               {{"kind", "probability"},
                                {"model", model.model},
                                {"min_probability", ScoreJson((value - 1.0) / kClasses)},
                                {"max_probability", ScoreJson(static_cast<double>(value) / kClasses)},
                                {"area_m2", MetresJson(polygons.cells * CellArea(coverage))}}));
  }
  return {};
}

Status AddGaps(const GroundCoverage& coverage, const ModelCoverage& model, double min_probability, Json& features) {
  std::vector<std::int32_t> is_gap(coverage.CellCount(), 0);
  for (std::size_t cell = 0; cell < is_gap.size(); ++cell) {
    is_gap[cell] = coverage.in_area[cell] != 0 && model.probability[cell] < min_probability ? 1 : 0;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<Piece> gaps, PiecesOf(coverage, std::move(is_gap)));
  std::ranges::stable_sort(gaps, std::greater(), &Piece::cells);
  for (Piece& gap : gaps) {
    features.push_back(Feature("Polygon", std::move(gap.rings),
                               {{"kind", "gap"},
                                {"model", model.model},
                                {"min_probability", 0},
                                {"max_probability", ScoreJson(min_probability)},
                                {"area_m2", MetresJson(gap.cells * CellArea(coverage))}}));
  }
  return {};
}

}  // namespace

Status WriteCoverageTiff(const GroundCoverage& coverage, std::ostream& out) {
  constexpr int kCommonBands = 3;
  const QuietGdal quiet;
  static std::atomic<int> number;
  const std::string path = fmt::format("/vsimem/victorious_coverage_{}.tif", ++number);
  struct Unlink {
    const std::string& path;
    ~Unlink() { VSIUnlink(path.c_str()); }
  } const unlink{path};
  const int bands = kCommonBands + 2 * static_cast<int>(coverage.models.size());
  Dataset raster = CreateRaster("GTiff", path, coverage, bands, GDT_Float32);
  if (raster == nullptr || raster->SetMetadataItem("TIFFTAG_SOFTWARE", "victorious coverage") != CE_None) {
    return FailWithGdal();
  }
  bool written = WriteBand(*raster, 1, "looks", coverage, coverage.looks, 1) &&
                 WriteBand(*raster, 2, "views", coverage, coverage.views, 1) &&
                 WriteBand(*raster, 3, "off_nadir_deg", coverage, coverage.off_nadir_rad, DegreesFromRadians(1));
  int band = kCommonBands;
  for (const ModelCoverage& model : coverage.models) {
    const std::string name = ReplaceInvalidUtf8(model.model);
    written = written && WriteBand(*raster, ++band, name + " probability", coverage, model.probability, 1) &&
              WriteBand(*raster, ++band, name + " size_px", coverage, model.size_px, 1);
  }
  raster.reset();  // writes the rest
  if (!written || CPLGetLastErrorType() >= CE_Failure) return FailWithGdal();
  vsi_l_offset size = 0;
  const GByte* bytes = VSIGetMemFileBuffer(path.c_str(), &size, FALSE);
  if (bytes == nullptr) return FailWithGdal();
  out.write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  return {};
}

Status WriteCoverageGeoJson(const GroundCoverage& coverage, double min_probability, std::ostream& out) {
  const QuietGdal quiet;
  Json features = Json::array();
  for (const ModelCoverage& model : coverage.models) {
    VICTORIOUS_RETURN_IF_ERROR(AddProbabilities(coverage, model, features));
    VICTORIOUS_RETURN_IF_ERROR(AddGaps(coverage, model, min_probability, features));
  }
  const Json collection = {{"type", "FeatureCollection"},
                           {"coverage", CoverageSummaryJson(coverage, min_probability)},
                           {"features", std::move(features)}};
  out << DumpJson(collection) << '\n';
  return {};
}

double FractionFound(const GroundCoverage& coverage, const ModelCoverage& model, double min_probability) {
  std::size_t all = 0;
  std::size_t found = 0;
  for (std::size_t cell = 0; cell < coverage.CellCount(); ++cell) {
    if (coverage.in_area[cell] == 0) continue;
    ++all;
    if (model.probability[cell] >= min_probability) ++found;
  }
  return all == 0 ? 0 : static_cast<double>(found) / static_cast<double>(all);
}

double AreaOf(const GroundCoverage& coverage) {
  return static_cast<double>(std::ranges::count(coverage.in_area, 1)) * CellArea(coverage);
}

Json CoverageSummaryJson(const GroundCoverage& coverage, double min_probability) {
  Json models = Json::array();
  for (const ModelCoverage& model : coverage.models) {
    models.push_back({{"model", model.model},
                      {"diagonal_m", MetresJson(model.diagonal_m)},
                      {"searched_fraction", ScoreJson(FractionFound(coverage, model, min_probability))}});
  }
  return {{"area_m2", MetresJson(AreaOf(coverage))},
          {"cell_m", MetresJson(coverage.cell_m)},
          {"min_probability", ScoreJson(min_probability)},
          {"models", std::move(models)}};
}

}  // namespace victorious
