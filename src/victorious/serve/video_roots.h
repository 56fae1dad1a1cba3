// Which files the server opens by names out of its index: videos, their telemetry, geoid grids. Whoever may write the
// index names them, so that only those below known folders are opened (base/file_roots.h), and only what begins as a
// video or an image is sent as it is.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/base/file_roots.h"
#include "victorious/base/warning_sink.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// Thread-safe.
class VideoRoots {
 public:
  /// @param files  that may be opened
  /// @param index  the file of the index: a relative name of a video that is not found from the current folder is
  ///               looked for from the index's folder; empty: there is no file
  VideoRoots(FileRoots files, const std::filesystem::path& index);

  [[nodiscard]] const FileRoots& files() const { return files_; }

  /// The path of a video. Errors: kNotFound with the name and the remedy; kPermissionDenied for one that lies
  /// elsewhere; kUnsupported for a live source.
  [[nodiscard]] Expected<std::filesystem::path> Find(const VideoRecord& video) const;

  /// Opens the file of a video, to be sent as it is. Errors: those of Find and of opening; kUnsupported for a folder of
  /// images, and for a file that does not begin as a video or an image.
  [[nodiscard]] Expected<OpenedFile> Open(const VideoRecord& video) const;

  /// The telemetry file that was given when a video was indexed (RememberedTelemetry).
  [[nodiscard]] std::optional<std::string> Telemetry(const VideoRecord& video, const WarningSink& warn) const;

  /// Says which videos cannot be shown because they lie elsewhere, on one line; empty if all can.
  [[nodiscard]] std::string DescribeOutside(const std::vector<VideoRecord>& videos) const;

 private:
  /// Where the file may lie, the likeliest first.
  [[nodiscard]] std::vector<std::filesystem::path> Candidates(const VideoRecord& video) const;
  [[nodiscard]] bool IsVideo(const OpenedFile& file) const;

  FileRoots files_;
  std::filesystem::path index_folder_;
  mutable std::mutex mutex_;
  mutable std::unordered_map<std::string, bool> is_video_;  ///< by the identity of the file and its last change
};

}  // namespace victorious
