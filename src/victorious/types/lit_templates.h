// A model's views as another light would show them.
#pragma once

#include <compare>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// What a view's features are under another light.
struct LitTemplate {
  FeatureSet features;
  std::vector<Point3> points_in_model;  ///< a feature's place on the object, metres
};

/// A view under the sun that stands where another view's camera does.
struct LitView {
  std::size_t sun_view;
  std::size_t view;

  auto operator<=>(const LitView&) const = default;
};

/// Any number of threads may ask at once.
class LitTemplates {
 public:
  virtual ~LitTemplates() = default;

  /// Never null; without features where the model cannot tell. The same each time.
  [[nodiscard]] virtual std::shared_ptr<const LitTemplate> Under(const LitView& wanted) const = 0;

  /// Makes what will be asked for: threads that need the same share the work, instead of waiting for each other at one
  /// after the other.
  virtual void Prepare(std::span<const LitView> wanted) const = 0;
};

}  // namespace victorious
