#include "victorious/input/video/codecs.h"

#include <array>

#include <fmt/format.h>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace victorious {
namespace {

std::string VersionText(unsigned version) {
  return fmt::format("{}.{}.{}", AV_VERSION_MAJOR(version), AV_VERSION_MINOR(version), AV_VERSION_MICRO(version));
}

}  // namespace

CodecReport DescribeCodecs() {
  constexpr std::array kCommonCodecs = {"h264",       "hevc",  "av1",   "vp8", "vp9",     "mpeg1video",
                                        "mpeg2video", "mpeg4", "mjpeg", "png", "rawvideo"};
  CodecReport report;
  report.libraries =
      fmt::format("libavformat {}, libavcodec {}", VersionText(avformat_version()), VersionText(avcodec_version()));
  for (const char* name : kCommonCodecs) {
    const AVCodecDescriptor* descriptor = avcodec_descriptor_get_by_name(name);
    const bool is_available = descriptor != nullptr && avcodec_find_decoder(descriptor->id) != nullptr;
    (is_available ? report.decoders : report.missing).emplace_back(name);
  }
  report.h264_encoder = avcodec_find_encoder_by_name("libx264") != nullptr;
  return report;
}

}  // namespace victorious
