// Private to telemetry/: the item table of MISB ST 0601.19, UAS Datalink Local Set.
#pragma once

#include <cstddef>
#include <string_view>

namespace victorious {

enum class ItemCoding {
  kUnsigned,        ///< an unsigned integer
  kSigned,          ///< an integer in two's complement
  kText,            ///< UTF-8
  kLinearUnsigned,  ///< 0 maps to `min`, all ones to `max`
  kLinearSigned,    ///< the largest number maps to `max`, its negative to `min`; the number below means "no value"
  kImapb,           ///< ST 1201, mapping B of [min, max]
  kBytes,           ///< a list of integers of one byte each
  kBerOids,         ///< a list of BER object identifiers
  kBits,            ///< a list of the indices of set bits; bit 0 is the lowest of the last byte
  kSet,             ///< a nested local set of another standard, with numbered items
  kRaw,             ///< a pack; not decoded
};

struct ItemSpec {
  int number;
  std::string_view name;
  ItemCoding coding;
  double min = 0;
  double max = 0;
  std::string_view unit = {};
  std::size_t bytes = 0;  ///< standard length of a linear item; 0 for the others, whose length varies
};

/// @return nullptr for a number that the standard lacks
[[nodiscard]] const ItemSpec* FindSt0601Item(int number);

}  // namespace victorious
