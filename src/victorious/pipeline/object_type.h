// What a person says that an object is, in a word ("vehicle", "vehicle/car"), and what follows from the word: whether
// such things move, and how long they are, which tells how far off they stand.
#pragma once

#include <span>
#include <string_view>

namespace victorious {

struct ObjectType {
  std::string_view name;
  bool stands_still = false;  ///< things of this kind never move
  double length_m = 0;        ///< of the longest side; 0: things of this kind are of any size
  double length_share = 0;    ///< sigma of it over it
  bool flies = false;         ///< things of this kind need not be on the ground
};

/// By the last part of the word that is known ("car" of "vehicle/car"), whatever its case; null where none is: the word
/// is a name, and nothing follows from it.
[[nodiscard]] const ObjectType* FindObjectType(std::string_view word);

[[nodiscard]] std::span<const ObjectType> ObjectTypes();

}  // namespace victorious
