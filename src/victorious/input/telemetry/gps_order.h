// telemetry/: the order of latitude and longitude in subtitles that do not name them.
#pragma once

#include "victorious/base/enum_text.h"

namespace victorious {

enum class GpsOrder {
  kByText,  ///< longitude first, but latitude first where the third number is a height
  kLongitudeFirst,
  kLatitudeFirst
};

inline constexpr auto kGpsOrderTexts =
    std::to_array<EnumText<GpsOrder>>({{GpsOrder::kByText, "by_text"},
                                       {GpsOrder::kLongitudeFirst, "longitude_first"},
                                       {GpsOrder::kLatitudeFirst, "latitude_first"}});

}  // namespace victorious
