// Converts an object pose in the camera's frame and the camera's state into a bearing observation: line of sight in
// east-north-up, range, and heading of the object.
//
// The line of sight goes to the object's centre (object_pose.h). The heading is the azimuth of the object's front (+x);
// it exists only with a 6-DoF pose.
#pragma once

#include <cstdint>
#include <optional>

#include "victorious/place/observe/object_pose.h"
#include "victorious/types/bearing_observation.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/index_records.h"

namespace victorious {

/// Makes the bearing observation of an object pose. std::nullopt if the camera state is incomplete.
/// @param camera  at the time of the frame
std::optional<BearingObservation> MakeBearingObservation(const ObjectPose& object_pose, const CameraState& camera);

/// Returns the `recognition_id` of a tracklet's next observation: that of the previous observation if the sighting is
/// tracked and there is one, else a new id. Observations with the same id have a common error.
/// @param before        previous observation of the tracklet, or null
/// @param recognitions  counter of ids; incremented for a new id
std::int64_t NextRecognitionId(const SightingRecord& sighting, const BearingObservation* before,
                               std::int64_t& recognitions);

}  // namespace victorious
