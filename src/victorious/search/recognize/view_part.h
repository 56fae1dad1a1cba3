// recognize/, which of a model's views a search of a frame goes through. Successive frames of a video show nearly the
// same, so each of them need only be searched for a part of the coarse views: neighbouring views propose the same
// object, and what one frame shows is followed into the others (docs/adr/0018).
#pragma once

#include <cstddef>

namespace victorious {

/// One of `count` parts of the coarse views, which successive searches of a video take in turn. By default all views.
struct ViewPart {
  std::size_t index = 0;  ///< below count
  std::size_t count = 1;

  /// @param coarse_view  index among the coarse views of a model
  [[nodiscard]] bool Contains(std::size_t coarse_view) const { return coarse_view % count == index; }

  /// For a method that always compares all views: it leaves out one search of each turn, the last.
  [[nodiscard]] bool ContainsWholeModels() const { return count == 1 || index + 1 < count; }

  bool operator==(const ViewPart&) const = default;
};

}  // namespace victorious
