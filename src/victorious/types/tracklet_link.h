// What people say of the identity of tracklets.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace victorious {

/// A person's word on two tracklets of one model, which data association obeys.
struct TrackletLink {
  std::int64_t first = 0;   ///< id; negative: of one that is not in the index now, another number for another one
  std::int64_t second = 0;  ///< likewise
  bool is_one = true;       ///< they are one object; else they are two
};

/// A person's word on some tracklets of one model: those of a group are one object, those of different groups are
/// different ones.
struct TrackletGroups {
  std::vector<std::vector<std::int64_t>> groups;  ///< ids; none is empty, and no id stands in two
  std::string author;                             ///< who says so; empty: nobody gave a name
  std::int64_t made_utc_us = 0;                   ///< microseconds since 1970
};

}  // namespace victorious
