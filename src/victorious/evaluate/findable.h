// How findable a model is, before there is a video: pictures of the object from between its views, at a given size, in
// a given light and noise, on drawn clutter, are searched as frames are. The share found is what a flight would find of
// such sightings, as far as its pictures are like these.
//
// The least size is sought one direction at a time, by halving a ladder of sizes: what is found at one size is taken to
// be found at larger ones, too.
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
  std::optional<double> sun_deg;  ///< its elevation, degrees, 5 to 90; none: soft light
  bool attitude_known = true;
  int directions = 24;
  std::uint64_t seed = 1;

  void ListFields(FieldList& fields);
};

/// Of some directions, at the size asked for.
struct FoundShare {
  int asked = 0;
  int found = 0;       ///< of these, by a box that overlaps the true one by 0.4 or more
  int right_view = 0;  ///< of those found, from within 10 degrees of the direction

  [[nodiscard]] double Share() const { return asked > 0 ? static_cast<double>(found) / asked : 0; }
};

/// The smallest size of the ladder at which so large a share is found, px; none: not at its largest either.
struct LeastSizes {
  std::optional<double> half_px;  ///< 50 %
  std::optional<double> most_px;  ///< 90 %
};

/// Directions by how far off nadir.
struct FindableBand {
  double least_deg = 0;
  double most_deg = 0;
  FoundShare share;
  LeastSizes least;
  double features = 0;  ///< median of the views there
};

struct Findable {
  FindableOptions options;
  std::vector<FindableBand> bands;  ///< from straight above on; as many directions in each
  FoundShare share;
  LeastSizes least;
  double largest_px = 0;              ///< of the ladder
  std::optional<FoundShare> quiet;    ///< without the noise; only where there is some, and not all was found
  std::optional<FoundShare> soft;     ///< in soft light; likewise
  std::optional<FoundShare> upright;  ///< with the camera's attitude known; likewise
};

/// What is looked through, one after the other: progress, and the pictures for people.
struct FindableWatch {
  std::function<void(int done, int all)> progress;  ///< directions; from any thread, one at a time
  /// The picture of each direction at the size asked for, CV_8UC3, the object boxed: in their order, at the end.
  std::function<void(const cv::Mat& bgr)> picture;
};

/// Deterministic by the seed.
/// Errors: kInvalidArgument for options out of range, a model without renderings (photos, or made by an early version)
/// or of another engine than `features`; kCancelled; kDataLoss for a damaged model.
Expected<Findable> HowFindable(const ObjectModel& model, const FeatureOptions& features,
                               const RecognizeOptions& recognize, const FindableOptions& options,
                               const CancelToken& cancel, const FindableWatch& watch = {});

nlohmann::ordered_json ToJson(const Findable& findable);

/// A table for people, then in plain words what it means and what would help.
std::string ToText(const Findable& findable);

}  // namespace victorious
