// Exports geolocated objects as a GeoPackage (OGC 12-128, an SQLite file), written by GDAL/OGR.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "victorious/base/error.h"
#include "victorious/show/export/export_format.h"
#include "victorious/show/export/listed_object.h"
#include "victorious/types/review.h"

namespace victorious {

/// Two layers: `objects`, one point per object of known place, and `ellipses`, its horizontal 90 % confidence
/// ellipse. Both have the columns of the format `objects`; arrays are JSON text. The same content gives the same bytes.
/// The file is made in memory. Error: kInternal with OGR's message.
extern const ExportFormat kGpkgFormat;

/// What persons have decided of an object, for the columns `verdict`, `reviewer`, `note`, `is_disputed`, `decisions`.
struct DecidedObject {
  const Review& review;               ///< the team's
  std::span<const Review> decisions;  ///< of persons
  bool is_disputed = false;
};

/// The same file with the columns of what persons decided, on the disk, row by row. Use all of it from one thread.
class GeoPackageFile {
 public:
  virtual ~GeoPackageFile() = default;
  /// Adds an object; one without a place is left out. Errors: kInternal with OGR's message; kNoSpace.
  [[nodiscard]] virtual Status Add(const ListedObject& listed, const DecidedObject& decided) = 0;
  /// The file is complete then. Errors: likewise.
  [[nodiscard]] virtual Status Finish() = 0;
};

/// @param path  there is no file yet. Errors: those of GeoPackageFile::Add
[[nodiscard]] Expected<std::unique_ptr<GeoPackageFile>> MakeGeoPackageFile(const std::filesystem::path& path);

}  // namespace victorious
