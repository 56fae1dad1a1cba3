// The one place where objects come to be: from runs, each a stretch in which one thing was seen in one video, to
// objects, each with one identity over all its runs, one place, and a reason where it is rejected.
//
//   runs -> their places -> runs of one model that can be one thing are joined, the nearest first -> what cannot be
//
// Two runs of a video that share a frame are two things. Others are one if their places, taken to the same moment by
// how they move, are within a gate of their covariance, and the lines of both meet where the two together are.
//
// Everything is made from what is stored: the same whether a video was indexed in one go or in many, and made anew
// when another video shows more.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/pipeline/object_options.h"
#include "victorious/store/index_store.h"
#include "victorious/types/sight.h"

namespace victorious {

/// What is known of a run. A category's runs become objects like others, but none is rejected: it says that a kind of
/// things was seen, whichever of them, and is no rival of the object that stands there.
struct SeenRun {
  RunRecord record;
  bool of_category = false;
  bool of_solid = false;             ///< of a CAD model: nothing is seen through it
  std::vector<std::int64_t> frames;  ///< rising
  std::vector<Box> boxes;            ///< one a frame
  std::vector<double> scores;        ///< of those frames in which it was recognised
  std::vector<Sight> sights;         ///< by time; of those of its sightings that have one
};

/// Deterministic, whatever the order of runs. Objects by id; of each the id, model, runs, place, heading, rejection.
/// @param frames_searched  as a whole, in which runs could have been found: those of each video, once for each model;
///                         the more, the more chance finds, and the clearer a find must be
std::vector<ObjectRecord> MakeObjects(std::vector<SeenRun> runs, std::int64_t frames_searched,
                                      const ObjectOptions& options);

/// Makes the objects of everything that an index holds, and stores them.
Status UpdateObjects(const ObjectOptions& options, IndexStore& store);

}  // namespace victorious
