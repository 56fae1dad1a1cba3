// Finds the categories of a frame and their boxes. Classifies the whole frame or multi-scale sliding windows
// (category/windows.h), as the model was trained. Each category above the probability threshold gets the box that
// contains most of the evidence for it (category/explanation.h). A whole frame yields each category at most once;
// windows yield one result per non-overlapping window.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/category/category_model.h"
#include "victorious/category/finder/category_images.h"
#include "victorious/category/finder/category_source.h"

namespace victorious {

/// Finds the categories of one model. Thread-safe.
class CategoryFinder : public CategorySource {
 public:
  /// Errors: kInvalidArgument for options out of range and if all categories are background; kDataLoss for a model
  /// whose feature options cannot be read.
  [[nodiscard]] static Expected<CategoryFinder> Create(CategoryModel model, const CategoryFindOptions& options);

  /// The labels of the training images without the background categories.
  [[nodiscard]] const std::vector<std::string>& names() const override { return names_; }
  /// Checksum of the model; identifies its results.
  [[nodiscard]] const std::string& content_id() const override { return content_id_; }

  /// @param grey  CV_8UC1
  /// @return whole frame: by rising category index; windows: by falling probability
  /// Cost: that of `category classify`, plus a few ms per category found.
  [[nodiscard]] Expected<std::vector<FoundCategory>> Find(const cv::Mat& grey) const;
  [[nodiscard]] Expected<std::vector<FoundCategory>> FindIn(const Frame& frame) const override {
    return Find(frame.image);
  }

 private:
  [[nodiscard]] std::vector<FoundCategory> FindInWindows(const cv::Mat& grey) const;

  CategoryFinder(CategoryModel model, CategoryFeaturizer featurizer, const CategoryFindOptions& options);

  std::shared_ptr<const CategoryModel> model_;
  CategoryFeaturizer featurizer_;
  double min_probability_;
  std::vector<std::string> names_;
  std::vector<std::size_t> nodes_;  // index of each name's node in the model
  std::string content_id_;
};

}  // namespace victorious
