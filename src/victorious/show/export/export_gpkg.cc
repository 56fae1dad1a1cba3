#include "victorious/show/export/export_gpkg.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <ostream>
#include <string>
#include <vector>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_vsi.h>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>

#include "victorious/base/json.h"
#include "victorious/geometry/angles.h"
#include "victorious/show/export/listed_object.h"
#include "victorious/show/export/place_ellipse.h"
#include "victorious/types/json_values.h"

namespace victorious {
namespace {

struct Column {
  const char* name;  // a key of ObjectJson
  OGRFieldType type;
};

// The id of the object is the id of the row.
constexpr const char* kIdColumn = "object_id";
constexpr auto kColumns = std::to_array<Column>({{"model", OFTString},
                                                 {"category", OFTString},
                                                 {"rank", OFTInteger64},
                                                 {"score", OFTReal},
                                                 {"videos", OFTString},
                                                 {"frames", OFTInteger64},
                                                 {"first_time_s", OFTReal},
                                                 {"last_time_s", OFTReal},
                                                 {"place_time_s", OFTReal},
                                                 {"latitude_deg", OFTReal},
                                                 {"longitude_deg", OFTReal},
                                                 {"altitude_m", OFTReal},
                                                 {"covariance_enu_m2", OFTString},
                                                 {"ce90_m", OFTReal},
                                                 {"le90_m", OFTReal},
                                                 {"heading_deg", OFTReal},
                                                 {"speed_m_s", OFTReal},
                                                 {"sigma_speed_m_s", OFTReal},
                                                 {"course_deg", OFTReal},
                                                 {"sigma_course_deg", OFTReal},
                                                 {"moments", OFTString},
                                                 {"against", OFTString},
                                                 {"evidence", OFTString},
                                                 {"rejected", OFTString}});

// Keeps GDAL's messages on this thread from stderr, and its clock out of the file.
class GdalScope {
 public:
  GdalScope() {
    CPLPushErrorHandler(CPLQuietErrorHandler);
    CPLErrorReset();
    CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", "1970-01-01T00:00:00.000Z");
  }
  ~GdalScope() {
    CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", nullptr);
    CPLPopErrorHandler();
  }
  GdalScope(const GdalScope&) = delete;
  GdalScope& operator=(const GdalScope&) = delete;
};

std::unexpected<Error> FailWithLastMessage() {
  std::string message = CPLGetLastErrorMsg();
  std::ranges::replace_if(message, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return Fail(ErrorCode::kInternal,
              fmt::format("write the GeoPackage: {}", message.empty() ? "GDAL gives no reason" : message));
}

GDALDriver* GeoPackageDriver() {
  static std::once_flag registered;
  std::call_once(registered, RegisterOGRGeoPackage);
  return GetGDALDriverManager()->GetDriverByName("GPKG");
}

// A file in GDAL's memory file system, deleted at the end.
class MemoryFile {
 public:
  MemoryFile() {
    static std::atomic<int> number;
    path_ = fmt::format("/vsimem/victorious_export_{}.gpkg", ++number);
  }
  ~MemoryFile() { VSIUnlink(path_.c_str()); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Valid as long as this. Empty if the file does not exist.
  [[nodiscard]] std::string_view bytes() const {
    vsi_l_offset size = 0;
    const GByte* data = VSIGetMemFileBuffer(path_.c_str(), &size, FALSE);
    return data == nullptr ? std::string_view()
                           : std::string_view(reinterpret_cast<const char*>(data), static_cast<std::size_t>(size));
  }

 private:
  std::string path_;
};

OGRLayer* AddLayer(GDALDataset& file, const char* name, OGRwkbGeometryType type) {
  OGRSpatialReference wgs84;
  wgs84.SetWellKnownGeogCS("WGS84");
  wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  std::string id_option = std::string("FID=") + kIdColumn;
  std::array<char*, 2> options = {id_option.data(), nullptr};
  OGRLayer* layer = file.CreateLayer(name, &wgs84, type, options.data());
  if (layer == nullptr) return nullptr;
  for (const Column& column : kColumns) {
    OGRFieldDefn field(column.name, column.type);
    if (layer->CreateField(&field) != OGRERR_NONE) return nullptr;
  }
  return layer;
}

void SetFields(const Json& json, OGRFeature& feature) {
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const int field = static_cast<int>(i);
    const auto value = json.find(kColumns[i].name);
    if (value == json.end() || value->is_null()) {
      feature.SetFieldNull(field);
    } else if (value->is_string()) {
      feature.SetField(field, ReplaceInvalidUtf8(value->get_ref<const std::string&>()).c_str());
    } else if (value->is_number_integer()) {
      feature.SetField(field, static_cast<GIntBig>(value->get<std::int64_t>()));
    } else if (value->is_number()) {
      feature.SetField(field, value->get<double>());
    } else {
      feature.SetField(field, DumpJson(*value).c_str());
    }
  }
}

OGRPoint PointOf(const GeodeticPoint& point) {
  return {DegreesFromRadians(point.longitude_rad), DegreesFromRadians(point.latitude_rad), point.altitude_m};
}

OGRMultiPolygon EllipseOf(const Geolocation& place) {
  OGRMultiPolygon ellipse;
  for (const GeodeticRing& corners : ComputeEllipse(place)) {
    OGRLinearRing ring;
    for (const GeodeticPoint& corner : corners) {
      ring.addPoint(DegreesFromRadians(corner.longitude_rad), DegreesFromRadians(corner.latitude_rad));
    }
    OGRPolygon polygon;
    polygon.addRing(&ring);
    ellipse.addGeometry(&polygon);
  }
  return ellipse;
}

Status AddRow(const ListedObject& listed, const OGRGeometry& geometry, OGRLayer& layer) {
  OGRFeature feature(layer.GetLayerDefn());
  feature.SetFID(listed.object.id);
  SetFields(ObjectJson(listed), feature);
  if (feature.SetGeometry(&geometry) != OGRERR_NONE || layer.CreateFeature(&feature) != OGRERR_NONE) {
    return FailWithLastMessage();
  }
  return {};
}

}  // namespace

Status ExportGpkg(IndexStore& store, const Catalogue& catalogue, const SightingFilter& filter, std::ostream& out) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> listed, ListObjects(store, catalogue, filter));
  const GdalScope scope;
  GDALDriver* driver = GeoPackageDriver();
  if (driver == nullptr) return Fail(ErrorCode::kUnsupported, "this GDAL is built without GeoPackage");
  const MemoryFile memory;
  struct Closer {
    void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
  };
  std::unique_ptr<GDALDataset, Closer> file(driver->Create(memory.path().c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  if (file == nullptr || file->StartTransaction() != OGRERR_NONE) return FailWithLastMessage();
  OGRLayer* objects = AddLayer(*file, "objects", wkbPoint25D);
  OGRLayer* ellipses = AddLayer(*file, "ellipses", wkbMultiPolygon);
  if (objects == nullptr || ellipses == nullptr) return FailWithLastMessage();
  for (const ListedObject& object : listed) {
    if (!object.object.place) continue;
    VICTORIOUS_RETURN_IF_ERROR(AddRow(object, PointOf(object.object.place->point), *objects));
    VICTORIOUS_RETURN_IF_ERROR(AddRow(object, EllipseOf(*object.object.place), *ellipses));
  }
  if (file->CommitTransaction() != OGRERR_NONE) return FailWithLastMessage();
  file.reset();  // writes the rest
  if (CPLGetLastErrorType() >= CE_Failure) return FailWithLastMessage();
  const std::string_view bytes = memory.bytes();
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return {};
}

}  // namespace victorious
