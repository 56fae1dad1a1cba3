// The routes of videos: their records, files, frames, times, sightings, and the camera's path. Thread-safe.
#pragma once

#include <optional>
#include <string>

#include "victorious/apps/serve/camera_path.h"
#include "victorious/apps/serve/copy_folder.h"
#include "victorious/apps/serve/index_view.h"
#include "victorious/apps/serve/once_cache.h"
#include "victorious/apps/serve/route_table.h"
#include "victorious/apps/serve/video_files.h"

namespace victorious {

class VideoRoutes {
 public:
  VideoRoutes(IndexView& index, VideoFiles& videos, CopyFolder& copies);

  ApiExpected<HttpResponse> List(const ApiCall& call);
  ApiExpected<HttpResponse> Get(const ApiCall& call);
  ApiExpected<HttpResponse> Times(const ApiCall& call);
  ApiExpected<HttpResponse> Sightings(const ApiCall& call);
  ApiExpected<HttpResponse> Camera(const ApiCall& call);
  ApiExpected<HttpResponse> File(const ApiCall& call);
  ApiExpected<HttpResponse> Copy(const ApiCall& call);
  ApiExpected<HttpResponse> Frame(const ApiCall& call);

 private:
  [[nodiscard]] Expected<CameraPath> ReadCameraPath(const VideoRecord& video, std::optional<double> ground_m,
                                                    const CancelToken& cancel);

  IndexView& index_;
  VideoFiles& videos_;
  CopyFolder& copies_;
  OnceCache<std::string> camera_paths_;  ///< bodies of answers
};

}  // namespace victorious
