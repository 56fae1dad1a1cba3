// Named sets of parameters: `--params thesis` in place of a file. A preset is a function of each command's options, so
// that it sets no field of another command that happens to have the same name.
#pragma once

#include <array>
#include <string_view>

#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"

namespace victorious {

struct CadModelOptions;
struct CategoryTrainOptions;
struct IndexOptions;
struct NavigateVideoOptions;
struct PhotoModelOptions;
struct RecognizeOptions;

/// kLearnt: the cascade with all four measures in each stage, and thresholds near those that `experiment
/// chapter3.filters` learns from simulated images: rounded, the angles a little wider, the last approval from table
/// 3.1. Hypotheses by the grammar; R and all other parameters are unchanged.
///
/// kThesis: chapter 3 of the thesis. Lowe's keypoints without prior denoising; for CAD models' views all keypoints on
/// the object; the ratio test at 0.8, the cascade with the values of table 3.1 and R = 75 px, MLESAC for a similarity
/// without refinement; categories from keypoints by equations 3.1 to 3.3, in the reading that reproduces the thesis's
/// figures: a lower cap, tempered, with the words as prior (docs/results.md).
///
/// kWindows: searches for categories in windows of many sizes, for objects that are small in a frame or occur several
/// times.
enum class Preset { kThesis, kLearnt, kWindows };

inline constexpr auto kPresetTexts = std::to_array<EnumText<Preset>>(
    {{Preset::kThesis, "thesis"}, {Preset::kLearnt, "learnt"}, {Preset::kWindows, "windows"}});

/// Sets the fields of the preset, whatever their values. Errors: kInvalidArgument if the preset sets none of these
/// options; then nothing is changed.
[[nodiscard]] Status ApplyPreset(Preset preset, RecognizeOptions& options);
[[nodiscard]] Status ApplyPreset(Preset preset, IndexOptions& options);
[[nodiscard]] Status ApplyPreset(Preset preset, NavigateVideoOptions& options);
[[nodiscard]] Status ApplyPreset(Preset preset, PhotoModelOptions& options);
[[nodiscard]] Status ApplyPreset(Preset preset, CadModelOptions& options);
[[nodiscard]] Status ApplyPreset(Preset preset, CategoryTrainOptions& options);

/// The error of options that the preset does not set.
[[nodiscard]] Error PresetDoesNotApply(Preset preset);

/// All other options: no preset sets them.
template <typename Options>
[[nodiscard]] Status ApplyPreset(Preset preset, Options& /*options*/) {
  return std::unexpected(PresetDoesNotApply(preset));
}

/// What `index --quality` trades: time for completeness.
enum class Quality { kFast, kNormal, kThorough };

inline constexpr auto kQualityTexts = std::to_array<EnumText<Quality>>(
    {{Quality::kFast, "fast"}, {Quality::kNormal, "normal"}, {Quality::kThorough, "thorough"}});

/// The quality of a name. Error: kInvalidArgument for another name, with all of them.
[[nodiscard]] Expected<Quality> ParseQuality(std::string_view name);

/// Sets the parameters that trade time for completeness.
///
/// | quality  | full-frame searches | region searches | CAD models by | matches per template keypoint |
/// | -------- | ------------------- | --------------- | ------------- | ----------------------------- |
/// | fast     | each 0.4 to 0.7 s   | each 0.5 s      | shortlist     | 4                             |
/// | normal   | each 0.2 to 0.7 s   | each 0.1 s      | auto          | 4                             |
/// | thorough | every frame         | each 0.1 s      | votes         | 8                             |
///
/// @param cad_only  all models are CAD models: the method stays auto if there are models of photos, which the grammar
///                  searches
void ApplyQuality(Quality quality, bool cad_only, IndexOptions& options);

}  // namespace victorious
