#include "victorious/input/video/image_sequence_reader.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/base/folder.h"
#include "victorious/base/text.h"
#include "victorious/input/image/grey_range.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/image/image_header.h"
#include "victorious/input/video/damage_log.h"
#include "victorious/input/video/image_folder.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// What the images are; the text is VideoInfo::container.
enum class Sequence { kFolder, kSingleImage };

bool HasImageExtension(const fs::path& file) {
  static constexpr std::array<std::string_view, 11> kExtensions = {".png", ".jpg", ".jpeg", ".jpe", ".tif", ".tiff",
                                                                   ".bmp", ".ppm", ".pgm",  ".pbm", ".pnm"};
  return std::ranges::find(kExtensions, LowerCase(file.extension().string())) != kExtensions.end();
}

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// Removes the leading digits of `text` and returns them without leading zeros.
std::string_view TakeDigits(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && IsDigit(text[end])) ++end;
  std::string_view number = text.substr(0, end);
  text.remove_prefix(end);
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

class ImageSequenceReader : public VideoReader {
 public:
  ImageSequenceReader(Sequence sequence, std::vector<fs::path> files, const VideoReaderOptions& options)
      : sequence_(sequence), files_(std::move(files)), options_(options) {}

  /// Reads the first image, which determines the size.
  Status Start(const fs::path& source);

  [[nodiscard]] const VideoInfo& info() const override { return info_; }
  [[nodiscard]] Expected<std::string> ContentId(const CancelToken& cancel, const ByteProgress& progress) const override;
  Expected<std::optional<Frame>> NextFrame() override;
  std::vector<DataPacket> TakeDataPackets() override { return {}; }
  bool SeekTo(double time_s) override {
    const double frame_offset = std::clamp(time_s, 0.0, TimeFromIndex(files_.size())) * options_.folder_frame_rate;
    next_file_ = first_file_ + static_cast<std::size_t>(frame_offset);
    first_.reset();
    return true;
  }
  void SkipToEnd() override {
    first_.reset();
    next_file_ = files_.size();
  }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return damage_.lines(); }
  [[nodiscard]] const std::vector<std::string>& notes() const override { return damage_.notes(); }

 private:
  std::optional<Frame> ReadNext();
  Expected<cv::Mat> ReadImageFile(const fs::path& file);
  [[nodiscard]] double TimeFromIndex(std::size_t file_index) const {
    return static_cast<double>(file_index - first_file_) / options_.folder_frame_rate;
  }

  Sequence sequence_;
  std::vector<fs::path> files_;
  VideoReaderOptions options_;
  VideoInfo info_;
  DamageLog damage_;
  GreyRange range_;
  std::optional<Frame> first_;  ///< frame that Start() read, until it is delivered
  std::size_t next_file_ = 0;   ///< index in files_
  std::size_t first_file_ = 0;  ///< index in files_ of the first readable image
  std::int64_t next_index_ = 0;
};

Status ImageSequenceReader::Start(const fs::path& source) {
  first_ = ReadNext();
  if (!first_) {
    const std::string& reason = warnings().front();
    if (files_.size() == 1) return Fail(ErrorCode::kDataLoss, reason);
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: none of its {} images can be read, the first: {}",
                                                  source.string(), files_.size(), reason));
  }
  if (auto note = range_.Describe()) damage_.AddNote(*std::move(note));
  info_.of_images = true;
  info_.container = sequence_ == Sequence::kFolder ? "folder of images" : "image";
  info_.frame_rate = options_.folder_frame_rate;
  info_.frame_count = static_cast<std::int64_t>(files_.size() - first_file_);
  info_.duration_s = TimeFromIndex(files_.size());
  return {};
}

Expected<std::string> ImageSequenceReader::ContentId(const CancelToken& cancel, const ByteProgress& progress) const {
  if (sequence_ == Sequence::kFolder) return ContentIdOfFiles(files_, cancel, progress);
  return victorious::ContentId(files_.front(), cancel, progress);
}

