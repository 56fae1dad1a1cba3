#include <array>
#include <optional>

#include <fmt/format.h>

#include "victorious/base/enum_text.h"
#include "victorious/terrain/terrain.h"

namespace victorious {
namespace {

// The texts of GroundOptions::vertical_datum.
constexpr auto kDatumChoices =
    std::to_array<EnumText<std::optional<VerticalDatum>>>({{std::nullopt, "given"},
                                                           {VerticalDatum::kEllipsoid, "ellipsoid"},
                                                           {VerticalDatum::kEgm96, "egm96"},
                                                           {VerticalDatum::kEgm2008, "egm2008"}});

}  // namespace

void GroundOptions::ListFields(FieldList& fields) {
  fields.Add(
      "height_m", height_m,
      {.min = -9999, .max = 1e5, .unit = "m", .reason = "height of flat ground above the ellipsoid; -9999: not given"});
  fields.Add("terrain", terrain, {.reason = "a GeoTIFF of heights; empty: no terrain"});
  fields.Add("vertical_datum", vertical_datum, kDatumChoices,
             {.reason = "vertical datum of the terrain's heights; given: as given in the file"});
  fields.Add("geoid_grid", geoid_grid,
             {.reason = "a .gtx grid of the geoid that the terrain's heights refer to; empty: PROJ's grid of EGM96"});
}

Expected<std::shared_ptr<const Ground>> MakeGround(const GroundOptions& options,
                                                   const std::function<void(const std::string&)>& warn) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  const bool flat = options.height_m != GroundOptions::kUnknownHeight;
  if (flat && !options.terrain.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("the ground is given twice, {} m and {}: give its height or a terrain", options.height_m,
                            options.terrain));
  }
  if (flat) return std::make_shared<const FlatGround>(options.height_m);
  if (!options.terrain.empty()) return ReadTerrain(options.terrain, options, warn);
  return nullptr;
}

}  // namespace victorious
