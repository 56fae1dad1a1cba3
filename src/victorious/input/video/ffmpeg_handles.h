// Private to video/: owning handles for FFmpeg objects, and the process-wide set-up of FFmpeg.
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

/// Maximum number of pixels of a video frame: 8192 x 4096, above 8K. Bounds the memory that a hostile file can request.
inline constexpr int kMaxFramePixels = 1 << 25;

/// Disables FFmpeg's log (stderr is reserved for the program), limits its single allocations, and makes it verify the
/// certificates of servers. Idempotent and cheap; call it before any use of FFmpeg.
void PrepareFfmpeg();

/// Returns FFmpeg's message for a negative result code.
std::string FfmpegErrorText(int result);

}  // namespace victorious
