// A GeoTIFF of heights in; the ground above the WGS 84 ellipsoid out. GDAL stays inside.
//
//   height above the ellipsoid = height in the file + what the file's vertical datum lies above the ellipsoid there
// Between the middles of four pixels heights are bilinear; within half a pixel of the file's edge, that of the edge.
// A pixel without a height (the file's own mark, NaN, or what no land is: below -1000 m, above 10 km) leaves the ground
// about it unknown.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/ground.h"

namespace victorious {

/// What the ground is; nothing is told by default.
struct GroundOptions {
  static constexpr double kUnknownHeight = -9999;  ///< m

  double height_m = kUnknownHeight;
  std::string terrain;
  std::string vertical_datum = "told";
  std::string geoid_grid;

  void ListFields(FieldList& fields);
};

/// Reads as much of the file as is asked for: heights are read when they are needed, and kept.
/// @param options  its datum and geoid; `terrain` is not looked at
/// @param tell  a line where the file is cut off: what is missing is unknown ground
/// Errors: kNotFound; kDataLoss for what is no GeoTIFF; kInvalidArgument for one that is not placed on the Earth, or
/// whose heights' datum nobody tells, or for which there is no geoid grid; kUnsupported for units that are unknown.
Expected<std::shared_ptr<const Ground>> ReadTerrain(const std::filesystem::path& path, const GroundOptions& options,
                                                    const std::function<void(const std::string&)>& tell = {});

/// Flat, a terrain, or null where none is told. Errors: kInvalidArgument for both; those of ReadTerrain.
Expected<std::shared_ptr<const Ground>> MakeGround(const GroundOptions& options,
                                                   const std::function<void(const std::string&)>& tell = {});

}  // namespace victorious
