// Which categories a frame shows, and where: the whole frame is classified, or windows of many sizes all over it
// (category/windows.h), as the model was trained, and each category that is likely enough gets the box that gathers
// most of the evidence for it there (category/evidence.h). A whole frame gives a category once; windows, as often as
// likely ones lie apart.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/category/category_model.h"
#include "victorious/geometry/box.h"
#include "victorious/recognize/category_pictures.h"

namespace victorious {

struct CategoryFindOptions {
  double least_probability = 0.5;
  std::string none = "background";

  void ListFields(FieldList& fields);
};

struct FoundCategory {
  std::size_t category = 0;  ///< index into CategoryFinder::names()
  Box box;                   ///< of the supporting phrases, px, within the frame
  double probability = 0;    ///< calibrated
};

/// Finds the categories of one model. Thread-safe.
class CategoryFinder {
 public:
  /// Errors: kInvalidArgument for options out of range and where no category is left to find; kDataLoss for a model
  /// whose feature options cannot be read.
  static Expected<CategoryFinder> Create(CategoryModel model, const CategoryFindOptions& options);

  /// The categories that pictures were named by, without those that stand for none of these.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Of the model: another one's finds are others.
  [[nodiscard]] const std::string& content_id() const { return content_id_; }

  /// @param grey  CV_8UC1
  /// By rising category; of windows, the likeliest first. Cost: that of `category classify`, and some ms a category
  /// found.
  [[nodiscard]] Expected<std::vector<FoundCategory>> Find(const cv::Mat& grey) const;

 private:
  [[nodiscard]] std::vector<FoundCategory> FindInWindows(const cv::Mat& grey) const;

  CategoryFinder(CategoryModel model, CategoryEye eye, const CategoryFindOptions& options);

  std::shared_ptr<const CategoryModel> model_;
  CategoryEye eye_;
  double least_probability_;
  std::vector<std::string> names_;
  std::vector<std::size_t> nodes_;  // of each name
  std::string content_id_;
};

}  // namespace victorious
