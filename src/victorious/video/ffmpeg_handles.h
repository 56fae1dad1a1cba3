// Private to video/: FFmpeg's objects, each freed by the handle that owns it, and what has to be said to FFmpeg once.
#pragma once

#include <memory>
#include <string>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

namespace victorious {

struct FfmpegDeleter {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(SwsContext* context) const { sws_freeContext(context); }
};

using CodecHandle = std::unique_ptr<AVCodecContext, FfmpegDeleter>;
using FrameHandle = std::unique_ptr<AVFrame, FfmpegDeleter>;
using PacketHandle = std::unique_ptr<AVPacket, FfmpegDeleter>;
using ScalerHandle = std::unique_ptr<SwsContext, FfmpegDeleter>;

/// The largest picture a video may have: 8192 x 4096, above 8K. It bounds what a hostile file can make us allocate.
inline constexpr int kMaxFramePixels = 1 << 25;

/// Silences FFmpeg's log (stderr is the program's own) and bounds its single allocations. Cheap; call it before any
/// use.
void PrepareFfmpeg();

/// FFmpeg's words for one of its negative results.
std::string FfmpegErrorText(int result);

}  // namespace victorious
