// Reader of ground truth files: truth.jsonl, one JSON object per line, for each frame and each object partly in view.
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
  std::string object;      ///< name of the instance: "humvee-1"
  std::string model;       ///< name of its model: "humvee"
  Box box;                 ///< bounding box of the visible pixels, px
  double visible = 0;      ///< visible pixels over its pixels without occlusion and cropping
  std::optional<ViewDirection> view;
  double time_s = 0;                   ///< presentation time
  std::optional<GeodeticPoint> place;  ///< of the centre of the object's bounding box
  std::optional<double> heading_rad;   ///< of its front, clockwise from north
};

/// Returns the rows in the order of the lines. Empty lines are skipped; keys that scoring does not need are ignored.
/// Any bytes are safe.
/// @param name  of the source, for messages
/// Errors: kInvalidArgument, with `name`, the line number, and the missing or wrong key.
[[nodiscard]] Expected<std::vector<TruthRow>> ParseTruth(std::string_view text, std::string_view name);

/// Reads and parses a file. Errors: those of ReadFile and of ParseTruth.
[[nodiscard]] Expected<std::vector<TruthRow>> ReadTruth(const std::filesystem::path& path);

}  // namespace victorious
