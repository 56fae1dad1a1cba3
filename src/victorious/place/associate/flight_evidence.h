// What the places of a flight's objects say of its telemetry, of the models' lengths, and so of each object.
//
// A place that contradicts itself (the object is 9 times too small for its distance, or lies below any ground) has
// three explanations: the find is false, the flight's telemetry is wrong, or the length of the object's model is. Each
// object has one finding c_i, and a probability p_i of being real by its recognition alone. With T = the telemetry is
// right, M = the model's length is right:
//
//   f_i(T, M) = p_i P(c_i | real, T, M) + (1 - p_i) P(c_i | false)
//   P(T, M | all) ~ P(T) prod over models [ P(M) prod over its objects f_i(T, M) ]
//
// The sum over T and all M is exact, because models are independent given T. What the finding of object i says of it is
//
//   ln [ sum over T, M of P(T, M | all others) P(c_i | real, T, M) / P(c_i | false) ]
//
// Where other objects agree with their places, the telemetry is right, and a contradicted place speaks against the
// find; where all are contradicted, the telemetry is at fault, and it says little.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace victorious {

/// What an object's place says.
enum class PlaceFinding {
  kNothing,         ///< no place, or nothing that could contradict it
  kAgrees,          ///< it stands, its lines of sight intersect, and its size fits their distance
  kImpossible,      ///< its size contradicts the distance, it lies below the ground, or it moves across its heading
  kAbove,           ///< it is high above the other objects, by its size
  kNoIntersection,  ///< its lines of sight do not intersect
};

struct FindingOfObject {
  std::int64_t model = 0;
  double probability = 0.5;  ///< of being real, by its recognition alone
  PlaceFinding finding = PlaceFinding::kNothing;
};

/// What each finding says of its object: the natural logarithm of how many times likelier it is of a real object than
/// of a false one; 0 for kNothing. Cost: linear.
/// @param objects  all that one flight shows
[[nodiscard]] std::vector<double> WeighFindings(std::span<const FindingOfObject> objects);

}  // namespace victorious
