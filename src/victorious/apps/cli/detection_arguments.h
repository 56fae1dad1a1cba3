// The arguments of `index` for what another program found (category/finder/detection_list.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "victorious/apps/cli/arguments.h"
#include "victorious/base/error.h"
#include "victorious/category/finder/detection_list.h"
#include "victorious/store/index_store.h"

namespace victorious::cli {

struct DetectionArguments {
  std::string file;  ///< empty: none are given
  std::string detector;
  std::string classes;
  std::optional<std::int64_t> first_frame;
};

/// Adds --detections, --detector, --classes and --first-frame.
void AddDetections(ArgumentParser& parser, DetectionArguments& arguments);

/// Error: kInvalidArgument if --detector, --classes or --first-frame is given without --detections.
[[nodiscard]] Status CheckDetections(const DetectionArguments& arguments);

/// Errors: those of ReadDetectionList and ParseClassList.
[[nodiscard]] Expected<DetectionList> ReadDetections(const DetectionArguments& arguments, const std::string& video);

/// Warns where a list ends later than its video: it may be that of another one. @param last  frame of the list
[[nodiscard]] Status WarnOfLaterDetections(const std::string& video, std::int64_t last, IndexStore& store);

}  // namespace victorious::cli
