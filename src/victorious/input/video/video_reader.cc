#include "victorious/input/video/video_reader.h"

#include <cmath>
#include <filesystem>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "victorious/input/video/demuxer.h"
#include "victorious/input/video/image_sequence_reader.h"
#include "victorious/input/video/media_reader.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

Status CheckOptions(const VideoReaderOptions& options) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (!positive(options.open_timeout_s)) return Fail(ErrorCode::kInvalidArgument, "open_timeout_s: must be above 0");
  if (!positive(options.folder_frame_rate)) {
    return Fail(ErrorCode::kInvalidArgument, "folder_frame_rate: must be above 0");
  }
  if (options.threads < 0) return Fail(ErrorCode::kInvalidArgument, "threads: must be 0 or more");
  return {};
}

Expected<std::unique_ptr<VideoReader>> OpenPath(const fs::path& path, const VideoReaderOptions& options) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    return Fail(ErrorCode::kNotFound, fmt::format("{}: no such file or folder", path.string()));
  }
  if (error) return std::unexpected(ErrorFromErrno(error.value(), path.string()));
  if (fs::is_directory(status)) return OpenImageFolder(path, options);
  if (!fs::is_regular_file(status)) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: neither a file nor a folder", path.string()));
  }
  if (fs::file_size(path, error) == 0 && !error) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: the file is empty", path.string()));
  }
  if (IsImageFile(path)) return OpenImage(path, options);
  return OpenMedia({.name = path.string()}, options);
}

}  // namespace

Expected<std::unique_ptr<VideoReader>> VideoReader::Open(const std::string& source, const VideoReaderOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(CheckOptions(options));
  if (source.empty()) return Fail(ErrorCode::kInvalidArgument, "no video given: must be a file, a folder or a URL");
  const auto scheme = UrlScheme(source);
  if (scheme == "file") return OpenPath(source.substr(std::string_view("file://").size()), options);
  if (scheme) return OpenMedia({.name = source, .remote = true, .timeout_s = options.open_timeout_s}, options);
  return OpenPath(source, options);
}

}  // namespace victorious
