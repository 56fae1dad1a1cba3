#include "victorious/category/common/category_node.h"

namespace victorious {

bool IsWithin(std::string_view name, std::string_view ancestor) {
  return name.starts_with(ancestor) && (name.size() == ancestor.size() || name[ancestor.size()] == '/');
}

int TrainingTarget(std::string_view category, std::string_view node) {
  if (IsWithin(category, node)) return 1;
  return IsWithin(node, category) ? 0 : -1;
}

std::vector<const FeatureSet*> TrainingFeatures(std::span<const CategoryExample> examples) {
  std::vector<const FeatureSet*> sets;
  for (const CategoryExample& example : examples)
    if (example.used_for_training) sets.push_back(&example.features);
  return sets;
}

}  // namespace victorious
