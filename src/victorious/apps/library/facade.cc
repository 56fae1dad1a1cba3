#include "victorious/apps/library/facade.h"

#include <cstddef>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/version.h"
#include "victorious/input/image/image_file.h"
#include "victorious/version.h"

namespace libvictorious {

static_assert(static_cast<int>(ErrorCode::kInvalidArgument) ==
              static_cast<int>(victorious::ErrorCode::kInvalidArgument));
static_assert(static_cast<int>(ErrorCode::kUnavailable) == static_cast<int>(victorious::ErrorCode::kUnavailable));
static_assert(static_cast<std::size_t>(ErrorCode::kUnavailable) + 1 == victorious::kErrorCodeTexts.size());

std::string Version() { return victorious::kVersion; }

Error::Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
Error::Error(const Error& other) = default;
Error& Error::operator=(const Error& other) = default;
Error::~Error() = default;

const char* Name(ErrorCode code) noexcept {
  for (const auto& [one, text] : victorious::kErrorCodeTexts) {
    if (static_cast<int>(one) == static_cast<int>(code)) return text.data();
  }
  return "";
}

void Raise(const victorious::Error& error) { throw Error(static_cast<ErrorCode>(error.code), error.message); }

LongWork::LongWork(const ProgressCallback& progress)
    : progress_(progress), capture_([this](const victorious::ProgressEvent& event) { Report(event); }) {}

void LongWork::Report(const victorious::ProgressEvent& event) {
  if (!progress_) return;
  const bool goes_on = caller_.Run([&] {
    return progress_({.label = event.label,
                      .done = event.done,
                      .total = event.total,
                      .unit = event.unit,
                      .elapsed_s = event.elapsed_s});
  });
  if (!goes_on) cancel_.Cancel();
}

std::vector<victorious::ObjectModel> ObjectModelsOf(const std::vector<Model>& models) {
  std::vector<victorious::ObjectModel> inner;
  for (const Model& model : models) inner.push_back(model.impl().model);
  return inner;
}

victorious::Expected<cv::Mat> MatOf(const ImageView& view) {
  constexpr int kMaxSide_px = 32767;
  const int bytes = BytesPerPixel(view.format);
  const bool has_size = view.width > 0 && view.height > 0 && view.width <= kMaxSide_px && view.height <= kMaxSide_px;
  if (view.pixels == nullptr || bytes == 0 || !has_size ||
      view.stride_bytes < static_cast<std::ptrdiff_t>(view.width) * bytes) {
    return victorious::Fail(victorious::ErrorCode::kInvalidArgument,
                            fmt::format("image of {} x {} px, {} bytes a pixel, {} bytes a row: give pixels, a known "
                                        "format, sides of 1 to {} px, and rows that do not overlap",
                                        view.width, view.height, bytes, view.stride_bytes, kMaxSide_px));
  }
  // cv::Mat has no constant form: what gets it only reads.
  return cv::Mat(view.height, view.width, CV_8UC(bytes), const_cast<std::uint8_t*>(view.pixels),
                 static_cast<std::size_t>(view.stride_bytes));
}

victorious::Expected<cv::Mat> BgrOf(const ImageView& view) {
  VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat mat, MatOf(view));
  cv::Mat bgr;
  switch (view.format) {
    case PixelFormat::kBgr:
      return mat;
    case PixelFormat::kGrey:
      cv::cvtColor(mat, bgr, cv::COLOR_GRAY2BGR);
      break;
    case PixelFormat::kRgb:
      cv::cvtColor(mat, bgr, cv::COLOR_RGB2BGR);
      break;
    case PixelFormat::kBgra:
      cv::cvtColor(mat, bgr, cv::COLOR_BGRA2BGR);
      break;
    case PixelFormat::kRgba:
      cv::cvtColor(mat, bgr, cv::COLOR_RGBA2BGR);
      break;
  }
  return bgr;
}

victorious::Expected<cv::Mat> GreyOf(const ImageView& view) {
  if (view.format == PixelFormat::kGrey) return MatOf(view);
  VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat bgr, BgrOf(view));
  return victorious::GreyFromBgr(bgr);
}

ImageView ViewOf(const cv::Mat& mat) {
  return {mat.data, mat.cols, mat.rows, static_cast<std::ptrdiff_t>(mat.step),
          mat.channels() == 1 ? PixelFormat::kGrey : PixelFormat::kBgr};
}

std::vector<Point> PointsOf(const victorious::Polygon& polygon) {
  std::vector<Point> points;
  points.reserve(polygon.size());
  for (const Eigen::Vector2d& corner : polygon) points.push_back({corner.x(), corner.y()});
  return points;
}

}  // namespace libvictorious
