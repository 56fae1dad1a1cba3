// Object types that a user can give to a box ("vehicle", "vehicle/car"), with their priors: whether such objects move,
// and their length, which gives a range from the apparent size.
#pragma once

#include <span>
#include <string_view>

namespace victorious {

struct ObjectType {
  std::string_view name;
  bool is_static = false;      ///< objects of this type never move
  double length_m = 0;         ///< longest side, m; 0: unknown, no size prior
  double length_fraction = 0;  ///< relative standard deviation of the length
  bool can_fly = false;        ///< objects of this type need not be on the ground
};

/// Finds the type by the last known part of a path ("car" of "vehicle/car"), ignoring case. Null if no part is known:
/// the word is then a mere name without priors.
[[nodiscard]] const ObjectType* FindObjectType(std::string_view word);

[[nodiscard]] std::span<const ObjectType> ObjectTypes();

}  // namespace victorious
