// Private to telemetry/: the items of MISB ST 0601.19, UAS Datalink Local Set, as its table has them.
#pragma once

#include <cstddef>
#include <string_view>

namespace victorious {

enum class ItemCoding {
  kUnsigned,        ///< a whole number
  kSigned,          ///< a whole number, two's complement
  kText,            ///< UTF-8
  kLinearUnsigned,  ///< 0 is `min`, all ones `max`
  kLinearSigned,    ///< the largest number is `max`, its negative `min`, the number below that no value
  kImapb,           ///< ST 1201, forward mapping B from [min, max]
  kBytes,           ///< a list of bytes, each a whole number
  kBerOids,         ///< a list of BER object identifiers
  kBits,            ///< a list of the bits that are set, the lowest of the last byte being 0
  kSet,             ///< a local set of another standard, of numbered items as this one
  kRaw,             ///< a pack
};

struct ItemSpec {
  int number;
  std::string_view name;
  ItemCoding coding;
  double min = 0;
  double max = 0;
  std::string_view unit = {};
  std::size_t bytes = 0;  ///< of a linear item; 0 for the others, whose length is free
};

/// Nothing for numbers that the standard lacks.
[[nodiscard]] const ItemSpec* FindSt0601Item(int number);

}  // namespace victorious
