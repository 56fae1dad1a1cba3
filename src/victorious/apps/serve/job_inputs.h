// From the body of a request for a job to the input of the job (job_runner.h). Thread-safe.
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "victorious/apps/serve/api_error.h"
#include "victorious/apps/serve/api_options.h"
#include "victorious/apps/serve/copy_folder.h"
#include "victorious/apps/serve/index_view.h"
#include "victorious/apps/serve/upload_folder.h"
#include "victorious/apps/serve/video_files.h"
#include "victorious/base/cancel.h"
#include "victorious/store/job_queue.h"
#include "victorious/types/json_values.h"

namespace victorious {

class JobInputs {
 public:
  /// All must outlive this.
  JobInputs(const ApiOptions& options, IndexView& index, VideoFiles& videos, CopyFolder& copies, UploadFolder& uploads)
      : options_(options), index_(index), videos_(videos), copies_(copies), uploads_(uploads) {}

  /// Errors: kInvalidArgument with the member that is wrong; those of reading what it names.
  ApiExpected<Json> Make(JobKind kind, const nlohmann::json& body, const CancelToken& cancel);

  /// Fails with kConflict if a job that reads the index would not do what was asked for: it names what has changed.
  ApiStatus CheckStillValid(const JobRecord& job, const CancelToken& cancel);

  /// Whether the library has a model.
  [[nodiscard]] bool HasModels() const;
  [[nodiscard]] bool HasSample(const IndexLists& lists) const;

 private:
  ApiExpected<Json> IndexInput(const nlohmann::json& body);
  ApiExpected<Json> ModelInput(const nlohmann::json& body, const CancelToken& cancel);
  ApiExpected<Json> CopyInput(const nlohmann::json& body);
  ApiExpected<Json> ClipInput(const nlohmann::json& body);
  ApiExpected<Json> RefineInput(const nlohmann::json& body);
  /// Errors: kUnsupported without a sample, or if the index has a video.
  ApiExpected<Json> SampleInput(const nlohmann::json& body);
  ApiExpected<Json> RemoveInput(const nlohmann::json& body);
  static ApiExpected<Json> LiveInput(const nlohmann::json& body);
  ApiExpected<Json> TrackInput(const nlohmann::json& body, const CancelToken& cancel);
  /// Writes a frame of a video as an image among the uploads.
  ApiExpected<std::filesystem::path> SaveFrame(const nlohmann::json& body, const CancelToken& cancel);

  const ApiOptions& options_;
  IndexView& index_;
  VideoFiles& videos_;
  CopyFolder& copies_;
  UploadFolder& uploads_;
};

}  // namespace victorious
