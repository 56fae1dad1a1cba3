// The routes of evidence: why a sighting was reported, and how well the ground was searched for what was not found; and
// the images of a model's views. Thread-safe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <semaphore>
#include <string>
#include <string_view>

#include "victorious/apps/serve/index_view.h"
#include "victorious/apps/serve/once_cache.h"
#include "victorious/apps/serve/route_table.h"
#include "victorious/apps/serve/video_files.h"
#include "victorious/place/cameras/camera_states.h"
#include "victorious/types/object_model.h"

namespace victorious {

class EvidenceRoutes {
 public:
  /// @param models  the model library; empty: none
  EvidenceRoutes(IndexView& index, VideoFiles& videos, std::filesystem::path models);

  ApiExpected<HttpResponse> Get(const ApiCall& call);
  ApiExpected<HttpResponse> Coverage(const ApiCall& call);
  ApiExpected<HttpResponse> Views(const ApiCall& call);
  ApiExpected<HttpResponse> ViewImage(const ApiCall& call);

 private:
  /// Errors: kNotFound without a library, for a category, or without the model; kConflict for another model of this
  /// name.
  ApiExpected<std::shared_ptr<const ObjectModel>> LoadModel(const ModelRecord& record);
  /// The model of an id in the address. Errors: those of LoadModel; kNotFound.
  ApiExpected<std::shared_ptr<const ObjectModel>> LoadModelOf(std::string_view id);
  ApiExpected<SightingRecord> ReadSighting(std::int64_t object, QueryReader& query);
  /// The body of an answer, at most one at a time.
  [[nodiscard]] Expected<std::string> Make(const SightingRecord& sighting, const VideoRecord& video,
                                           const std::string& options_json, const ObjectModel& model,
                                           const CancelToken& cancel);

  /// The body of an answer. Errors: kNotFound if the camera or the ground is not known.
  [[nodiscard]] Expected<std::string> MakeCoverage(const VideoRecord& video, std::int64_t model_id,
                                                   const ObjectModel& model, double ground_m,
                                                   const CancelToken& cancel);

  IndexView& index_;
  VideoFiles& videos_;
  std::filesystem::path models_folder_;
  OnceCache<CameraStates> cameras_;   ///< by the video's content and the telemetry's options
  OnceCache<std::string> bodies_;     ///< of answers
  OnceCache<std::string> coverages_;  ///< of answers
  OnceCache<ObjectModel> models_;     ///< by name and state of the file; the files are mapped
  std::counting_semaphore<> slots_{1};
};

}  // namespace victorious
