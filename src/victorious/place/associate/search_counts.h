// The number of searches that an object is judged by, for the a contrario test (object_rejection.h): each of them could
// have made a detection as strong by chance.
//
// Only the videos that show the object count, and at most one hour of them. If all videos of an index counted, an
// object would be rejected as the archive grows, and each new video would change every object.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "victorious/place/associate/object_hypothesis.h"

namespace victorious {

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
