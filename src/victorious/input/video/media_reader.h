// Private to video/: the VideoReader for all sources that FFmpeg demuxes and decodes.
#pragma once

#include <memory>

#include "victorious/base/error.h"
#include "victorious/input/video/demuxer.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {

/// Opens a source and decodes its first frame. Errors: those of VideoReader::Open.
[[nodiscard]] Expected<std::unique_ptr<VideoReader>> OpenMedia(const MediaSource& source,
                                                               const VideoReaderOptions& options);

}  // namespace victorious
