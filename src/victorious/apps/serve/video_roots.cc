#include "victorious/apps/serve/video_roots.h"

#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>

#include "victorious/base/absolute_path.h"
#include "victorious/base/one_line.h"
#include "victorious/input/video/video_probe.h"
#include "victorious/place/cameras/video_telemetry.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// Changes with the file, its place and its content.
std::string IdentityOf(const OpenedFile& file) {
  struct stat status{};
  if (::fstat(*file.descriptor, &status) != 0) return "";
  return fmt::format("{} {} {} {}.{}", status.st_dev, status.st_ino, status.st_size, status.st_mtim.tv_sec,
                     status.st_mtim.tv_nsec);
}

}  // namespace

VideoRoots::VideoRoots(FileRoots files, const fs::path& index, std::optional<GivenTelemetryFile> telemetry)
    : files_(std::move(files)), index_folder_(index.parent_path()), telemetry_(std::move(telemetry)) {}

std::vector<fs::path> VideoRoots::Candidates(const VideoRecord& video) const {
  const fs::path name = video.name;
  if (name.is_absolute()) return {name};
  std::vector<fs::path> candidates;
  if (!video.folder.empty()) candidates.push_back(fs::path(video.folder) / name);
  candidates.push_back(name);
  if (!index_folder_.empty()) candidates.push_back(index_folder_ / name);
  return candidates;
}

Expected<fs::path> VideoRoots::Find(const VideoRecord& video) const {
  if (video.name.contains("://")) {
    return Fail(ErrorCode::kUnsupported, ShownName(video) + ": a live source: its frames are not kept");
  }
  Status allowed;
  for (fs::path& path : Candidates(video)) {
    std::error_code error;
    if (const Status inside = files_.Check(path); !inside) {
      allowed = inside;
    } else if (fs::exists(path, error)) {
      return std::move(path);
    }
  }
  if (!allowed) return std::unexpected(allowed.error());
  return Fail(ErrorCode::kNotFound,
              fmt::format("{}: the video is not there: move it back, or start `victorious serve` in the folder that "
                          "the index was made in",
                          ShownName(video)));
}

Expected<OpenedFile> VideoRoots::Open(const VideoRecord& video) const {
  VICTORIOUS_ASSIGN_OR_RETURN(const fs::path path, Find(video));
  std::error_code error;
  if (fs::is_directory(path, error)) {
    return Fail(ErrorCode::kUnsupported, ShownName(video) + ": a folder of images: read its frames one by one");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(OpenedFile file, files_.Open(path));
  if (IsVideo(file)) return file;
  return Fail(ErrorCode::kUnsupported,
              OneLine(path.filename().string()) + ": neither a video nor an image, and not sent");
}

bool VideoRoots::IsVideo(const OpenedFile& file) const {
  constexpr std::size_t kMaxKnown = 100'000;
  const std::string identity = IdentityOf(file);
  {
    const std::scoped_lock lock(mutex_);
    if (const auto known = is_video_.find(identity); known != is_video_.end()) return known->second;
  }
  const bool is_video = BeginsAsVideo(file.path);
  const std::scoped_lock lock(mutex_);
  if (is_video_.size() >= kMaxKnown) is_video_.clear();
  if (!identity.empty()) is_video_[identity] = is_video;
  return is_video;
}

std::optional<std::string> VideoRoots::Telemetry(const VideoRecord& video, const WarningSink& warn) const {
  if (auto given = GivenTelemetry(video)) return given;
  return RememberedTelemetry(video.telemetry, files_, warn);
}

std::optional<std::string> VideoRoots::GivenTelemetry(const VideoRecord& video) const {
  return telemetry_ && telemetry_->video == video.id ? std::optional(telemetry_->path) : std::nullopt;
}

std::string VideoRoots::DescribeOutside(const std::vector<VideoRecord>& videos) const {
  std::size_t count = 0;
  fs::path first;
  for (const VideoRecord& video : videos) {
    const auto path = Find(video);
    if (path || path.error().code != ErrorCode::kPermissionDenied) continue;
    if (count++ == 0) first = AbsolutePath(Candidates(video).front());
  }
  if (count == 0) return "";
  return fmt::format(
      "{} of {} videos are not shown: they lie in none of the folders that this server opens files in; "
      "for the first give --videos {}",
      count, videos.size(), OneLine(first.parent_path().string()));
}

}  // namespace victorious
