// Finds telemetry of another flight by the mean motion of the image. A steady flight does not tell the offset of its
// clock (time_offset.h), but a camera that circles turns the image, and one that flies straight does not.
//
// Over each second, the mean motion of the image is compared with that of flat ground as telemetry predicts it, at the
// height of the ground at which the median over the seconds agrees best.
#pragma once

#include <optional>

#include "victorious/place/calibrate/time_offset.h"

namespace victorious {

/// Compares the mean motions of image and telemetry second by second, without an offset. std::nullopt if they agree, or
/// if too little is seen: at least half of the motion, or of its turning and a tenth of the motion, and at least 0.5 px
/// from one frame to the next, must be missing in four of five seconds, in one direction. The height of the ground is
/// free, so that a motion may seem slower than it is, but not turn the image. Clocks that are off do not matter to a
/// steady motion.
[[nodiscard]] std::optional<ContradictedMotion> FindContradiction(const ImageMotions& seen,
                                                                  const CameraTrajectory& cameras);

}  // namespace victorious
