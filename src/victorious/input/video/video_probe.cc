#include "victorious/input/video/video_probe.h"

#include <cstddef>
#include <fstream>
#include <span>
#include <vector>

#include "victorious/input/image/image_header.h"
#include "victorious/input/video/demuxer.h"

extern "C" {
#include <libavutil/avstring.h>
}

namespace victorious {

bool BeginsAsVideo(const std::filesystem::path& file) {
  constexpr std::size_t kMaxBytes = std::size_t{1} << 20;  // as many as FFmpeg looks at
  PrepareFfmpeg();
  std::vector<unsigned char> bytes(kMaxBytes + AVPROBE_PADDING_SIZE);
  std::ifstream stream(file, std::ios::binary);
  stream.read(reinterpret_cast<char*>(bytes.data()), kMaxBytes);
  const auto size = static_cast<std::size_t>(stream.gcount());
  bytes.resize(size + AVPROBE_PADDING_SIZE);  // the padding is zero: what was not read was never written
  if (size == 0) return false;
  if (DetectImageFormat(std::as_bytes(std::span(bytes)).first(size))) return true;
  const AVProbeData probe{
      .filename = "", .buf = bytes.data(), .buf_size = static_cast<int>(size), .mime_type = nullptr};
  int score = 0;
  const AVInputFormat* const format = av_probe_input_format3(&probe, /*is_opened=*/1, &score);
  return format != nullptr && av_match_list(format->name, VideoFileFormats(), ',') != 0;
}

}  // namespace victorious
