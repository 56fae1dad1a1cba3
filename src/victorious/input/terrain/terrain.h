// Terrain model: reads a GeoTIFF of heights and gives the ground height above the WGS 84 ellipsoid. Hides GDAL.
//
//   height above the ellipsoid = height in the file + height of the file's vertical datum above the ellipsoid
// Heights are interpolated bilinearly between pixel centres; within half a pixel of the file's edge the height of the
// edge is used. If one of the four pixels has no height (no-data value, NaN, below -1000 m or above 10 km), the ground
// there is unknown.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/ground.h"
#include "victorious/types/camera_state.h"

namespace victorious {

/// The ground that objects stand on: flat, a terrain, or unknown (the default).
struct GroundOptions {
  std::optional<double> height_m;  ///< of flat ground; std::nullopt: not given
  std::string terrain;
  std::optional<VerticalDatum> vertical_datum;  ///< of the terrain's heights; std::nullopt: as given in the file
  std::string geoid_grid;

  void ListFields(FieldList& fields);
};

/// Opens the file. Heights are read on demand, in tiles, and cached.
/// @param options  vertical datum and geoid grid; `terrain` is ignored
/// @param warn     gets one line if the file is truncated; the ground is unknown where heights are missing
/// Errors: kNotFound; kDataLoss, not a GeoTIFF; kInvalidArgument, no georeference, unknown vertical datum or no geoid
/// grid for it; kUnsupported, unknown unit of height.
[[nodiscard]] Expected<std::shared_ptr<const Ground>> ReadTerrain(
    const std::filesystem::path& path, const GroundOptions& options,
    const std::function<void(const std::string&)>& warn = {});

/// Makes flat ground or a terrain; null if the options give neither. Errors: kInvalidArgument if they give both; those
/// of ReadTerrain.
[[nodiscard]] Expected<std::shared_ptr<const Ground>> MakeGround(
    const GroundOptions& options, const std::function<void(const std::string&)>& warn = {});

}  // namespace victorious
