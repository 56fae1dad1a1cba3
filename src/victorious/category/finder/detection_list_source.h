// What another program found in a video (detection_list.h) as a source of categories: nothing is searched for.
#pragma once

#include <string>
#include <vector>

#include "victorious/category/finder/category_source.h"
#include "victorious/category/finder/detection_list.h"

namespace victorious {

/// What the content ids of such categories begin with; the rest is the name of what found them. They do not depend on a
/// file: those of several videos are of the same categories.
inline constexpr std::string_view kListedContentId = "listed/";

class DetectionListSource : public CategorySource {
 public:
  /// Errors: kInvalidArgument for a class, or a detector, whose name cannot be that of a class (CheckClassName), for a
  /// "/" in the detector's, and for that of what people box.
  [[nodiscard]] static Expected<DetectionListSource> Create(DetectionList list);

  /// "DETECTOR/CLASS"
  [[nodiscard]] const std::vector<std::string>& names() const override { return names_; }
  [[nodiscard]] const std::string& content_id() const override { return content_id_; }
  [[nodiscard]] bool IsListed() const override { return true; }
  /// The boxes of this frame by its number, clipped to it.
  [[nodiscard]] Expected<std::vector<FoundCategory>> FindIn(const Frame& frame) const override;

 private:
  explicit DetectionListSource(DetectionList list);

  DetectionList list_;
  std::vector<std::string> names_;
  std::string content_id_;
};

}  // namespace victorious
