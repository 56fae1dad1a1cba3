// A detection network that was imported (network/) as a source of categories: its classes.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/category/finder/category_source.h"
#include "victorious/category/network/network_detector.h"

namespace victorious {

class DetectorSource : public CategorySource {
 public:
  /// Errors: those of NetworkDetector::Create; kInvalidArgument if all classes are background.
  [[nodiscard]] static Expected<DetectorSource> Create(DetectorModel model, const CategoryFindOptions& options,
                                                       const DetectorOptions& detector);

  [[nodiscard]] const std::vector<std::string>& names() const override { return reported_.names(); }
  [[nodiscard]] const std::string& content_id() const override { return content_id_; }
  [[nodiscard]] bool IsDetector() const override { return true; }
  [[nodiscard]] std::string DescribeSearch(cv::Size frame) const override;
  [[nodiscard]] Expected<std::vector<FoundCategory>> FindIn(const Frame& frame) const override;

 private:
  explicit DetectorSource(NetworkDetector detector) : detector_(std::move(detector)) {}

  NetworkDetector detector_;
  ReportedCategories reported_;
  std::string content_id_;
};

}  // namespace victorious
