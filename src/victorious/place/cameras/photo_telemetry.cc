#include "victorious/place/cameras/photo_telemetry.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "victorious/input/telemetry/photo.h"
#include "victorious/input/video/image_folder.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

bool StartsAsJpeg(std::istream& file) { return file.get() == 0xFF && file.get() == 0xD8; }

// Appends `size` bytes of the file, fewer at its end.
void Append(std::istream& file, std::size_t size, std::string& bytes) {
  const std::size_t before = bytes.size();
  bytes.resize(before + size);
  file.read(bytes.data() + before, static_cast<std::streamsize>(size));
  bytes.resize(before + static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
}

}  // namespace

std::string ReadPhotoHead(std::istream& file) {
  constexpr int kMaxSegments = 4096;  // thermal cameras have some hundreds, with raw temperatures
  if (!StartsAsJpeg(file)) return {};
  std::string head = "\xFF\xD8";
  for (int segment = 0; segment < kMaxSegments; ++segment) {
    std::string start;
    Append(file, 4, start);
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(start[i]); };
    if (start.size() < 4 || byte(0) != 0xFF) return head;
    if (byte(1) == 0xFF) {  // a fill byte
      file.seekg(-3, std::ios::cur);
      continue;
    }
    const std::size_t size = byte(2) << 8 | byte(3);  // of the segment without its marker
    if (size < 2) return head;
    const bool is_tags = byte(1) == 0xE1;
    const bool is_frame = byte(1) >= 0xC0 && byte(1) <= 0xCF && byte(1) != 0xC4 && byte(1) != 0xC8 && byte(1) != 0xCC;
    if (is_tags || is_frame) {
      head += start;
      Append(file, size - 2, head);
    } else {
      file.seekg(static_cast<std::streamoff>(size - 2), std::ios::cur);
    }
    if (is_frame || byte(1) == 0xDA) return head;
  }
  return head;
}

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
    std::ifstream file(files[i], std::ios::binary);
    const std::string head = ReadPhotoHead(file);
    PhotoMetadata photo = ReadPhotoMetadata(std::as_bytes(std::span(head))).value_or(PhotoMetadata());
    photo.time_s = static_cast<double>(i - first) / frame_rate;
    photos.push_back(std::move(photo));
  }
  if (std::ranges::none_of(photos, &PhotoMetadata::HasPlace)) return std::nullopt;
  VICTORIOUS_ASSIGN_OR_RETURN(Telemetry telemetry, TelemetryFromPhotos(photos, options));
  return telemetry;
}

}  // namespace victorious
