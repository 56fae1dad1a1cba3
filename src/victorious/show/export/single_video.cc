#include "victorious/show/export/single_video.h"

#include <string>
#include <vector>

#include <fmt/format.h>

namespace victorious {

Expected<const VideoRecord*> FindSingleVideo(const ExportRequest& request, std::string_view format) {
  const std::vector<VideoRecord>& videos = request.catalogue.videos();
  if (videos.size() < 2) return videos.empty() ? nullptr : &videos.front();
  std::string names;
  for (const VideoRecord& video : videos) names += (names.empty() ? "" : ", ") + ShownName(video);
  return Fail(
      ErrorCode::kInvalidArgument,
      fmt::format("format {} needs a single video, but these match: {}: select one with --video", format, names));
}

}  // namespace victorious
