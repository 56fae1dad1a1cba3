// features/, in: a grey image. Out: its keypoints and descriptors. One interface for every engine; the engine's name
// travels with what it made, because descriptors of two engines are not comparable.
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
  double impulse_share = 0.015;

  void ListFields(FieldList& fields);
};

/// For objects of little texture, and the scenes that they are sought in: keypoints of less contrast than Lowe's, and
/// more of those on edges. Twice as many as by default.
FeatureOptions FaintFeatures();

/// The engines of this build, by name.
std::vector<std::string> FeatureEngines();

/// Thread-safe: one extractor serves any number of threads.
class FeatureExtractor {
 public:
  virtual ~FeatureExtractor() = default;

  /// @param grey  CV_8UC1. Images too small to hold a keypoint give none.
  /// Keypoints are in pixels of `grey`, in an order that depends on the image alone.
  virtual Expected<FeatureSet> Extract(const cv::Mat& grey) const = 0;
};

/// Errors: kInvalidArgument for options out of range or an engine that this build lacks.
Expected<std::unique_ptr<const FeatureExtractor>> MakeFeatureExtractor(const FeatureOptions& options);

}  // namespace victorious
