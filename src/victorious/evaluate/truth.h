// Ground truth as files hold it: truth.jsonl, one line a frame and an object with a part in view.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// One object in one frame.
struct TruthRow {
  std::int64_t frame = 0;  ///< from 0
  std::string object;      ///< which one: "humvee-1"
  std::string model;       ///< of which kind: "humvee"
  Box box;                 ///< of the visible pixels, px
  double visible = 0;      ///< visible pixels over those it would have unhidden and uncropped
  std::optional<ViewAngles> view;
  double time_s = 0;                   ///< presentation time
  std::optional<GeodeticPoint> place;  ///< of the middle of the object's bounding box
  std::optional<double> heading_rad;   ///< of its front, clockwise from north
};

/// Rows in the order of the text's lines; empty lines are passed over, and keys that scoring does not need are ignored.
/// Any bytes are safe. Errors: kInvalidArgument, with `name`, the line, and what is missing or wrong there.
Expected<std::vector<TruthRow>> ParseTruth(std::string_view text, std::string_view name);

/// The same from a file.
Expected<std::vector<TruthRow>> ReadTruth(const std::filesystem::path& path);

}  // namespace victorious
