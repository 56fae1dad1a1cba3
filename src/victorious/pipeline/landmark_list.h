// Landmarks from an index, whose objects of known place they are, or from a list in the format `objects`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/navigate/landmark.h"

namespace victorious {

struct LandmarkListOptions {
  double heading_deg = 2;
  double common_share = 1;
  double most_speed_m_s = 0.2;

  void ListFields(FieldList& fields);
};

struct LandmarkList {
  std::vector<Landmark> landmarks;
  /// Of the error that all places have in common: of the best of them, so far as errors are common.
  Eigen::Matrix3d common_covariance_enu_m2 = Eigen::Matrix3d::Zero();
  std::vector<std::string> warnings;  ///< what was left out, a line each; of many the first, and how many more
};

/// A list, a JSON object a line (docs/formats/navigate.md). Lines that cannot be used are left out and told.
/// Errors: kInvalidArgument where no line can be used.
Expected<LandmarkList> ParseLandmarks(std::string_view text, const LandmarkListOptions& options);

/// An index, or a list.
/// Errors: those of reading; kInvalidArgument where no object has a place and stands still.
Expected<LandmarkList> ReadLandmarks(const std::string& path, const LandmarkListOptions& options);

}  // namespace victorious
