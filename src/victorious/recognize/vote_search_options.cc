#include "victorious/recognize/vote_search_options.h"

#include "victorious/geometry/angles.h"
#include "victorious/kernels/nearest.h"

namespace victorious {

void VoteSearchOptions::ListFields(FieldList& fields) {
  fields.Add("nearest", nearest,
             {.min = 1,
              .max = static_cast<double>(kernels::kMaxNeighbours),
              .reason = "ranked matches per template keypoint: its nearest scene keypoints"});
  fields.Add("max_refined_views", max_refined_views,
             {.min = 0,
              .max = 100000,
              .reason = "coarse views whose neighbours are matched, too: those of the highest -log10 NFA"});
  fields.Add("max_pooled_views", max_pooled_views,
             {.min = 0,
              .max = 100000,
              .unit = "views",
              .reason = "views of the highest -log10 NFA that vote once more together with the matches of their "
                        "neighbours: an object seen from between two views matches keypoints of both"});
  fields.Add("max_relit_views", max_relit_views,
             {.min = 0,
              .max = 100000,
              .unit = "views",
              .reason = "coarse views that are also matched relit by the sun: those of the highest -log10 NFA under "
                        "diffuse light; by default all, since direct sun may hide features of diffuse light"});
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
  fields.Add("sun_step_rad", sun_step_rad,
             {.min = 0.05,
              .max = 3.2,
              .unit = "rad",
              .reason = "quantisation step of the sun's azimuth for relit templates; finer is more accurate, and needs "
                        "more renderings and memory"});
  fields.Add("min_sun_neg_log10_nfa", min_sun_neg_log10_nfa,
             {.min = -100,
              .max = 1000,
              .unit = "decades",
              .reason = "minimum -log10 NFA of a pose whose shading determines the sun's direction"});
  fields.Add("max_sun_views", max_sun_views,
             {.min = 1,
              .max = 100000,
              .unit = "views",
              .reason = "views per frame that are tested for the sun's direction: those of the highest -log10 NFA "
                        "under diffuse light; each is relit by eight suns"});
  fields.AddGroup("votes", votes);
}

}  // namespace victorious
