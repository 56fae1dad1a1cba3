// Opens the file of a video that an index has.
#pragma once

#include <memory>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/types/index_records.h"

namespace victorious {

/// Opens the file if it still has the content that was indexed; else frames of another video would be read.
/// Errors: those of VideoReader; kInvalidArgument for another content or a live source; kCancelled.
[[nodiscard]] Expected<std::unique_ptr<VideoReader>> OpenStoredVideo(const VideoRecord& video,
                                                                     const VideoReaderOptions& options,
                                                                     const CancelToken& cancel);

}  // namespace victorious
