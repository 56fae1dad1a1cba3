#include "victorious/category/finder/detector_source.h"

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/count_text.h"
#include "victorious/base/file.h"
#include "victorious/category/network/detector_file.h"

namespace victorious {

Expected<DetectorSource> DetectorSource::Create(DetectorModel model, const CategoryFindOptions& options,
                                                const DetectorOptions& detector) {
  std::string content_id = fmt::format("{:016x}", Checksum(EncodeDetector(model)));
  VICTORIOUS_ASSIGN_OR_RETURN(NetworkDetector network, NetworkDetector::Create(std::move(model), detector));
  DetectorSource source(std::move(network));
  source.content_id_ = std::move(content_id);
  for (const std::string& name : source.detector_.model().classes) source.reported_.Add(name, options);
  if (!source.names().empty()) return source;
  return Fail(ErrorCode::kInvalidArgument, fmt::format("categories: all classes of {} are background ({})",
                                                       source.detector_.model().source, options.background));
}

std::string DetectorSource::DescribeSearch(cv::Size frame) const {
  const DetectorSettings& settings = detector_.model().settings;
  return fmt::format("{} searches a frame by {} of {} x {} px", detector_.model().source,
                     CountText(detector_.RunsOf(frame), "image"), settings.width, settings.height);
}

Expected<std::vector<FoundCategory>> DetectorSource::FindIn(const Frame& frame) const {
  const cv::Mat& bgr = frame.bgr.empty() && frame.image.channels() == 3 ? frame.image : frame.bgr;
  if (bgr.empty()) return Fail(ErrorCode::kInternal, "a detector needs frames in colour");
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<NetworkBox> boxes, detector_.Detect(bgr));
  std::vector<FoundCategory> found;
  for (const NetworkBox& one : boxes) {
    const std::optional<std::size_t> category = reported_.Of(one.category);
    if (category) found.push_back({.category = *category, .box = one.box, .probability = one.score});
  }
  return found;
}

}  // namespace victorious
