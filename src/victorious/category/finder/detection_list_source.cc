#include "victorious/category/finder/detection_list_source.h"

#include <utility>

#include <fmt/format.h>

#include "victorious/base/one_line.h"
#include "victorious/category/network/detector_file.h"
#include "victorious/types/index_records.h"

namespace victorious {

DetectionListSource::DetectionListSource(DetectionList list)
    : list_(std::move(list)), content_id_(fmt::format("{}{}", kListedContentId, list_.detector)) {
  for (const std::string& name : list_.classes) names_.push_back(fmt::format("{}/{}", list_.detector, name));
}

Expected<DetectionListSource> DetectionListSource::Create(DetectionList list) {
  if (const Status named = CheckClassName(list.detector); !named || list.detector.contains('/')) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: no name of a detector: give --detector NAME, of 1 to 100 bytes without / and control "
                            "characters",
                            OneLine(list.detector)));
  }
  for (const std::string& name : list.classes) {
    const Status named = CheckClassName(name);
    if (!named) return Fail(named.error().code, fmt::format("{}: {}", OneLine(name), named.error().message));
  }
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