Expected<std::optional<Frame>> ImageSequenceReader::NextFrame() {
  if (first_) return std::exchange(first_, std::nullopt);
  return ReadNext();
}

// An unusable image is logged and leaves a gap in time: the others keep the time of their index.
std::optional<Frame> ImageSequenceReader::ReadNext() {
  while (next_file_ < files_.size()) {
    const std::size_t file_index = next_file_++;
    if (next_index_ == 0) first_file_ = file_index;
    const auto bgr = ReadImageFile(files_[file_index]);
    if (bgr) {
      const bool is_bgr = options_.color == FrameColor::kBgr;
      return Frame{.index = next_index_++,
                   .time_s = TimeFromIndex(file_index),
                   .image = is_bgr ? *bgr : GreyFromBgr(*bgr),
                   .bgr = options_.color == FrameColor::kGreyAndBgr ? *bgr : cv::Mat()};
    }
    damage_.AddLine(bgr.error().message);
  }
  return std::nullopt;
}

Expected<cv::Mat> ImageSequenceReader::ReadImageFile(const fs::path& file) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(file));
  VICTORIOUS_ASSIGN_OR_RETURN(const Image image, DecodeImage(std::as_bytes(std::span(bytes)), file.string(), range_));
  if (next_index_ == 0) {
    const auto header = ReadImageHeader(std::as_bytes(std::span(bytes)));
    info_.codec = Name(header->format);
    info_.rotation_deg = ClockwiseRotationDeg(header->orientation);
    info_.width = image.bgr.cols;
    info_.height = image.bgr.rows;
  } else if (image.bgr.size() != cv::Size(info_.width, info_.height)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: {} x {} pixels, the first image has {} x {}; skipped", file.string(), image.bgr.cols,
                            image.bgr.rows, info_.width, info_.height));
  }
  return image.bgr;
}

Expected<std::unique_ptr<VideoReader>> Open(const fs::path& source, Sequence sequence, std::vector<fs::path> files,
                                            const VideoReaderOptions& options) {
  auto reader = std::make_unique<ImageSequenceReader>(sequence, std::move(files), options);
  VICTORIOUS_RETURN_IF_ERROR(reader->Start(source));
  return reader;
}

}  // namespace

Expected<std::vector<fs::path>> ListImages(const fs::path& folder) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<fs::path> files, ListFolder(folder));
  std::erase_if(files, [](const fs::path& path) {
    std::error_code unreadable;
    return !HasImageExtension(path) || !fs::is_regular_file(path, unreadable);
  });
  if (files.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: a folder without images (PNG, JPEG, TIFF, BMP or PNM)", folder.string()));
  }
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) {
    return NaturalLess(a.filename().native(), b.filename().native());
  });
  return files;
}

Expected<std::unique_ptr<VideoReader>> OpenImageFolder(const fs::path& folder, const VideoReaderOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<fs::path> files, ListImages(folder));
  return Open(folder, Sequence::kFolder, std::move(files), options);
}

Expected<std::unique_ptr<VideoReader>> OpenImage(const fs::path& file, const VideoReaderOptions& options) {
  return Open(file, Sequence::kSingleImage, {file}, options);
}

bool IsImageFile(const fs::path& file) {
  const std::string extension = LowerCase(file.extension().string());
  if (extension == ".mjpg" || extension == ".mjpeg") return false;  // Motion JPEG: a video
  std::array<char, 64> head{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), head.size());
  const auto size = static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0));
  return DetectImageFormat(std::as_bytes(std::span(head)).first(size)).has_value();
}

bool NaturalLess(std::string_view a, std::string_view b) {
  const std::string_view whole_a = a;
  const std::string_view whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (IsDigit(a.front()) && IsDigit(b.front())) {
      const std::string_view number_a = TakeDigits(a);
      const std::string_view number_b = TakeDigits(b);
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
    } else {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() != b.empty()) return a.empty();
  return whole_a < whole_b;  // equal except for leading zeros
}

}  // namespace victorious
