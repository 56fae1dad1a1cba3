// match/, in: a scene's features and the templates'. Out: for each template, the matches that pass Lowe's ratio test.
// Each scene keypoint is compared with every keypoint of the template; it matches the nearest if that is nearer than
// `ratio` times the second nearest of the same template (Lowe 2004; thesis, section 3.5.3). A template keypoint may
// match several scene keypoints, because several instances of the object can be in view.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/kernels/nearest.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"

namespace victorious {

struct MatchOptions {
  double ratio = 0.8;

  void ListFields(FieldList& fields);
};

/// Templates with packed descriptors. Immutable and thread-safe after construction.
class TemplateSet {
 public:
  TemplateSet() = default;
  explicit TemplateSet(std::span<const FeatureView> templates);

  [[nodiscard]] std::size_t size() const { return templates_.size(); }
  [[nodiscard]] const kernels::PackedDescriptors& operator[](std::size_t i) const { return templates_[i]; }

 private:
  std::vector<kernels::PackedDescriptors> templates_;
};

/// @return one MatchSet per template, in the order of the scene's keypoints. A template of fewer than two keypoints has
///         no second nearest descriptor and no matches.
/// Cost: scene x template keypoints x 128 bytes (kernels/nearest.h).
std::vector<MatchSet> MatchFeatures(const kernels::PackedQueries& scene, const TemplateSet& templates,
                                    const MatchOptions& options);

/// The same for a scene that is not packed.
std::vector<MatchSet> MatchFeatures(const FeatureView& scene, const TemplateSet& templates,
                                    const MatchOptions& options);

}  // namespace victorious
