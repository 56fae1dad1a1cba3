// From a detection and the camera's state to the line along which the object was seen, its range and its heading.
//
// Models that know their points in space (CAD): how the object stands before the camera (stance.h) tells all three; the
// line goes to the middle of the bounding box, the front gives the heading.
// Photos: the line goes to the middle of the outline; a range only where the object's length is known.
#pragma once

#include <optional>

#include "victorious/base/options.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"
#include "victorious/types/sight.h"
#include "victorious/types/stance.h"

namespace victorious {

struct SightOptions {
  double least_sigma_px = 0.3;
  double photo_centre_share = 0.1;
  double photo_range_share = 0.3;

  void ListFields(FieldList& fields);
};

/// @param stance  of the detection, if known
/// @param scene   the frame's features, which the detection's matches count in
/// @param camera  at the frame's time
/// Nothing where the camera's state is not complete, or the detection does not tell where the object's middle is.
std::optional<Sight> SightOf(const Detection& detection, const std::optional<Stance>& stance, const ObjectModel& model,
                             const FeatureSet& scene, const CameraState& camera, const SightOptions& options);

}  // namespace victorious
