// Places on Earth of the objects in user boxes, from their sightings in all videos (track_job.h): bearing observations,
// motion, ground, place (place/associate/box_place.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "victorious/base/warning_sink.h"
#include "victorious/input/terrain/terrain.h"
#include "victorious/jobs/track/box_sighting.h"
#include "victorious/jobs/track/track_pass.h"
#include "victorious/place/associate/box_place.h"
#include "victorious/place/cameras/camera_states.h"

namespace victorious {

/// The videos of a tracking job; one entry per video.
struct TrackedVideos {
  std::vector<CameraStates> cameras;
  std::vector<cv::Size> sizes;  ///< of the frames, px
};

/// The ground points on which the boxes were drawn: by user box, then by frame of the first video.
using GroundPointTracks = std::vector<std::map<std::int64_t, GroundPointObservation>>;

class BoxLocator {
 public:
  /// @param ground  given ground, or null. The references outlive the locator and may change between calls.
  BoxLocator(std::span<const UserBox> boxes, const TrackedVideos& videos, const GroundPointTracks& ground_points,
             std::shared_ptr<const Ground> ground, const BoxPlaceOptions& options)
      : boxes_(boxes),
        videos_(videos),
        ground_points_(ground_points),
        given_ground_(std::move(ground)),
        options_(options) {}

  /// Sorts the sightings by video, frame and box, and sets their bearing observation and place.
  void Locate(std::vector<BoxSighting>& sightings) const;

  /// Static objects, from their located sightings in the frames in which they were drawn; one entry per user box.
  [[nodiscard]] std::vector<std::optional<StaticBox>> FindStaticBoxes(std::span<const UserBoxTarget> targets,
                                                                      std::span<const BoxSighting> sightings) const;

  /// Reason why an object has no place; empty if it has one.
  /// @param sightings  located
  [[nodiscard]] std::string DescribePlaceFailure(std::size_t box_index, std::span<const BoxSighting> sightings) const;

  /// Warns if a place is far from the given ground: the lines of sight override the ground.
  void WarnOfGround(std::span<const BoxSighting> sightings, const WarningSink& warn) const;

 private:
  using SeenByVideo = std::vector<std::vector<BoxSighting*>>;

  SeenByVideo Observe(std::size_t box_index, std::vector<BoxSighting>& sightings) const;
  [[nodiscard]] BoxMotion ClassifyMotion(std::size_t box_index, const std::vector<BoxSighting*>& seen) const;
  [[nodiscard]] std::optional<ObjectGround> GivenGround(std::size_t box_index) const;
  [[nodiscard]] std::optional<ObjectGround> EstimateGround(std::size_t box_index) const;
  void SetPlaces(const std::vector<BoxSighting*>& seen, BoxMotion motion,
                 const std::optional<ObjectGround>& ground) const;
  [[nodiscard]] std::optional<CameraState> CameraAt(const BoxSighting& sighting) const;

  std::span<const UserBox> boxes_;
  const TrackedVideos& videos_;
  const GroundPointTracks& ground_points_;
  std::shared_ptr<const Ground> given_ground_;
  const BoxPlaceOptions& options_;
};

}  // namespace victorious
