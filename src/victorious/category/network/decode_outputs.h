// From the outputs of a detection network to boxes in its input, one a candidate at most: of its most likely class.
// The outputs may be any numbers: what is not finite, or empty, is left out.
//
// Sources: the post-processing of each family as published. YOLOX: centre = (o + cell) stride, size = exp(o) stride,
// score = objectness x class. NanoDet: a side is the mean of its distribution over bins, times the stride (Li et al.,
// "Generalized focal loss", NeurIPS 2020). FastestDet: score = objectness^0.6 class^0.4.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/category/network/detector_settings.h"
#include "victorious/category/network/network_tensor.h"

namespace victorious {

/// @param outputs  of a run, with as many values as their shapes say
/// @return the candidates from settings.min_score on, in the order of the outputs; boxes in px of the input, uncut
/// Error: kInvalidArgument if the shapes are not of the layout.
[[nodiscard]] Expected<std::vector<NetworkBox>> DecodeOutputs(std::span<const NetworkTensor> outputs,
                                                              const DetectorSettings& settings, std::size_t classes);

}  // namespace victorious
