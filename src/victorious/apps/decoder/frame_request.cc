#include "victorious/apps/decoder/frame_request.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <span>

#include "victorious/base/check.h"
#include "victorious/base/packed_bytes.h"

namespace victorious {
namespace {

std::unexpected<Error> FailUnreadable() {
  return Fail(ErrorCode::kDataLoss, "damaged: its decoder gave an answer without a meaning");
}

struct GreyHead {
  std::int32_t width = 0;
  std::int32_t height = 0;
};

}  // namespace

std::string PackFrameRequest(const FrameRequest& request) {
  ByteWriter writer;
  writer.Put(request.task);
  writer.PutText(request.video);
  writer.Put(request.time_s);
  if (writer.PutHas(request.box)) {
    for (const double value : {request.box->x, request.box->y, request.box->width, request.box->height}) {
      writer.Put(value);
    }
  }
  writer.Put(request.width_px);
  writer.PutOptional(request.frames);
  return writer.TakeText();
}

FrameRequest UnpackFrameRequest(std::string_view bytes) {
  ByteReader reader(std::as_bytes(std::span(bytes)));
  FrameRequest request;
  request.task = reader.GetEnum(FrameTask::kGrey);
  request.video = reader.GetText();
  request.time_s = reader.Get<double>();
  if (reader.Get<bool>()) {
    Box& box = request.box.emplace();
    for (double* value : {&box.x, &box.y, &box.width, &box.height}) *value = reader.Get<double>();
  }
  request.width_px = reader.Get<int>();
  request.frames = reader.GetOptional<std::int64_t>();
  VICTORIOUS_CHECK(reader.IsAtEnd());
  return request;
}

std::string PackTimes(const std::vector<double>& times_s) {
  ByteWriter writer;
  writer.PutItems(std::span<const double>(times_s));
  return writer.TakeText();
}

Expected<std::vector<double>> UnpackTimes(std::string_view bytes) {
  ByteReader reader(std::as_bytes(std::span(bytes)));
  std::vector<double> times_s = reader.GetItems<double>();
  const bool is_sound = reader.IsAtEnd() && std::ranges::all_of(times_s, [](double t) { return std::isfinite(t); }) &&
                        (times_s.empty() || times_s.front() >= 0) &&
                        std::ranges::adjacent_find(times_s, std::greater_equal()) == times_s.end();
  if (!is_sound) return FailUnreadable();
  return times_s;
}

std::string PackGrey(const cv::Mat& grey) {
  VICTORIOUS_CHECK(grey.type() == CV_8UC1);
  const GreyHead head{.width = grey.cols, .height = grey.rows};
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof(head));
  bytes.reserve(sizeof(head) + grey.total());
  for (int row = 0; row < grey.rows; ++row) {
    bytes.append(reinterpret_cast<const char*>(grey.ptr(row)), static_cast<std::size_t>(grey.cols));
  }
  return bytes;
}

Expected<cv::Mat> UnpackGrey(std::string_view bytes) {
  GreyHead head;
  if (bytes.size() < sizeof(head)) return FailUnreadable();
  std::memcpy(&head, bytes.data(), sizeof(head));
  bytes.remove_prefix(sizeof(head));
  if (head.width < 1 || head.height < 1) return FailUnreadable();
  const std::uint64_t pixels = std::uint64_t(head.width) * std::uint64_t(head.height);
  if (pixels > kMaxServedPixels || pixels != bytes.size()) return FailUnreadable();
  cv::Mat grey(head.height, head.width, CV_8UC1);
  std::memcpy(grey.data, bytes.data(), bytes.size());
  return grey;
}

}  // namespace victorious
