#include "victorious/input/video/frame_converter.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "victorious/input/image/image_file.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

namespace victorious {
namespace {

constexpr std::uint64_t kNoLumaPlane = AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM |
                                       AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_FLOAT | AV_PIX_FMT_FLAG_BAYER;

const AVPixFmtDescriptor* Descriptor(const AVFrame& frame) {
  return av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
}

bool IsGreyFormat(const AVPixFmtDescriptor& format) {
  return format.nb_components <= 2 && (format.flags & AV_PIX_FMT_FLAG_RGB) == 0;
}

bool HasForeignOrder(const AVPixFmtDescriptor& format) {
  return format.comp[0].depth > 8 &&
         ((format.flags & AV_PIX_FMT_FLAG_BE) != 0) != (std::endian::native == std::endian::big);
}

// True if the luma samples are contiguous in plane 0, with one byte each, or with two bytes in native byte order; those
// of grey formats in either order.
bool HasLumaPlane(const AVFrame& frame, const AVPixFmtDescriptor& format) {
  const AVComponentDescriptor& luma = format.comp[0];
  const int sample_bytes = luma.depth > 8 ? 2 : 1;
  const bool foreign_order = HasForeignOrder(format) && !IsGreyFormat(format);
  return (format.flags & kNoLumaPlane) == 0 && luma.plane == 0 && luma.offset == 0 && luma.step == sample_bytes &&
         !foreign_order && frame.linesize[0] > 0;
}

bool HasBt601Luma(const AVFrame& frame, const AVPixFmtDescriptor& format) {
  switch (frame.colorspace) {
    case AVCOL_SPC_UNSPECIFIED:
    case AVCOL_SPC_BT470BG:
    case AVCOL_SPC_SMPTE170M:
    case AVCOL_SPC_RESERVED:
      return true;
    default:
      return IsGreyFormat(format);  // without chroma, grey does not depend on the matrix
  }
}

bool IsFullRange(const AVFrame& frame, const AVPixFmtDescriptor& format) {
  if (frame.color_range != AVCOL_RANGE_UNSPECIFIED) return frame.color_range == AVCOL_RANGE_JPEG;
  switch (frame.format) {
    case AV_PIX_FMT_YUVJ420P:
    case AV_PIX_FMT_YUVJ422P:
    case AV_PIX_FMT_YUVJ444P:
    case AV_PIX_FMT_YUVJ440P:
    case AV_PIX_FMT_YUVJ411P:
      return true;
    default:
      return IsGreyFormat(format);
  }
}

// Converts range and depth and copies, in one pass.
cv::Mat GreyFromLuma(const AVFrame& frame, const AVPixFmtDescriptor& format, GreyRange& range) {
  const AVComponentDescriptor& luma = format.comp[0];
  const int type = luma.depth > 8 ? CV_16UC1 : CV_8UC1;
  cv::Mat plane(frame.height, frame.width, type, frame.data[0], static_cast<std::size_t>(frame.linesize[0]));
  if (HasForeignOrder(format)) {
    plane = plane.clone();
    plane.forEach<std::uint16_t>([](std::uint16_t& value, const int* /*at*/) { value = std::byteswap(value); });
  }
  // Stored value that corresponds to 1/255 of white; accounts for the depth and for zero bits below the sample.
  const double unit =
      std::ldexp(1.0, luma.shift) *
      (IsFullRange(frame, format) ? (std::ldexp(1.0, luma.depth) - 1) / 255 : std::ldexp(219.0 / 255, luma.depth - 8));
  const double black = IsFullRange(frame, format) ? 0 : std::ldexp(16.0, luma.depth - 8 + luma.shift);
  if (type == CV_16UC1 && IsGreyFormat(format) && IsFullRange(frame, format)) {
    return range.ToEightBits(plane, unit * 255);
  }
  cv::Mat grey;
  plane.convertTo(grey, CV_8U, 1 / unit, -black / unit);
  return grey;
}

}  // namespace

Expected<cv::Mat> FrameConverter::Convert(const AVFrame& frame) {
  try {
    return ConvertAndRotate(frame);
  } catch (const cv::Exception& exception) {  // out of memory
    return Fail(ErrorCode::kInternal, fmt::format("a frame cannot be converted ({})", exception.err));
  }
}

Expected<cv::Mat> FrameConverter::ConvertAndRotate(const AVFrame& frame) {
  VICTORIOUS_ASSIGN_OR_RETURN(cv::Mat image, ConvertColor(frame));
  if (image.size() != size_) {
    const bool shrinks = image.total() > static_cast<std::size_t>(size_.area());
    cv::Mat scaled;
    cv::resize(image, scaled, size_, 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
    image = scaled;
  }
  return RotateUpright(image, orientation_);
}

Expected<cv::Mat> FrameConverter::ConvertColor(const AVFrame& frame) {
  const AVPixFmtDescriptor* format = Descriptor(frame);
  if (format == nullptr || frame.width <= 0 || frame.height <= 0) {
    return Fail(ErrorCode::kUnsupported, "a frame without a pixel format");
  }
  const bool grey = color_ == FrameColor::kGrey;
  const bool luma = HasLumaPlane(frame, *format) && HasBt601Luma(frame, *format);
  if (luma && (grey || IsGreyFormat(*format))) {
    cv::Mat image = GreyFromLuma(frame, *format, range_);
    if (!grey) cv::cvtColor(image, image, cv::COLOR_GRAY2BGR);
    return image;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(cv::Mat bgr, ToBgr(frame));
  return grey ? GreyFromBgr(bgr) : bgr;
}

Expected<cv::Mat> FrameConverter::ToBgr(const AVFrame& frame) {
  const AVPixFmtDescriptor& format = *Descriptor(frame);
  scaler_.reset(sws_getCachedContext(scaler_.release(), frame.width, frame.height,
                                     static_cast<AVPixelFormat>(frame.format), frame.width, frame.height,
                                     AV_PIX_FMT_BGR24, SWS_BILINEAR, nullptr, nullptr, nullptr));
  if (!scaler_) return Fail(ErrorCode::kUnsupported, fmt::format("pixel format {}", format.name));
  constexpr int kOne = 1 << 16;  // 16.16 fixed point
  sws_setColorspaceDetails(scaler_.get(), sws_getCoefficients(frame.colorspace), IsFullRange(frame, format) ? 1 : 0,
                           sws_getCoefficients(SWS_CS_DEFAULT), 1, 0, kOne, kOne);
  // The scaler's SIMD code writes whole groups of pixels, so the rows are padded to a multiple of a group.
  constexpr int kGroup = 32;
  const int padded_width = (frame.width + kGroup - 1) / kGroup * kGroup;
  cv::Mat bgr;
  cv::Mat& target = padded_width == frame.width ? bgr : padded_;
  target.create(frame.height, padded_width, CV_8UC3);
  std::uint8_t* const planes[] = {target.data};
  const int strides[] = {static_cast<int>(target.step)};
  if (sws_scale(scaler_.get(), frame.data, frame.linesize, 0, frame.height, planes, strides) != frame.height) {
    return Fail(ErrorCode::kUnsupported, fmt::format("pixel format {}", format.name));
  }
  return padded_width == frame.width ? bgr : target.colRange(0, frame.width).clone();
}

}  // namespace victorious
