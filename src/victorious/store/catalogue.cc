#include "victorious/store/catalogue.h"

#include <algorithm>
#include <functional>
#include <ranges>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace victorious {
namespace {

std::string NameOf(const VideoRecord& video) { return ShownName(video); }
const std::string& NameOf(const ModelRecord& model) { return model.name; }

template <typename Records>
std::string Names(Records&& records) {
  std::set<std::string> names;
  for (const auto& record : records) names.insert(NameOf(record));
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

template <typename Record>
const Record* FindById(const std::vector<Record>& records, std::int64_t id) {
  const auto it = std::ranges::lower_bound(records, id, {}, &Record::id);  // a store returns them ordered by id
  return it == records.end() || it->id != id ? nullptr : &*it;
}

}  // namespace

Expected<Catalogue> Catalogue::Read(IndexStore& store, const SightingFilter& filter) {
  Catalogue catalogue;
  VICTORIOUS_ASSIGN_OR_RETURN(catalogue.videos_, store.Videos());
  VICTORIOUS_ASSIGN_OR_RETURN(catalogue.models_, store.Models());
  if (filter.video_name) {
    std::vector<VideoRecord> named = FindVideosByName(catalogue.videos_, *filter.video_name);
    if (named.empty()) {
      return Fail(ErrorCode::kNotFound, fmt::format("video {}: not in the index, which contains: {}",
                                                    *filter.video_name, Names(catalogue.videos_)));
    }
    catalogue.videos_ = std::move(named);
  }
  const auto is_category = [](const ModelRecord& model) { return model.IsCategory(); };
  if (filter.model_name) {
    const auto other = [&](const ModelRecord& model) { return is_category(model) || model.name != *filter.model_name; };
    if (std::ranges::all_of(catalogue.models_, other)) {
      return Fail(ErrorCode::kNotFound,
                  fmt::format("model {}: not in the index, which contains: {}", *filter.model_name,
                              Names(catalogue.models_ | std::views::filter(std::not_fn(is_category)))));
    }
    std::erase_if(catalogue.models_, other);
  }
  if (filter.category_name) {
    const std::string prefix = *filter.category_name + "/";
    const auto other = [&](const ModelRecord& model) {
      return !is_category(model) || !(model.name + "/").starts_with(prefix);
    };
    if (std::ranges::all_of(catalogue.models_, other)) {
      return Fail(ErrorCode::kNotFound,
                  fmt::format("category {}: not in the index, which contains: {}", *filter.category_name,
                              Names(catalogue.models_ | std::views::filter(is_category))));
    }
    std::erase_if(catalogue.models_, other);
  }
  return catalogue;
}

const VideoRecord* Catalogue::Video(std::int64_t id) const { return FindById(videos_, id); }

const ModelRecord* Catalogue::Model(std::int64_t id) const { return FindById(models_, id); }

}  // namespace victorious
