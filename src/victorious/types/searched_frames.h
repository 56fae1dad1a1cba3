// The frames of a video that are searched as a whole, as the search chooses them and data association counts them.
#pragma once

#include <cstdint>
#include <numeric>

namespace victorious {

/// Which frames are searched in full: the multiples of `every`, and those of `restart`, where all tracks restart.
struct SearchedFrames {
  std::int64_t every = 1;
  std::int64_t restart = 0;  ///< 0: without tracking

  [[nodiscard]] bool Contains(std::int64_t frame) const {
    return frame % every == 0 || (restart > 0 && frame % restart == 0);
  }

  /// The number of such frames before frame `end`. Those before `index --from` are counted, too, though they were not
  /// searched: SearchPart, which tells it, is not read here. It makes an object need log10(1 + n / m) more of -log10
  /// NFA, where n frames before that time are counted with the m that were searched. The same holds for the searches
  /// that FullSearchSchedule leaves out while the image stands still, and for the views that it leaves out of a search.
  [[nodiscard]] std::int64_t CountBefore(std::int64_t end) const {
    const auto multiples = [end](std::int64_t step) { return (end + step - 1) / step; };
    if (restart == 0) return multiples(every);
    return multiples(every) + multiples(restart) - multiples(std::lcm(every, restart));
  }
};

}  // namespace victorious
