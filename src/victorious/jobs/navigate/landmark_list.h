// Reads landmarks: objects of known place from an index, or a list in the export format `objects`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/place/navigate/landmark.h"

namespace victorious {

struct LandmarkListOptions {
  double heading_deg = 2;      ///< standard deviation of a heading for which the list gives none
  double common_fraction = 1;  ///< sigma of the error common to all places, over that of the best place
  double max_speed_m_s = 0.2;  ///< faster objects are not landmarks

  void ListFields(FieldList& fields);
};

struct LandmarkList {
  std::vector<Landmark> landmarks;
  /// Covariance of the error common to all landmarks: (common_fraction)^2 times the covariance of the best-located one.
  Eigen::Matrix3d common_covariance_enu_m2 = Eigen::Matrix3d::Zero();
  std::vector<std::string> warnings;  ///< skipped entries, one line each: the first 20, then the number of the others
};

/// Parses a list with one JSON object per line (docs/formats/navigate.md). Skips lines that cannot be used, with a
/// warning.
/// Errors: kInvalidArgument if no line can be used.
[[nodiscard]] Expected<LandmarkList> ParseLandmarks(std::string_view text, const LandmarkListOptions& options);

/// Reads an index or a list.
/// Errors: those of reading; kInvalidArgument if the index holds no static object with a place, or the list no usable
/// line.
[[nodiscard]] Expected<LandmarkList> ReadLandmarks(const std::string& path, const LandmarkListOptions& options);

}  // namespace victorious
