#include "victorious/pipeline/photo_telemetry.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "victorious/telemetry/photo.h"
#include "victorious/video/image_folder.h"
#include "victorious/video/video_reader.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// The tags stand before the image data, and before thermal cameras' raw temperatures of some megabytes.
constexpr std::size_t kMaxHead = std::size_t{8} << 20;

bool StartsAsJpeg(std::istream& file) { return file.get() == 0xFF && file.get() == 0xD8; }

std::string ReadJpegHead(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!StartsAsJpeg(file)) return {};
  file.seekg(0);
  std::string head(kMaxHead, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return head;
}

}  // namespace

bool IsOfImages(const std::string& video) {
  std::error_code error;
  if (fs::is_directory(video, error)) return true;
  if (!fs::is_regular_file(video, error)) return false;
  std::ifstream file(video, std::ios::binary);
  return StartsAsJpeg(file);
}

Expected<std::optional<Telemetry>> ReadPhotoTelemetry(const std::string& video, double frame_rate,
                                                      const TelemetryOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(video, {.folder_frame_rate = frame_rate}));
  std::vector<fs::path> files = {video};
  std::error_code error;
  if (fs::is_directory(video, error)) {
    VICTORIOUS_ASSIGN_OR_RETURN(files, ListImages(video));
  }
  const std::size_t count = files.size();
  const auto readable = static_cast<std::size_t>(reader->info().frame_count.value_or(0));
  const std::size_t first = count - std::min(readable, count);
  std::vector<PhotoMetadata> photos;
  for (std::size_t i = first; i < count; ++i) {
    const std::string head = ReadJpegHead(files[i]);
    PhotoMetadata photo = ReadPhotoMetadata(std::as_bytes(std::span(head))).value_or(PhotoMetadata());
    photo.time_s = static_cast<double>(i - first) / frame_rate;
    photos.push_back(std::move(photo));
  }
  if (std::ranges::none_of(photos, &PhotoMetadata::HasPlace)) return std::nullopt;
  VICTORIOUS_ASSIGN_OR_RETURN(Telemetry telemetry, TelemetryFromPhotos(photos, options));
  return telemetry;
}

}  // namespace victorious
