#include "victorious/category/finder/category_source.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <ranges>
#include <string_view>
#include <utility>

#include "victorious/category/category_file.h"
#include "victorious/category/channels/channel_file.h"
#include "victorious/category/finder/category_finder.h"
#include "victorious/category/finder/channel_source.h"
#include "victorious/category/finder/detection_list_source.h"
#include "victorious/category/finder/detector_source.h"

namespace victorious {

void CategoryFindOptions::ListFields(FieldList& fields) {
  fields.Add(
      "min_probability", min_probability,
      {.min = 0,
       .max = 1,
       .reason = "minimum calibrated probability of a category sighting; the default is even odds. Of an imported "
                 "detector, `detector.min_score` counts"});
  fields.Add("background", background,
             {.reason = "background categories, by full names separated by commas: the classifier uses them, and they "
                        "are not reported"});
}

bool CategoryFindOptions::IsBackground(std::string_view name) const {
  for (const auto part : std::views::split(std::string_view(background), ',')) {
    std::string_view listed(part.begin(), part.end());
    listed.remove_prefix(std::min(listed.find_first_not_of(' '), listed.size()));
    listed = listed.substr(0, listed.find_last_not_of(' ') + 1);
    if (listed == name) return true;
  }
  return false;
}

void ReportedCategories::Add(const std::string& name, const CategoryFindOptions& options) {
  const bool is_reported = !options.IsBackground(name);
  number_.push_back(is_reported ? std::optional(names_.size()) : std::nullopt);
  if (is_reported) names_.push_back(name);
}

Expected<CategorySourceModel> ReadCategorySource(const std::filesystem::path& path) {
  std::array<char, 8> head{};
  std::ifstream(path, std::ios::binary).read(head.data(), head.size());
  if (IsDetectorFile(std::as_bytes(std::span(head)))) return ReadDetector(path);
  if (IsChannelModelFile(std::as_bytes(std::span(head)))) return ReadChannelModel(path);
  return ReadCategoryModel(path);
}

Expected<std::shared_ptr<const CategorySource>> MakeCategorySource(CategorySourceInput input,
                                                                   const CategoryFindOptions& options,
                                                                   const DetectorOptions& detector) {
  if (auto* list = std::get_if<DetectionList>(&input)) {
    VICTORIOUS_ASSIGN_OR_RETURN(DetectionListSource source, DetectionListSource::Create(std::move(*list)));
    return std::make_shared<const DetectionListSource>(std::move(source));
  }
  auto& model = std::get<CategorySourceModel>(input);
  if (auto* trained = std::get_if<CategoryModel>(&model)) {
    VICTORIOUS_ASSIGN_OR_RETURN(CategoryFinder finder, CategoryFinder::Create(std::move(*trained), options));
    return std::make_shared<const CategoryFinder>(std::move(finder));
  }
  if (auto* channels = std::get_if<ChannelModel>(&model)) {
    VICTORIOUS_ASSIGN_OR_RETURN(ChannelSource source, ChannelSource::Create(std::move(*channels), options));
    return std::make_shared<const ChannelSource>(std::move(source));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(DetectorSource source,
                              DetectorSource::Create(std::get<DetectorModel>(std::move(model)), options, detector));
  return std::make_shared<const DetectorSource>(std::move(source));
}

}  // namespace victorious
