#include "victorious/search/recognize/vote_search_options.h"

#include "victorious/geometry/angles.h"
#include "victorious/kernels/nearest.h"

namespace victorious {

void VoteSearchOptions::ListFields(FieldList& fields) {
  fields.Add("nearest", nearest,
             {.min = 1,
              .max = static_cast<double>(kernels::kMaxNeighbours),
              .reason = "ranked matches per template keypoint: its nearest scene keypoints"});
  fields.Add("max_tilt_rad", max_tilt_rad,
             {.min = 0.01,
              .max = 3.2,
              .unit = "rad",
              .reason = "with known camera attitude: maximum angle between an object's up axis and the vertical, the "
                        "angular step between views included; 3.2 allows any attitude of the object"});
  fields.Add(
      "max_hanging_rad", max_hanging_rad,
      {.min = 0,
       .max = kPi / 2,
       .unit = "rad",
       .reason = "with unknown camera attitude: maximum angle of an object's up axis below the image's horizontal; "
                 "pi/2 for a camera that may be upside down"});
}

}  // namespace victorious
