// The zero of heights, and its texts in files, parameters and messages.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "victorious/base/enum_text.h"

namespace victorious {

enum class VerticalDatum {
  kEllipsoid,  ///< the WGS 84 ellipsoid
  kEgm96,      ///< mean sea level of the geoid EGM96
  kEgm2008,    ///< mean sea level of the geoid EGM2008
  kTakeoff,    ///< the aircraft's take-off point
  kUnknown,    ///< no height is given; the altitude is undefined
};

inline constexpr auto kVerticalDatumTexts =
    std::to_array<EnumText<VerticalDatum>>({{VerticalDatum::kEllipsoid, "ellipsoid"},
                                            {VerticalDatum::kEgm96, "egm96"},
                                            {VerticalDatum::kEgm2008, "egm2008"},
                                            {VerticalDatum::kTakeoff, "takeoff"},
                                            {VerticalDatum::kUnknown, "unknown"}});

/// The texts of an option that overrides the datum of a file: "as_given" (std::nullopt) keeps the file's own; then all
/// of kVerticalDatumTexts up to `last`.
template <VerticalDatum last>
constexpr auto DatumOverrideTexts() {
  constexpr std::size_t kCount = static_cast<std::size_t>(last) + 1;  // in the enum's order
  std::array<EnumText<std::optional<VerticalDatum>>, kCount + 1> texts{};
  texts[0] = {std::nullopt, "as_given"};
  for (std::size_t i = 0; i < kCount; ++i) texts[i + 1] = {kVerticalDatumTexts[i].value, kVerticalDatumTexts[i].text};
  return texts;
}

}  // namespace victorious
