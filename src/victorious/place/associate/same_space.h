// Private to associate/: two sightings of one CAD model in one frame that two bodies of its size cannot both be.
// Half of a vehicle may look like its other half, turned: it is then recognised twice, once where it is and once half
// of its length off, by keypoints that the two share. Such a report drives, stands and turns as the true object does;
// what contradicts it is that the space it fills is not free.
//
// Both lines of sight begin at the same camera, so its errors cancel in the vector from one object to the other:
//
//   p1 = r1 d1,   p2 = d2 (p1.z / d2.z),   d = p2 - p1 = ahead * front + right * front_turned_right
//
// with d1, d2 the directions of the lines and r1 the first range. Models of one kind that stand on the same ground have
// their centres at one height, which fixes p2 better than its own range does; where that range contradicts it, one is
// above the other. Two bodies whose centre lines are parallel are in one space if these are nearer than any vehicle is
// wide and their lengths overlap. The model's length is not known here: of objects seen from the side, the boxes in the
// image tell.
#pragma once

#include "victorious/geometry/box.h"
#include "victorious/types/bearing_observation.h"

namespace victorious {

/// True if the two are in one space. False where that cannot be told: a range or a heading is missing, the camera sees
/// them from less than 20 degrees above their horizon or along their length, or they stand at an angle.
/// @param first, second          of one CAD model in one frame
/// @param first_box, second_box  in that frame
[[nodiscard]] bool AreInSameSpace(const BearingObservation& first, const Box& first_box,
                                  const BearingObservation& second, const Box& second_box);

}  // namespace victorious
