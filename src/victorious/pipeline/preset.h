// Parameters that go together, under one name: `--params thesis` in place of a file.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "victorious/base/options.h"

namespace victorious {

/// The names there are.
std::span<const std::string_view> PresetNames();

[[nodiscard]] bool IsPreset(std::string_view name);

/// "learnt": the cascade with all four measures in each stage, and thresholds near those that
/// `experiment chapter3.filters` learns from simulated pictures: rounded, the angles a little wider, the last approval
/// table 3.1's; by the grammar, R and all else as it is.
///
/// "thesis": what chapter 3 says. Lowe's keypoints as they come, without noise taken out first; of CAD models' views
/// all keypoints on the object; the ratio test at 0.8, the cascade with the values of table 3.1 and R = 75 px, MLESAC
/// for a similarity and nothing finer; categories from keypoints by equations 3.1 to 3.3,
/// in the reading that reaches the thesis's figures: a lower cap, tempered, with the words as prior (docs/results.md).
///
/// "windows": categories whose things are small in a frame, or several, are looked for in windows of many sizes.
/// Sets those of the preset's fields that `fields` has, whatever they held. Errors: kInvalidArgument for a name that is
/// none, and where `fields` has none of them.
Status ApplyPreset(std::string_view name, const std::vector<FieldRef>& fields);

}  // namespace victorious
