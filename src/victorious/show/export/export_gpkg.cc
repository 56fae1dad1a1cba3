#include "victorious/show/export/export_gpkg.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <utility>
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
// What persons decided.
constexpr auto kDecidedColumns = std::to_array<Column>({{"verdict", OFTString},
                                                        {"reviewer", OFTString},
                                                        {"note", OFTString},
                                                        {"is_disputed", OFTInteger64},
                                                        {"decisions", OFTString}});

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
  // SQLite's words for SQLITE_FULL.
  const bool is_full = message.find("disk is full") != std::string::npos;
  return Fail(is_full ? ErrorCode::kNoSpace : ErrorCode::kInternal,
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

using Columns = std::vector<Column>;

OGRLayer* AddLayer(GDALDataset& file, const char* name, OGRwkbGeometryType type, const Columns& columns) {
  OGRSpatialReference wgs84;
  wgs84.SetWellKnownGeogCS("WGS84");
  wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  std::string id_option = std::string("FID=") + kIdColumn;
  std::array<char*, 2> options = {id_option.data(), nullptr};
  OGRLayer* layer = file.CreateLayer(name, &wgs84, type, options.data());
  if (layer == nullptr) return nullptr;
  for (const Column& column : columns) {
    OGRFieldDefn field(column.name, column.type);
    if (layer->CreateField(&field) != OGRERR_NONE) return nullptr;
  }
  return layer;
}

void SetFields(const Json& json, const Columns& columns, OGRFeature& feature) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const int field = static_cast<int>(i);
    const auto value = json.find(columns[i].name);
    if (value == json.end() || value->is_null()) {
      feature.SetFieldNull(field);
    } else if (value->is_string()) {
      feature.SetField(field, ReplaceInvalidUtf8(value->get_ref<const std::string&>()).c_str());
    } else if (value->is_boolean()) {
      feature.SetField(field, value->get<bool>() ? 1 : 0);
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

// "rejected by bob; accepted by ann", as the page writes it.
std::string TextOf(std::span<const Review> decisions) {
  std::string text;
  for (const Review& one : decisions) {
    if (!one.verdict) continue;
    text += fmt::format("{}{}{}{}", text.empty() ? "" : "; ", ToText(*one.verdict), one.reviewer.empty() ? "" : " by ",
                        one.reviewer);
  }
  return text;
}

void AddDecided(const DecidedObject& decided, Json& row) {
  const auto text = [](const std::string& value) { return value.empty() ? Json() : Json(value); };
  row["verdict"] = decided.review.verdict ? Json(ToText(*decided.review.verdict)) : Json();
  row["reviewer"] = text(decided.review.reviewer);
  row["note"] = text(decided.review.note);
  row["is_disputed"] = decided.is_disputed;
  row["decisions"] = text(TextOf(decided.decisions));
}

struct GpkgCloser {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};

// The layers of a file that is being written.
class ObjectLayers {
 public:
  [[nodiscard]] Status Create(const std::string& path, Columns columns) {
    columns_ = std::move(columns);
    GDALDriver* driver = GeoPackageDriver();
    if (driver == nullptr) return Fail(ErrorCode::kUnsupported, "this GDAL is built without GeoPackage");
    file_.reset(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    if (file_ == nullptr || file_->StartTransaction() != OGRERR_NONE) return FailWithLastMessage();
    objects_ = AddLayer(*file_, "objects", wkbPoint25D, columns_);
    ellipses_ = AddLayer(*file_, "ellipses", wkbMultiPolygon, columns_);
    if (objects_ == nullptr || ellipses_ == nullptr) return FailWithLastMessage();
    return {};
  }

  [[nodiscard]] Status Add(const ObjectRecord& object, const Json& row) {
    VICTORIOUS_RETURN_IF_ERROR(AddRow(object.id, row, PointOf(object.place->point), *objects_));
    return AddRow(object.id, row, EllipseOf(*object.place), *ellipses_);
  }

  [[nodiscard]] Status Finish() {
    if (file_->CommitTransaction() != OGRERR_NONE) return FailWithLastMessage();
    file_.reset();  // writes the rest
    if (CPLGetLastErrorType() >= CE_Failure) return FailWithLastMessage();
    return {};
  }

 private:
  [[nodiscard]] Status AddRow(std::int64_t id, const Json& row, const OGRGeometry& geometry, OGRLayer& layer) const {
    OGRFeature feature(layer.GetLayerDefn());
    feature.SetFID(id);
    SetFields(row, columns_, feature);
    if (feature.SetGeometry(&geometry) != OGRERR_NONE || layer.CreateFeature(&feature) != OGRERR_NONE) {
      return FailWithLastMessage();
    }
    return {};
  }

  const GdalScope scope_;  // ends after the file is closed
  Columns columns_;
  std::unique_ptr<GDALDataset, GpkgCloser> file_;
  OGRLayer* objects_ = nullptr;
  OGRLayer* ellipses_ = nullptr;
};

class DecidedFile final : public GeoPackageFile {
 public:
  [[nodiscard]] Status Create(const std::filesystem::path& path) {
    Columns columns(kColumns.begin(), kColumns.end());
    columns.insert(columns.end(), kDecidedColumns.begin(), kDecidedColumns.end());
    return layers_.Create(path.string(), std::move(columns));
  }

  Status Add(const ListedObject& listed, const DecidedObject& decided) override {
    if (!listed.object.place) return {};
    Json row = ObjectJson(listed);
    AddDecided(decided, row);
    return layers_.Add(listed.object, row);
  }

  Status Finish() override { return layers_.Finish(); }

 private:
  ObjectLayers layers_;
};

Status WriteGpkg(const ExportRequest& request, std::ostream& out) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> listed,
                              ListObjects(request.store, request.catalogue, request.filter));
  const MemoryFile memory;
  ObjectLayers layers;
  VICTORIOUS_RETURN_IF_ERROR(layers.Create(memory.path(), Columns(kColumns.begin(), kColumns.end())));
  for (const ListedObject& one : listed) {
    if (one.object.place) VICTORIOUS_RETURN_IF_ERROR(layers.Add(one.object, ObjectJson(one)));
  }
  VICTORIOUS_RETURN_IF_ERROR(layers.Finish());
  const std::string_view bytes = memory.bytes();
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return {};
}

bool IsGeoPackage(std::string_view head) {
  constexpr std::size_t kApplicationId = 68;  // offset in the header of SQLite
  return head.starts_with(std::string_view("SQLite format 3\0", 16)) && head.size() > kApplicationId + 4 &&
         head.substr(kApplicationId, 2) == "GP";
}

}  // namespace

constinit const ExportFormat kGpkgFormat{.name = "gpkg",
                                         .file = "a GeoPackage",
                                         .is_map = true,
                                         .is_binary = true,
                                         .is_file = &IsGeoPackage,
                                         .write = &WriteGpkg};

Expected<std::unique_ptr<GeoPackageFile>> MakeGeoPackageFile(const std::filesystem::path& path) {
  auto file = std::make_unique<DecidedFile>();
  VICTORIOUS_RETURN_IF_ERROR(file->Create(path));
  return file;
}

}  // namespace victorious
