#include "victorious/jobs/stored_video.h"

#include <string>

#include <fmt/format.h>

#include "victorious/store/index_store.h"

namespace victorious {

Expected<std::unique_ptr<VideoReader>> OpenStoredVideo(const VideoRecord& video, const VideoReaderOptions& options,
                                                       const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::unique_ptr<VideoReader> reader, VideoReader::Open(FindVideoFile(video), options));
  if (reader->info().live) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: a live source cannot be read again: index a recording of it", ShownName(video)));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string content_id, reader->ContentId(cancel, {}));
  if (content_id == video.content_id) return reader;
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: not the video that was indexed under this name: restore that file, or index this one",
                          ShownName(video)));
}

}  // namespace victorious
