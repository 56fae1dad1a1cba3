// Detectability of a CAD model before there is a video (`model show --findable`).
//
// Method: a Monte Carlo test. The object is rendered from random directions between the model's views (turned_view.h),
// at a given size, light and noise, and pasted onto synthetic clutter (drawn_clutter.h). The recogniser searches each
// image as it searches a frame. The fraction of detections estimates the recall of a flight; it is an upper limit,
// because the images come from the model's own renderings.
//
// The minimum size is found for each direction by bisection on a ladder of sizes. The bisection assumes that an object
// detected at one size is also detected at all larger sizes.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/recognize/recognizer.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct FindableOptions {
  double size_px = 64;
  double noise = 0;
  std::optional<double> sun_deg;  ///< elevation of the sun, degrees, 5 to 90; std::nullopt: diffuse light
  bool attitude_known = true;
  int directions = 24;
  std::uint64_t seed = 1;

  void ListFields(FieldList& fields);
};

/// Detections over a set of directions, at the size of the options.
struct FoundShare {
  int asked = 0;
  int found = 0;       ///< detections whose box has an IoU of 0.4 or more with the true box
  int right_view = 0;  ///< detections whose view lies within 10 degrees of the true direction

  [[nodiscard]] double Share() const { return asked > 0 ? static_cast<double>(found) / asked : 0; }
};

/// The minimum size of the ladder, px, at which a fraction of the directions is detected; std::nullopt: the fraction is
/// not reached at the maximum size either.
struct LeastSizes {
  std::optional<double> half_px;  ///< 50 %
  std::optional<double> most_px;  ///< 90 %
};

/// The directions within one interval of the off-nadir angle, degrees.
struct FindableBand {
  double least_deg = 0;
  double most_deg = 0;
  FoundShare share;
  LeastSizes least;
  double features = 0;  ///< median number of features of the nearest views
};

struct Findable {
  FindableOptions options;
  std::vector<FindableBand> bands;  ///< by rising off-nadir angle; the directions are spread evenly over them
  FoundShare share;
  LeastSizes least;
  double largest_px = 0;              ///< maximum size of the ladder
  std::optional<FoundShare> quiet;    ///< the same without noise; set only with noise and a missed object
  std::optional<FoundShare> soft;     ///< the same in diffuse light; set only with a sun and a missed object
  std::optional<FoundShare> upright;  ///< the same with known attitude; set only without it and a missed object
};

/// Optional callbacks: progress, and the annotated test images.
struct FindableWatch {
  std::function<void(int done, int all)> progress;  ///< counts directions; called from any thread, one call at a time
  /// The test image of each direction at the size of the options, CV_8UC3, with the true box drawn (green: detected,
  /// red: missed). Called in the order of the directions, after the measurement.
  std::function<void(const cv::Mat& bgr)> picture;
};

/// Measures the detectability. Deterministic by `options.seed`. Cost: about five searches of a 640 x 480 px image per
/// direction, on all cores.
/// Errors: kInvalidArgument for options out of range, for a model without renderings (made from photos, or by an early
/// version) or of another feature engine than `features`; kCancelled; kDataLoss for a damaged model.
Expected<Findable> HowFindable(const ObjectModel& model, const FeatureOptions& features,
                               const RecognizeOptions& recognize, const FindableOptions& options,
                               const CancelToken& cancel, const FindableWatch& watch = {});

nlohmann::ordered_json ToJson(const Findable& findable);

/// Returns a table of the bands as text, followed by advice in sentences.
std::string ToText(const Findable& findable);

}  // namespace victorious
