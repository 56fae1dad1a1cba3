// The options that a fit depends on, as a text: a part of the key of the fits that are kept between runs (kept_fits.h).
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "victorious/place/associate/object_options.h"

namespace victorious {

/// The options that decide what becomes of fits, and that no fit reads: gates of merging, and rejection. A change of
/// one leaves the kept fits as they are. Every other option is in the text, a new one too.
inline constexpr std::array<std::string_view, 5> kOptionsOfNoFit = {
    "merge_gate_sigma", "max_merge_distance_m", "max_size_ratio", "false_alarm_rate", "max_height_deviation_m"};

/// Returns all other options with their values: those that the structs list (base/options.h), and those that are no
/// user parameters. Numbers are exact. The grounds themselves are not in it, only ObjectOptions::ground_id.
[[nodiscard]] std::string FitOptionsText(ObjectOptions options);

}  // namespace victorious
