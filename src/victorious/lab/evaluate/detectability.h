// Detectability of a model before there is a video (`model show --findable`).
//
// Method: a Monte Carlo test. The object is rendered from random directions between the model's views (warped_view.h),
// at a given size, light and noise, and pasted onto synthetic clutter (drawn_clutter.h). The recogniser searches each
// image as it searches a frame. The fraction of detections estimates the recall of a flight; it is an upper limit,
// because the images come from the model's own renderings.
//
// A model of photos is tested likewise: a photo, reduced to the size that the model stores (160 px), is turned in the
// image and out of it, as a plane.
//
// The minimum size is found for each direction by bisection on a ladder of sizes. The bisection assumes that an object
// detected at one size is also detected at all larger sizes.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct DetectabilityOptions {
  double size_px = 64;
  double noise = 0;
  std::optional<double> sun_deg;  ///< std::nullopt: diffuse light
  bool attitude_known = true;
  int directions = 24;
  std::uint64_t seed = 1;

  void ListFields(FieldList& fields);
};

/// Detections over a set of directions, at the size of the options.
struct DetectionRate {
  int tested = 0;
  int found = 0;         ///< detections whose box has an IoU of 0.4 or more with the true box
  int correct_view = 0;  ///< detections whose view lies within 10 degrees of the true direction, or is the photo

  [[nodiscard]] double Fraction() const { return tested > 0 ? static_cast<double>(found) / tested : 0; }
};

/// The minimum size of the ladder, px, at which a fraction of the directions is detected; std::nullopt: the fraction is
/// not reached at the maximum size either.
struct DetectableSizes {
  std::optional<double> size_50_px;  ///< 50 %
  std::optional<double> size_90_px;  ///< 90 %
};

/// The directions within one interval of the off-nadir angle, degrees (of photos: see Detectability::of_photos).
struct DetectabilityBand {
  double min_deg = 0;
  double max_deg = 0;
  DetectionRate rate;
  DetectableSizes min_size;
  double features = 0;  ///< median number of features of the nearest views
};

struct Detectability {
  DetectabilityOptions options;
  bool of_photos = false;  ///< the bands are then of the angle by which a photo is turned out of the image
  std::vector<DetectabilityBand> bands;  ///< by rising off-nadir angle; the directions are spread evenly over them
  DetectionRate rate;
  DetectableSizes min_size;
  double max_size_px = 0;                      ///< maximum size of the ladder
  std::optional<DetectionRate> without_noise;  ///< the same without noise; set only with noise and a missed object
  std::optional<DetectionRate>
      in_diffuse_light;  ///< the same in diffuse light; set only with a sun and a missed object
  std::optional<DetectionRate>
      with_attitude;  ///< the same with known attitude; set only without it and a missed object
};

/// Optional callbacks: progress, and the annotated test images.
struct DetectabilityCallbacks {
  std::function<void(int done, int all)> progress;  ///< counts directions; called from any thread, one call at a time
  /// The test image of each direction at the size of the options, CV_8UC3, with the true box drawn (green: detected,
  /// red: missed). Called in the order of the directions, after the measurement.
  std::function<void(const cv::Mat& bgr)> image;
};

/// Measures the detectability. The attitude matters to CAD models only. Deterministic by `options.seed`. Cost: about
/// five searches of a 640 x 480 px image per direction, on all cores.
/// @param features  for the test images, by the engine of the model
/// Errors: kInvalidArgument for options out of range, for a sun and a model of photos, or for a CAD model without
/// renderings (of an early version); kCancelled; kDataLoss for a damaged model.
[[nodiscard]] Expected<Detectability> MeasureDetectability(const ObjectModel& model, const FeatureOptions& features,
                                                           const RecognizeOptions& recognize,
                                                           const DetectabilityOptions& options,
                                                           const CancelToken& cancel,
                                                           const DetectabilityCallbacks& callbacks = {});

}  // namespace victorious
