// Which files the server opens by names out of its index: videos, their telemetry, geoid grids. Whoever may write the
// index names them, so that only those below known folders are opened (base/file_roots.h), and only what begins as a
// video or an image is sent as it is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/base/file_roots.h"
#include "victorious/base/warning_sink.h"
#include "victorious/types/index_records.h"

namespace victorious {

/// The telemetry file that was given to the server, and the video that it belongs to.
struct GivenTelemetryFile {
  std::int64_t video = 0;
  std::string path;
};

/// Thread-safe.
class VideoRoots {
 public:
  /// @param files  that may be opened
  /// @param index  the file of the index: a relative name of a video that is not found from the current folder is
  ///               looked for from the index's folder; empty: there is no file
  /// @param telemetry  given to the server; std::nullopt: none
  VideoRoots(FileRoots files, const std::filesystem::path& index, std::optional<GivenTelemetryFile> telemetry = {});

  [[nodiscard]] const FileRoots& files() const { return files_; }

  /// The path of a video. Errors: kNotFound with the name and the remedy; kPermissionDenied for one that lies
  /// elsewhere; kUnsupported for a live source.
  [[nodiscard]] Expected<std::filesystem::path> Find(const VideoRecord& video) const;

  /// Opens the file of a video, to be sent as it is. Errors: those of Find and of opening; kUnsupported for a folder of
  /// images, and for a file that does not begin as a video or an image.
  [[nodiscard]] Expected<OpenedFile> Open(const VideoRecord& video) const;

  /// The telemetry file that was given for a video, to the server or when it was indexed (RememberedTelemetry);
  /// std::nullopt: that of a video is in it or beside it.
  /// @param warn  receives a line if the file is gone; may be empty
  [[nodiscard]] std::optional<std::string> Telemetry(const VideoRecord& video, const WarningSink& warn = {}) const;
  /// The one that was given to the server.
  [[nodiscard]] std::optional<std::string> GivenTelemetry(const VideoRecord& video) const;

  /// Says which videos cannot be shown because they lie elsewhere, on one line; empty if all can.
  [[nodiscard]] std::string DescribeOutside(const std::vector<VideoRecord>& videos) const;

 private:
  /// Where the file may lie, the likeliest first.
  [[nodiscard]] std::vector<std::filesystem::path> Candidates(const VideoRecord& video) const;
  [[nodiscard]] bool IsVideo(const OpenedFile& file) const;

  FileRoots files_;
  std::filesystem::path index_folder_;
  std::optional<GivenTelemetryFile> telemetry_;
  mutable std::mutex mutex_;
  mutable std::unordered_map<std::string, bool> is_video_;  ///< by the identity of the file and its last change
};

}  // namespace victorious
