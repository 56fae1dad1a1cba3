// Private to video/: the VideoReader of everything that FFmpeg demuxes and decodes.
#pragma once

#include <memory>

#include "victorious/base/error.h"
#include "victorious/video/demuxer.h"
#include "victorious/video/video_reader.h"

namespace victorious {

Expected<std::unique_ptr<VideoReader>> OpenMedia(const MediaSource& source, const VideoReaderOptions& options);

}  // namespace victorious
