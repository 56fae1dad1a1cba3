#include "victorious/input/video/ffmpeg_handles.h"

#include <array>
#include <cstddef>

#include "victorious/input/video/tls_verification.h"

extern "C" {
#include <libavutil/error.h>
#include <libavutil/log.h>
#include <libavutil/mem.h>
}

namespace victorious {
namespace {

constexpr std::size_t kMaxAllocationBytes = std::size_t{1} << 28;  // > a 16-bit plane of kMaxFramePixels

}  // namespace

void PrepareFfmpeg() {
  static const bool prepared = [] {
    av_log_set_callback(&KeepTlsFault);
    av_max_alloc(kMaxAllocationBytes);
    avformat_network_init();
    VerifyCertificates();  // what cannot be verified is not opened (CheckVerifies)
    return true;
  }();
  static_cast<void>(prepared);
}

std::string FfmpegErrorText(int result) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(result, text.data(), text.size());
  return text.data();
}

}  // namespace victorious
