// features/, in: a grey image. Out: its keypoints and descriptors. One interface for all engines; models and indexes
// store the engine's name, because descriptors of different engines are not comparable.
// Source: D. Lowe, "Distinctive image features from scale-invariant keypoints", IJCV 60(2), 2004.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/types/feature_set.h"

namespace victorious {

struct FeatureOptions {
  std::string engine = "opencv";
  int octave_layers = 3;
  double contrast_threshold = 0.04;
  double edge_threshold = 10.0;
  double sigma_px = 1.6;
  int max_features = 0;
  int max_side_px = 2048;
  double impulse_fraction = 0.015;

  void ListFields(FieldList& fields);
};

/// Options for objects of little texture and the scenes to search for them: a lower contrast threshold (0.015) and a
/// higher edge threshold (20) than Lowe's. About twice as many keypoints as by default.
FeatureOptions LowContrastFeatureOptions();

/// The engines of this build, by name.
std::vector<std::string> FeatureEngines();

/// Extracts features. Thread-safe.
class FeatureExtractor {
 public:
  virtual ~FeatureExtractor() = default;

  /// @param grey  CV_8UC1
  /// @return keypoints in pixels of `grey`, in deterministic order; empty if the image is too small for a keypoint.
  /// Errors: kInternal for an exception of OpenCV.
  virtual Expected<FeatureSet> Extract(const cv::Mat& grey) const = 0;
};

/// Errors: kInvalidArgument for options out of range or an engine that is not in this build.
Expected<std::unique_ptr<const FeatureExtractor>> MakeFeatureExtractor(const FeatureOptions& options);

}  // namespace victorious
