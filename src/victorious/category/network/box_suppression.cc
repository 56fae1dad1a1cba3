#include "victorious/category/network/box_suppression.h"

#include <algorithm>
#include <functional>
#include <ranges>

namespace victorious {

std::vector<NetworkBox> MergeTiles(std::vector<TiledBox> boxes, double max_overlap) {
  constexpr double kMaxInside = 0.5;  // of a part of an object in a box of it
  std::ranges::stable_sort(boxes, [](const TiledBox& a, const TiledBox& b) {
    if (a.is_cut != b.is_cut) return b.is_cut;
    return a.found.score > b.found.score;
  });
  std::vector<NetworkBox> kept;
  for (const TiledBox& one : boxes) {
    const auto suppresses = [&](const NetworkBox& other) {
      if (other.category != one.found.category) return false;
      if (IntersectionOverUnion(other.box, one.found.box) > max_overlap) return true;
      return one.is_cut && Intersection(other.box, one.found.box).Area() > kMaxInside * one.found.box.Area();
    };
    if (std::ranges::none_of(kept, suppresses)) kept.push_back(one.found);
  }
  std::ranges::stable_sort(kept, std::ranges::greater(), &NetworkBox::score);
  return kept;
}

std::vector<NetworkBox> SuppressOverlaps(std::vector<NetworkBox> boxes, double max_overlap) {
  std::vector<TiledBox> whole;
  for (NetworkBox& box : boxes) whole.push_back({.found = std::move(box)});
  return MergeTiles(std::move(whole), max_overlap);
}

}  // namespace victorious
