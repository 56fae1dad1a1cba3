// jobs/, which matches by shape count: those of a frame, with what the held frames before it show of them.
#pragma once

#include <span>

#include "victorious/base/error.h"
#include "victorious/jobs/index/frame_selector.h"
#include "victorious/jobs/index/index_pass.h"

namespace victorious {

/// Adds what was found by shape in a frame to its detections, where the frame and those before it together are evidence
/// enough. What the last search by shape left undecided (FrameWork::undecided) is searched for, too. Deterministic.
/// @param held  the tracked frames before this one, in order, without gaps
/// Errors: those of feature extraction and of ShapeSearch.
[[nodiscard]] Status AddShapeDetections(const IndexPass& pass, std::span<const FrameWork* const> held, FrameWork& task);

}  // namespace victorious
