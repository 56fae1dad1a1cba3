// Private to video/: writes packets into a file as they are, without encoding them. The file gets its name once it is
// complete.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <utility>

#include "victorious/base/error.h"
#include "victorious/input/video/ffmpeg_handles.h"

namespace victorious {

/// When packets reach the file.
enum class PacketFlush {
  kBuffered,  ///< a file that is not completed is removed
  kAtOnce,    ///< each when it is written; a file that is not completed stays with all of them
};

class PacketFile {
 public:
  /// @param path       the name of the complete file, in messages, too
  /// @param temporary  its name until then
  PacketFile(std::filesystem::path path, std::filesystem::path temporary)
      : path_(std::move(path)), temporary_(std::move(temporary)) {}
  ~PacketFile();
  PacketFile(const PacketFile&) = delete;
  PacketFile& operator=(const PacketFile&) = delete;

  /// Creates the file, with a stream for each of `sources`, in their order.
  /// @param muxer  FFmpeg's name
  [[nodiscard]] Status Open(const char* muxer, std::span<const AVStream* const> sources, PacketFlush flush);

  /// @param time_base  of the packet's stamps, whose times of decoding increase in a stream
  [[nodiscard]] Status Write(AVPacket& packet, int stream, AVRational time_base);

  /// Gives the file other names.
  [[nodiscard]] Status Rename(std::filesystem::path path, std::filesystem::path temporary);

  /// Syncs the file to the disk, and renames it.
  [[nodiscard]] Status Finish();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  [[nodiscard]] Status Check(int result, std::string_view verb) const;

  std::filesystem::path path_;
  std::filesystem::path temporary_;
  PacketFlush flush_ = PacketFlush::kBuffered;
  AVFormatContext* container_ = nullptr;
};

}  // namespace victorious
