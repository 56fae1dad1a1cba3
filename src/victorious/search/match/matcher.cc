#include "victorious/search/match/matcher.h"

#include <cmath>

namespace victorious {

void MatchOptions::ListFields(FieldList& fields) {
  fields.Add("ratio", ratio,
             {.min = 0.1,
              .max = 1.0,
              .reason = "Lowe's ratio test: the nearest template keypoint must be nearer than this times the second "
                        "nearest; higher keeps more true and many more false matches"});
}

TemplateSet::TemplateSet(std::span<const FeatureView> templates) {
  templates_.reserve(templates.size());
  for (const FeatureView& view : templates) templates_.push_back(kernels::Pack(view.descriptors));
}

std::vector<MatchSet> MatchFeatures(const kernels::PackedQueries& queries, const TemplateSet& templates,
                                    const MatchOptions& options) {
  std::vector<kernels::NearestTwo> nearest(queries.count);
  const double ratio2 = options.ratio * options.ratio;
  std::vector<MatchSet> matches(templates.size());
  for (std::size_t t = 0; t < templates.size(); ++t) {
    if (templates[t].count < 2) continue;
    kernels::FindNearestTwo(queries, templates[t], nearest);
    for (std::size_t q = 0; q < queries.count; ++q) {
      const kernels::NearestTwo& found = nearest[q];
      if (!(found.best_distance2 < ratio2 * found.second_distance2)) continue;
      const double ratio = std::sqrt(static_cast<double>(found.best_distance2) / found.second_distance2);
      matches[t].push_back({static_cast<std::uint32_t>(q), found.best_index, static_cast<float>(ratio)});
    }
  }
  return matches;
}

std::vector<MatchSet> MatchFeatures(const FeatureView& scene, const TemplateSet& templates,
                                    const MatchOptions& options) {
  return MatchFeatures(kernels::PackQueries(scene.descriptors), templates, options);
}

}  // namespace victorious
