#include "victorious/object/model/view_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

// Stored in model files as is: never reorder.
struct SurfaceHeader {
  double fx, cx, cy;             // px; fy is fx
  double qw, qx, qy, qz;         // camera_from_model
  double tx, ty, tz;             // m
  double nearest_m, farthest_m;  // depths of the codes 1 and 65535
  std::int32_t width, height;    // px, of the rendering
  std::int32_t left, top;        // px, position of the stored crop in it
  std::int32_t background;       // grey level outside the crop
  std::int32_t reserved;         // 0
};
static_assert(sizeof(SurfaceHeader) == 120);

constexpr int kMaxSidePx = 4096;
constexpr int kPartBorderPx = 2;   // of a SurfacePart: one pixel at half resolution
constexpr double kDepths = 65534;  // quantisation steps between nearest_m and farthest_m

bool IsValid(const SurfaceHeader& header, const cv::Mat& image) {
  const double numbers[] = {header.fx, header.cx, header.cy, header.qw, header.qx,        header.qy,
                            header.qz, header.tx, header.ty, header.tz, header.nearest_m, header.farthest_m};
  if (!std::ranges::all_of(numbers, [](double number) { return std::isfinite(number) && std::abs(number) < 1e9; })) {
    return false;
  }
  const double norm = std::hypot(std::hypot(header.qw, header.qx), std::hypot(header.qy, header.qz));
  return header.fx > 0 && std::abs(norm - 1) < 1e-6 && header.nearest_m > 0 && header.farthest_m >= header.nearest_m &&
         header.width > 0 && header.height > 0 && header.width <= kMaxSidePx && header.height <= kMaxSidePx &&
         header.left >= 0 && header.top >= 0 && header.left <= header.width - image.cols &&
         header.top <= header.height - image.rows && header.background >= 0 && header.background <= 255;
}

// The bytes of a surface, decoded. The image has the channels grey level, high and low byte of the depth's code.
struct StoredSurface {
  SurfaceHeader header;
  cv::Mat image;
};

Expected<StoredSurface> ReadStored(std::span<const std::byte> bytes, const std::string& name) {
  const auto damaged = [&] {
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: damaged: make the model again", name));
  };
  SurfaceHeader header;
  if (bytes.size() < sizeof(header)) return damaged();
  std::memcpy(&header, bytes.data(), sizeof(header));
  const Expected<Image> image = DecodeImage(bytes.subspan(sizeof(header)), name);
  if (!image || !IsValid(header, image->bgr)) return damaged();
  return StoredSurface{header, image->bgr};
}

// A part of the rendering, px of the rendering, before depths are decoded.
struct StoredPart {
  cv::Mat grey;         // CV_8UC1
  cv::Mat depth_codes;  // CV_16UC1; 0: none
};

// @param part  contains the stored image
StoredPart CutPart(const StoredSurface& stored, const cv::Rect& part) {
  StoredPart cut{cv::Mat(part.size(), CV_8UC1, cv::Scalar(stored.header.background)),
                 cv::Mat(part.size(), CV_16UC1, cv::Scalar(0))};
  const cv::Point at(stored.header.left - part.x, stored.header.top - part.y);
  for (int row = 0; row < stored.image.rows; ++row) {
    const auto* const pixels = stored.image.ptr<cv::Vec3b>(row);
    std::uint8_t* const grey = cut.grey.ptr<std::uint8_t>(at.y + row) + at.x;
    std::uint16_t* const codes = cut.depth_codes.ptr<std::uint16_t>(at.y + row) + at.x;
    for (int column = 0; column < stored.image.cols; ++column) {
      grey[column] = pixels[column][0];
      codes[column] = static_cast<std::uint16_t>(pixels[column][1] << 8 | pixels[column][2]);
    }
  }
  return cut;
}

double MetresPerStep(const SurfaceHeader& header) { return (header.farthest_m - header.nearest_m) / kDepths; }

// CV_32FC1, m; NaN for code 0.
cv::Mat DepthsOf(const cv::Mat& codes, double nearest_m, double m_per_step) {
  cv::Mat depth_m(codes.size(), CV_32FC1);
  for (int row = 0; row < codes.rows; ++row) {
    const auto* const in = codes.ptr<std::uint16_t>(row);
    auto* const out = depth_m.ptr<float>(row);
    for (int column = 0; column < codes.cols; ++column) {
      out[column] = in[column] == 0 ? std::numeric_limits<float>::quiet_NaN()
                                    : static_cast<float>(nearest_m + (in[column] - 1) * m_per_step);
    }
  }
  return depth_m;
}

PosedCamera CameraOf(const SurfaceHeader& header, const cv::Rect& part) {
  return {.pinhole = {.fx = header.fx,
                      .fy = header.fx,
                      .cx = header.cx - part.x,
                      .cy = header.cy - part.y,
                      .width = part.width,
                      .height = part.height},
          .camera_from_world = {Eigen::Quaterniond(header.qw, header.qx, header.qy, header.qz).normalized(),
                                {header.tx, header.ty, header.tz}}};
}

// The surface of a part of the rendering that contains the stored image. @param part  px of the rendering
ViewSurface Unpack(const StoredSurface& stored, const cv::Rect& part) {
  StoredPart cut = CutPart(stored, part);
  return {.grey = std::move(cut.grey),
          .depth_map = {.camera = CameraOf(stored.header, part),
                        .depth_m = DepthsOf(cut.depth_codes, stored.header.nearest_m, MetresPerStep(stored.header))}};
}

