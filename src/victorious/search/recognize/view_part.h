// recognize/, the part of a model's views that one search of a frame compares. Successive frames of a video show nearly
// the same objects, and neighbouring views propose the same object. So each search takes another part of the coarse
// views, and what one frame shows is followed into the others (docs/adr/0018).
#pragma once

#include <cstddef>

namespace victorious {

/// One of `count` parts of the coarse views, which successive searches of a video take in turn. By default all views.
struct ViewPart {
  std::size_t index = 0;  ///< below count
  std::size_t count = 1;

  /// @param coarse_view  index among the coarse views of a model
  [[nodiscard]] bool Contains(std::size_t coarse_view) const { return coarse_view % count == index; }

  /// Whether a method that cannot divide the views runs in this search: in all searches of a turn but the last.
  [[nodiscard]] bool ContainsWholeModels() const { return count == 1 || index + 1 < count; }

  bool operator==(const ViewPart&) const = default;
};

}  // namespace victorious
