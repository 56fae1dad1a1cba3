// recognize/, a scene's features prepared for matching: packed once, shared by the searches of all models.
#pragma once

#include <mutex>
#include <optional>

#include "victorious/kernels/nearest.h"
#include "victorious/match/ranked_matcher.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Packs the descriptors at the first use, since each method packs them in its own way. Thread-safe.
class PreparedScene {
 public:
  /// @param features  must outlive this
  explicit PreparedScene(const FeatureSet& features) : features_(features) {}
  PreparedScene(const PreparedScene&) = delete;
  PreparedScene& operator=(const PreparedScene&) = delete;

  [[nodiscard]] const FeatureSet& features() const { return features_; }

  /// For the ratio test, which compares each scene keypoint with all template keypoints.
  [[nodiscard]] const kernels::PackedQueries& queries() const {
    std::call_once(queries_once_, [&] { queries_ = kernels::PackQueries(features_.View().descriptors); });
    return *queries_;
  }

  /// For ranked matches, which compare each template keypoint with all scene keypoints.
  [[nodiscard]] const RankedMatcher& ranked_matcher() const {
    std::call_once(ranked_once_, [&] { ranked_matcher_.emplace(features_.View()); });
    return *ranked_matcher_;
  }

 private:
  const FeatureSet& features_;
  mutable std::once_flag queries_once_;
  mutable std::optional<kernels::PackedQueries> queries_;
  mutable std::once_flag ranked_once_;
  mutable std::optional<RankedMatcher> ranked_matcher_;
};

}  // namespace victorious
