#include "victorious/category/finder/category_finder.h"

#include <algorithm>
#include <ranges>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/category/category_file.h"
#include "victorious/category/explanation.h"
#include "victorious/category/windows.h"

namespace victorious {

Expected<CategoryFinder> CategoryFinder::Create(CategoryModel model, const CategoryFindOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_ASSIGN_OR_RETURN(CategoryFeaturizer featurizer, CategoryFeaturizer::Of(model));
  CategoryFinder finder(std::move(model), std::move(featurizer), options);
  if (!finder.names_.empty()) return finder;
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("categories: all are background ({}): train the model with at least one other category",
                          options.background));
}

CategoryFinder::CategoryFinder(CategoryModel model, CategoryFeaturizer featurizer, const CategoryFindOptions& options)
    : model_(std::make_shared<const CategoryModel>(std::move(model))),
      featurizer_(std::move(featurizer)),
      min_probability_(options.min_probability),
      content_id_(fmt::format("{:016x}", Checksum(EncodeCategoryModel(*model_)))) {
  for (std::size_t n = 0; n < model_->nodes.size(); ++n) {
    const CategoryNode& node = model_->nodes[n];
    if (!node.can_be_label || options.IsBackground(node.name) ||
        (model_->windows && node.name == model_->windows->background_category))
      continue;
    names_.push_back(node.name);
    nodes_.push_back(n);
  }
}

// Non-maximum suppression over windows: one category per region, plus categories above and below it in the hierarchy.
std::vector<FoundCategory> CategoryFinder::FindInWindows(const cv::Mat& grey) const {
  struct Likely {
    const ScoredWindow* window;
    std::size_t category;
    double probability;
  };
  const WindowOptions& options = featurizer_.options().windows;
  const std::vector<ScoredWindow> windows =
      ClassifyWindows(*model_, featurizer_.Clean(grey), featurizer_.options().dense, options, nodes_);
  std::vector<Likely> likely;
  for (const ScoredWindow& window : windows) {
    for (std::size_t c = 0; c < nodes_.size(); ++c) {
      const double probability = window.result.scores[nodes_[c]].probability;
      if (probability >= min_probability_) likely.push_back({&window, c, probability});
    }
  }
  std::ranges::stable_sort(likely, std::ranges::greater(), &Likely::probability);
  std::vector<Likely> apart;
  for (const Likely& one : likely) {
    const auto suppresses = [&](const Likely& other) {
      const std::string& a = names_[one.category];
      const std::string& b = names_[other.category];
      const bool may_be_both = a != b && (IsWithin(a, b) || IsWithin(b, a));
      return !may_be_both && IsSameObject(one.window->box, other.window->box);
    };
    if (std::ranges::none_of(apart, suppresses)) apart.push_back(one);
  }
  std::vector<FoundCategory> found;
  for (const Likely& one : apart) {
    const QuantisedImage& image = one.window->image;
    const Box inside = SupportingBox(ComputeContributions(*model_, image, nodes_[one.category]), image);
    const double scale = one.window->box.width / image.width;
    found.push_back({.category = one.category,
                     .box = {one.window->box.x + inside.x * scale, one.window->box.y + inside.y * scale,
                             inside.width * scale, inside.height * scale},
                     .probability = one.probability});
  }
  return found;
}

Expected<std::vector<FoundCategory>> CategoryFinder::Find(const cv::Mat& grey) const {
  if (featurizer_.options().windows.enabled) return FindInWindows(grey);
  VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet features, featurizer_.Extract(grey));
  const QuantisedImage image = QuantiseFeatures(*model_, features);
  std::vector<FoundCategory> found;
  if (image.size() == 0) return found;  // no features
  const CategoryResult result = Classify(*model_, image, CategoryMethod::kPhrases);
  for (std::size_t c = 0; c < nodes_.size(); ++c) {
    const double probability = result.scores[nodes_[c]].probability;
    if (probability < min_probability_) continue;
    const Box box = SupportingBox(ComputeContributions(*model_, image, nodes_[c]), image);
    found.push_back({.category = c, .box = box, .probability = probability});
  }
  return found;
}

}  // namespace victorious
