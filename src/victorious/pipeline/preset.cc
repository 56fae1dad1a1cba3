#include "victorious/pipeline/preset.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace victorious {
namespace {

constexpr std::array<std::string_view, 3> kNames = {"thesis", "learnt", "windows"};

// Keys are full field names; each list of fields uses those that it has.
constexpr std::string_view kThesis = R"({
  "features.contrast_threshold": 0.04,
  "features.edge_threshold": 10.0,
  "features.impulse_fraction": 1.0,
  "min_mask_fraction": 0.0,
  "method": "grammar",
  "match.ratio": 0.8,
  "cascade.filter": "cascade",
  "cascade.radius_px": 75.0,
  "cascade.scale_distortion": 1.45,
  "cascade.distance_distortion": 1.45,
  "cascade.first_approval": 0.2,
  "cascade.orientation_distortion_rad": 1.5,
  "cascade.line_distortion_rad": 0.6,
  "cascade.second_approval": 0.4,
  "cascade.third_approval": 0.6,
  "cascade.all_measures": false,
  "pose.refine_plane": false,
  "features.kind": "keypoints",
  "features.surroundings": "calibrate",
  "features.mirrored": false,
  "scoring": "likelihood",
  "words_per_keypoint": 1,
  "vocabulary.root": false,
  "grammar.kernel_cap": 3.0,
  "grammar.word_prior": true,
  "grammar.likelihood_exponent": 0.1
})";

constexpr std::string_view kLearnt = R"({
  "method": "grammar",
  "cascade.scale_distortion": 1.7,
  "cascade.distance_distortion": 1.35,
  "cascade.orientation_distortion_rad": 0.5,
  "cascade.line_distortion_rad": 0.3,
  "cascade.first_approval": 0.1,
  "cascade.second_approval": 0.2,
  "cascade.third_approval": 0.6,
  "cascade.all_measures": true
})";

constexpr std::string_view kWindows = R"({
  "features.windows.enabled": true,
  "features.dense.sizes": 5,
  "vocabulary.words": 1000,
  "shapes.weight": 4.0
})";

std::string_view TextOf(std::string_view name) {
  if (name == "thesis") return kThesis;
  return name == "learnt" ? kLearnt : kWindows;
}

}  // namespace

std::span<const std::string_view> PresetNames() { return kNames; }

bool IsPreset(std::string_view name) { return std::ranges::find(kNames, name) != kNames.end(); }

Status ApplyPreset(std::string_view name, const std::vector<FieldRef>& fields) {
  if (!IsPreset(name)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: no such preset; there are {}", name, fmt::join(kNames, ", ")));
  }
  nlohmann::json known = nlohmann::json::object();
  const nlohmann::json preset = nlohmann::json::parse(TextOf(name));
  for (const auto& [field, value] : preset.items()) {
    const auto same = std::ranges::find(fields, field, &FieldRef::name);
    if (same == fields.end()) continue;
    // A choice field that does not have this value is another field of the same name: `locate` has its own "method".
    const auto& choices = same->spec.choices;
    const bool fits = choices.empty() || std::ranges::find(choices, value.get<std::string>()) != choices.end();
    if (fits) known[field] = value;
  }
  if (known.empty())
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("preset {}: sets none of the parameters of this command", name));
  return SetFromJson(known, fields);
}

}  // namespace victorious
