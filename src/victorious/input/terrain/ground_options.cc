#include <fmt/format.h>

#include "victorious/input/terrain/terrain.h"
#include "victorious/types/vertical_datum.h"

namespace victorious {
namespace {

// The texts of GroundOptions::vertical_datum. No terrain refers to a take-off.
constexpr auto kDatumTexts = DatumOverrideTexts<VerticalDatum::kEgm2008>();

}  // namespace

void GroundOptions::ListFields(FieldList& fields) {
  fields.Add(
      "height_m", height_m,
      {.min = -1e3, .max = 1e5, .unit = "m", .reason = "height of flat ground above the ellipsoid; null: not given"});
  fields.Add("terrain", terrain, {.reason = "a GeoTIFF of heights; empty: no terrain"});
  fields.Add("vertical_datum", vertical_datum, kDatumTexts,
             {.reason = "vertical datum of the terrain's heights; as_given: that of the file"});
  fields.Add("geoid_grid", geoid_grid,
             {.reason = "a .gtx grid of the geoid that the terrain's heights refer to; empty: PROJ's grid of EGM96"});
}

Expected<std::shared_ptr<const Ground>> MakeGround(const GroundOptions& options,
                                                   const std::function<void(const std::string&)>& warn) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (options.height_m && !options.terrain.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("the ground is given twice, {} m and {}: give its height or a terrain", *options.height_m,
                            options.terrain));
  }
  if (options.height_m) return std::make_shared<const FlatGround>(*options.height_m);
  if (!options.terrain.empty()) return ReadTerrain(options.terrain, options, warn);
  return nullptr;
}

}  // namespace victorious
