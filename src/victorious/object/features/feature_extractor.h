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
#include "victorious/input/image/impulse_noise.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Layers per octave, and blur of the first layer of each octave, px (Lowe 2004).
inline constexpr int kOctaveLayers = 3;
inline constexpr double kFirstLayerSigma_px = 1.6;

struct FeatureOptions {
  std::string engine = "sift";
  double contrast_threshold = 0.04;
  double edge_threshold = 10.0;
  int max_side_px = 2048;
  double impulse_fraction = kDefaultImpulseFraction;
  /// Maximum number of keypoints, of the highest contrast; 0 keeps all. Not a user parameter: the search by an image
  /// and the benchmarks bound it.
  int max_features = 0;

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
  [[nodiscard]] virtual Expected<FeatureSet> Extract(const cv::Mat& grey) const = 0;
};

/// Errors: kInvalidArgument for options out of range or an engine that is not in this build.
[[nodiscard]] Expected<std::unique_ptr<const FeatureExtractor>> MakeFeatureExtractor(const FeatureOptions& options);

}  // namespace victorious