int RoundDownToEven(int value) { return value & ~1; }

// The stored image with a border of background; even, so that half of it has whole pixels.
cv::Rect ObjectPart(const StoredSurface& stored) {
  const SurfaceHeader& header = stored.header;
  const cv::Point first(RoundDownToEven(header.left - kPartBorderPx), RoundDownToEven(header.top - kPartBorderPx));
  const cv::Point end(RoundDownToEven(header.left + stored.image.cols + kPartBorderPx + 1),
                      RoundDownToEven(header.top + stored.image.rows + kPartBorderPx + 1));
  return {first, end};
}

}  // namespace

Expected<std::vector<std::byte>> EncodeSurface(const ViewSurface& surface) {
  const PosedCamera& camera = surface.depth_map.camera;
  const cv::Mat depth_map = surface.depth_map.depth_m == surface.depth_map.depth_m;  // not NaN
  const cv::Rect box = cv::boundingRect(depth_map);
  double nearest_m = 1;
  double farthest_m = 1;
  if (!box.empty()) cv::minMaxLoc(surface.depth_map.depth_m, &nearest_m, &farthest_m, nullptr, nullptr, depth_map);
  const Eigen::Quaterniond& turn = camera.camera_from_world.rotation;
  const Eigen::Vector3d& shift = camera.camera_from_world.translation;
  const SurfaceHeader header{.fx = camera.pinhole.fx,
                             .cx = camera.pinhole.cx,
                             .cy = camera.pinhole.cy,
                             .qw = turn.w(),
                             .qx = turn.x(),
                             .qy = turn.y(),
                             .qz = turn.z(),
                             .tx = shift.x(),
                             .ty = shift.y(),
                             .tz = shift.z(),
                             .nearest_m = nearest_m,
                             .farthest_m = farthest_m,
                             .width = surface.grey.cols,
                             .height = surface.grey.rows,
                             .left = box.x,
                             .top = box.y,
                             .background = surface.grey.at<std::uint8_t>(0, 0),
                             .reserved = 0};
  cv::Mat image(std::max(1, box.height), std::max(1, box.width), CV_8UC3, cv::Scalar::all(0));
  const double steps_per_m = farthest_m > nearest_m ? kDepths / (farthest_m - nearest_m) : 0;
  for (int row = 0; row < box.height; ++row) {
    for (int column = 0; column < box.width; ++column) {
      const float depth_m = surface.depth_map.depth_m.at<float>(box.y + row, box.x + column);
      const int depth =
          std::isnan(depth_m) ? 0 : 1 + static_cast<int>(std::lround((depth_m - nearest_m) * steps_per_m));
      image.at<cv::Vec3b>(row, column) = {surface.grey.at<std::uint8_t>(box.y + row, box.x + column),
                                          static_cast<std::uint8_t>(depth >> 8),
                                          static_cast<std::uint8_t>(depth & 0xFF)};
    }
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::byte> png, EncodePng(image));
  std::vector<std::byte> bytes(sizeof(header) + png.size());
  std::memcpy(bytes.data(), &header, sizeof(header));
  std::ranges::copy(png, bytes.begin() + sizeof(header));
  return bytes;
}

Expected<ViewSurface> DecodeSurface(std::span<const std::byte> bytes, const std::string& name) {
  VICTORIOUS_ASSIGN_OR_RETURN(const StoredSurface stored, ReadStored(bytes, name));
  return Unpack(stored, {0, 0, stored.header.width, stored.header.height});
}

Expected<SurfacePart> DecodeSurfacePart(std::span<const std::byte> bytes, const std::string& name) {
  VICTORIOUS_ASSIGN_OR_RETURN(const StoredSurface stored, ReadStored(bytes, name));
  const cv::Rect part = ObjectPart(stored);
  return SurfacePart{.surface = Unpack(stored, part),
                     .origin = part.tl(),
                     .rendering_px = {stored.header.width, stored.header.height}};
}

Expected<HalfSurfacePart> DecodeHalfSurfacePart(std::span<const std::byte> bytes, const std::string& name) {
  VICTORIOUS_ASSIGN_OR_RETURN(const StoredSurface stored, ReadStored(bytes, name));
  const cv::Rect part = ObjectPart(stored);
  const StoredPart cut = CutPart(stored, part);
  const cv::Size size = part.size() / 2;
  HalfSurfacePart half{.grey = {},
                       .depth_codes = {},
                       .camera = CameraOf(stored.header, part),
                       .nearest_m = stored.header.nearest_m,
                       .m_per_step = MetresPerStep(stored.header),
                       .origin = part.tl() / 2,
                       .rendering_px = {stored.header.width, stored.header.height}};
  cv::resize(cut.grey, half.grey, size, 0, 0, cv::INTER_AREA);
  cv::resize(cut.depth_codes, half.depth_codes, size, 0, 0, cv::INTER_NEAREST);
  PinholeCamera& pinhole = half.camera.pinhole;
  pinhole.fx /= 2;
  pinhole.fy /= 2;
  pinhole.cx /= 2;
  pinhole.cy /= 2;
  pinhole.width = size.width;
  pinhole.height = size.height;
  return half;
}

ViewSurface HalfSurfacePart::Surface() const {
  return {.grey = grey, .depth_map = {.camera = camera, .depth_m = DepthsOf(depth_codes, nearest_m, m_per_step)}};
}

}  // namespace victorious
