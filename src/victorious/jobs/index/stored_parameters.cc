#include "victorious/jobs/index/stored_parameters.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/jobs/index/index_setup.h"

namespace victorious {
namespace {

// What a user sets it by: a parameter's name ("match.ratio"), or the flag of the interval of time.
// @param key  a JSON pointer
std::string NameOfParameter(const std::string& key) {
  if (key == "/searched/from_s") return "--from";
  if (key == "/searched/to_s") return "--to";
  if (key == "/searched/budget_ms") return "--budget-ms";
  std::string name = key.substr(1);
  std::ranges::replace(name, '/', '.');
  return name;
}

// The parameters of a search that began before, and those of now, each as a JSON pointer with its value.
struct ComparedParameters {
  nlohmann::json before;
  nlohmann::json now;
};

// What the program did not have when the search began is what it is by default. std::nullopt for what is not JSON.
std::optional<ComparedParameters> Compare(const std::string& before, const std::string& now,
                                          const std::string& defaults) {
  const Expected<nlohmann::json> stored = ParseStrictJson(before);
  const Expected<nlohmann::json> wanted = ParseStrictJson(now);
  const Expected<nlohmann::json> unset = ParseStrictJson(defaults);
  if (!stored || !wanted || !unset || !stored->is_object() || !wanted->is_object() || !unset->is_object())
    return std::nullopt;
  nlohmann::json began_with = unset->flatten();
  began_with.update(stored->flatten());
  return ComparedParameters{.before = std::move(began_with), .now = wanted->flatten()};
}

// Lists the parameters that differ, with both values.
std::string DescribeDifference(const std::optional<ComparedParameters>& compared) {
  constexpr std::string_view kUnknown = "another version's parameters";
  if (!compared) return std::string(kUnknown);
  std::vector<std::string> changes;
  auto keys = compared->before;
  keys.update(compared->now);
  for (const auto& [key, unused] : keys.items()) {
    const auto old = compared->before.value(key, nlohmann::json());
    const auto value = compared->now.value(key, nlohmann::json());
    if (old == value) continue;
    const std::string name = NameOfParameter(key);
    const std::string absent = name.starts_with("--") ? "not given" : "null";
    const auto text = [&](const nlohmann::json& one) { return one.is_null() ? absent : DumpJson(one); };
    changes.push_back(fmt::format("{} was {}, is {}", name, text(old), text(value)));
  }
  return changes.empty() ? std::string(kUnknown) : fmt::format("{}", fmt::join(changes, "; "));
}

}  // namespace

StoredParameters ParametersOf(const IndexOptions& options, const SearchIntervals& intervals, const IndexJob& job) {
  return {.models = SearchOptionsText(options, intervals.models, intervals.tracked, job),
          .categories = SearchOptionsText(options, intervals.categories, intervals.tracked, job),
          .features = OptionsToJsonText(MakeKeptFeatureOptions(options.features))};
}

std::string SearchOptionsText(IndexOptions options, int every, int tracked, const IndexJob& job) {
  options.every = every;
  options.follow = FollowOptionsOf(options.follow, tracked);
  FieldList fields;
  options.ListSearchFields(fields);
  std::string text = ToJsonText(fields.fields());
  if (!job.from_s && !job.to_s && !job.frame_budget) return text;
  nlohmann::json json = ParseStrictJson(text).value();
  if (job.from_s) json["searched"]["from_s"] = *job.from_s;
  if (job.to_s) json["searched"]["to_s"] = *job.to_s;
  if (job.frame_budget) json["searched"]["budget_ms"] = job.frame_budget->count();
  return DumpJson(json);
}

Expected<std::string> FindDifference(const VideoRecord& video, const std::vector<ModelRecord>& sought,
                                     const StoredParameters& now, const StoredParameters& defaults, IndexStore& store) {
  const auto compare = [](const std::string& before, const std::string& wanted,
                          const std::string& unset) -> std::string {
    if (before.empty() || before == wanted) return "";
    const std::optional<ComparedParameters> compared = Compare(before, wanted, unset);
    return compared && compared->before == compared->now ? "" : DescribeDifference(compared);
  };
  std::string difference = compare(video.features_json, now.features, defaults.features);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> stored, store.Models());
  for (auto record = stored.begin(); difference.empty() && record != stored.end(); ++record) {
    if (FindSame(sought, *record) == nullptr) continue;  // other content is searched anew
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SearchRecord> before, store.FindSearch(video.id, record->id));
    if (before) difference = compare(before->options_json, now.Of(*record), defaults.Of(*record));
  }
  return difference;
}

}  // namespace victorious
