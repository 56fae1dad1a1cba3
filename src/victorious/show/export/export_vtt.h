// When objects are seen in one video, as WebVTT: text tracks of players and browsers.
#pragma once

#include "victorious/show/export/export_format.h"

namespace victorious {

/// A cue for each interval (single_video.h) of each object, in the order of time. One of less than half a second is
/// shown that long, to be read. Error: kInvalidArgument with more than one video.
extern const ExportFormat kVttFormat;

}  // namespace victorious
