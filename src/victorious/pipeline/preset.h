// Named sets of parameters: `--params thesis` in place of a file.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "victorious/base/options.h"

namespace victorious {

/// The names of all presets.
std::span<const std::string_view> PresetNames();

[[nodiscard]] bool IsPreset(std::string_view name);

/// Sets the fields of the preset that `fields` contains, whatever their values. The presets:
///
/// "learnt": the cascade with all four measures in each stage, and thresholds near those that `experiment
/// chapter3.filters` learns from simulated pictures: rounded, the angles a little wider, the last approval from table
/// 3.1. Hypotheses by the grammar; R and all other parameters are unchanged.
///
/// "thesis": chapter 3 of the thesis. Lowe's keypoints without prior denoising; for CAD models' views all keypoints on
/// the object; the ratio test at 0.8, the cascade with the values of table 3.1 and R = 75 px, MLESAC for a similarity
/// without refinement; categories from keypoints by equations 3.1 to 3.3, in the reading that reproduces the thesis's
/// figures: a lower cap, tempered, with the words as prior (docs/results.md).
///
/// "windows": searches for categories in windows of many sizes, for objects that are small in a frame or occur several
/// times.
///
/// Errors: kInvalidArgument for an unknown name, or if `fields` contains no field of the preset.
Status ApplyPreset(std::string_view name, const std::vector<FieldRef>& fields);

}  // namespace victorious
