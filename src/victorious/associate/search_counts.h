// How much was searched, for the a contrario test (object_rejection.h): the number of tests in which chance could have
// made a detection as strong as an object.
//
// It is that of the videos that show the object, and of no more than an hour of them: an object is judged by the false
// alarms an hour that its strength means. If all searches of an index counted, an object would vanish as the archive
// grows, and each new video would change every object.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "victorious/associate/object_hypothesis.h"

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
  [[nodiscard]] std::int64_t CountBefore(std::int64_t end) const;
};

class SearchCounts {
 public:
  /// @param searches    full-frame searches for one model
  /// @param duration_s  of the video; std::nullopt: not known yet
  void Add(std::int64_t video, std::int64_t searches, std::optional<double> duration_s);

  /// Full-frame searches, summed over models, in the videos of a hypothesis; the mean of an hour if they are longer.
  [[nodiscard]] double TestsOf(const ObjectHypothesis& hypothesis) const;

 private:
  struct Video {
    std::int64_t searches = 0;
    double duration_s = 0;
  };
  std::map<std::int64_t, Video> of_video_;
};

}  // namespace victorious
