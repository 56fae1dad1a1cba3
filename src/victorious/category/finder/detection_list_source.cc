#include "victorious/category/finder/detection_list_source.h"

#include <utility>

#include <fmt/format.h>

#include "victorious/types/index_records.h"

namespace victorious {

DetectionListSource::DetectionListSource(DetectionList list)
    : list_(std::move(list)), content_id_(fmt::format("{}{}", kListedContentId, list_.detector)) {
  for (const std::string& name : list_.classes) names_.push_back(fmt::format("{}/{}", list_.detector, name));
}

Expected<DetectionListSource> DetectionListSource::Create(DetectionList list) {
  if (list.detector == kBoxedContentId) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: names what people box: give the detector another name", list.detector));
  }
  return DetectionListSource(std::move(list));
}

Expected<std::vector<FoundCategory>> DetectionListSource::FindIn(const Frame& frame) const {
  std::vector<FoundCategory> found;
  const auto listed = list_.frames.find(frame.index);
  if (listed == list_.frames.end()) return found;
  const cv::Size size = frame.image.size();
  const double x_px = list_.is_relative ? size.width : 1;
  const double y_px = list_.is_relative ? size.height : 1;
  for (const ListedBox& one : listed->second) {
    const Box whole{one.box.x * x_px, one.box.y * y_px, one.box.width * x_px, one.box.height * y_px};
    const Box inside = Intersection(whole, FrameBox(size.width, size.height));
    if (inside.IsEmpty()) continue;
    found.push_back({.category = one.category, .box = inside, .probability = one.score, .track = one.track});
  }
  return found;
}

}  // namespace victorious
