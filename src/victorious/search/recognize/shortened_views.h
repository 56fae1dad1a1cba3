// recognize/, for ShortlistSearch: the shortened descriptors of a model's views under diffuse light. Relit templates
// bring their own.
#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

#include "victorious/object/features/descriptor_cells.h"
#include "victorious/search/match/upright_matcher.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// Made for each view when first asked for, and kept: a quarter of the size of the views' descriptors. Thread-safe.
class ShortenedViews {
 public:
  /// @param model  must outlive this
  explicit ShortenedViews(const ObjectModel& model)
      : model_(model), once_(model.views.size()), shortened_(model.views.size()) {}

  [[nodiscard]] const ObjectModel& model() const { return model_; }

  [[nodiscard]] UprightTemplate Of(std::size_t view) const {
    const FeatureView features = model_.ViewFeatures(view);
    std::call_once(once_[view], [&] { shortened_[view] = ShortenDescriptors(features.descriptors); });
    return {features, &shortened_[view]};
  }

 private:
  const ObjectModel& model_;
  mutable std::vector<std::once_flag> once_;
  mutable std::vector<ShortDescriptors> shortened_;
};

}  // namespace victorious
