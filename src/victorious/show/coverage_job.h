// How well the videos of an index searched the ground: reads which times were searched for the models, the telemetry of
// the videos and the sizes of the models, and computes the probability that an object would have been found
// (place/geolocate/ground_views.h, docs/adr/0044-probability-of-detection.md).
//
// The camera of a video is that of `index`: its telemetry, with the clock, the field of view and the yaw corrected by
// the motion of the image. Its ground is the one given, else that estimated from the motion of the image, else flat at
// the median height of the objects found. A time counts as searched if it was for every model.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/file_roots.h"
#include "victorious/base/options.h"
#include "victorious/base/warning_sink.h"
#include "victorious/geometry/ground.h"
#include "victorious/place/cameras/camera_states.h"
#include "victorious/place/geolocate/ground_views.h"
#include "victorious/place/geolocate/view_detection.h"
#include "victorious/store/index_store.h"
#include "victorious/types/ground_coverage.h"

namespace victorious {

struct CoverageOptions {
  ViewDetectionOptions detection;
  std::optional<double> cell_m;
  double look_interval_s = 0.5;
  double min_probability = 0.9;

  void ListFields(FieldList& fields);
};

/// The size that a model has in the coverage; std::nullopt: it is unknown, as of photos without a length.
[[nodiscard]] std::optional<SearchedModel> SizeOf(const ObjectModel& model);

/// The frames of a video whose camera is known, each `interval_s`, at times that were searched for all of these models.
/// At most 50,000: then at longer intervals.
/// @param parts  of this video
[[nodiscard]] std::vector<GroundLook> SearchedLooks(const VideoRecord& video, std::span<const SearchPart> parts,
                                                    std::span<const std::int64_t> models, const CameraStates& cameras,
                                                    const std::shared_ptr<const Ground>& ground, double interval_s);

struct CoverageRequest {
  CoverageOptions options;
  std::filesystem::path models;               ///< folder of the model library, which has the models' sizes
  std::optional<std::string> telemetry = {};  ///< file of all videos; std::nullopt: as for `index`
  FileRoots roots = {};                       ///< below which files are opened
  std::shared_ptr<const Ground> ground = {};  ///< null: none was given
  WarningSink warn = {};  ///< gets one line for each video or model that is left out, if others are not
};

/// @param filter  its video, model and `near` select; the circle is then the area that was to be searched. Categories
///   have no size and are left out.
/// Errors: kNotFound for a video or model that the index lacks; kInvalidArgument if no video has telemetry, ground and
/// searched times, or no model has a size; kCancelled.
[[nodiscard]] Expected<GroundCoverage> CoverIndex(IndexStore& store, const SightingFilter& filter,
                                                  const CoverageRequest& request, const CancelToken& cancel);

}  // namespace victorious
