// User-specified tracking: objects in boxes that a user drew are tracked to the end and to the beginning of a video,
// and searched for in other videos.
//
// Each box is tracked by track/ (box_tracker.h). If it has enough keypoints, an object model is made of it. While the
// object is lost, the recogniser searches the whole frame for that model every `recognize_every` frames, at any scale
// and rotation; the tracker verifies a detection before it resumes the track.
//
// With telemetry each object gets a place on Earth (box_place.h), on the given ground or on the ground point on which
// the box was drawn. In other videos with telemetry, static objects are also searched for by their place, and
// detections elsewhere are rejected.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/base/warning_sink.h"
#include "victorious/input/telemetry/telemetry.h"
#include "victorious/input/terrain/terrain.h"
#include "victorious/jobs/track/box_sighting.h"
#include "victorious/object/model/photo_model.h"
#include "victorious/place/associate/box_place.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/track/box_track_options.h"

namespace victorious {

struct TrackBoxesOptions {
  BoxTrackOptions box;
  TelemetryOptions telemetry;
  BoxPlaceOptions place;
  GroundOptions ground;
  PhotoModelOptions model;     ///< of the boxes' models. Not a user parameter
  RecognizeOptions recognize;  ///< search for lost objects. Not a user parameter
  int recognize_every = 5;     ///< frames between searches for a lost object
  int memory_mb = 512;         ///< MiB, of the frames of the backward pass

  void ListFields(FieldList& fields);
};

struct TrackedBoxes {
  std::vector<BoxSighting> sightings;       ///< sorted by video, frame, box
  std::vector<std::string> place_failures;  ///< one per box; empty if it has a place
};

/// Tracks user boxes.
/// @param videos     files or folders; the boxes are drawn in the first. Each is read twice
/// @param telemetry  telemetry file of the first video; std::nullopt: what is in or beside the video, as for the others
/// Errors: those of MakeGround; kInvalidArgument for options out of range, no boxes, a box that is outside its frame or
/// too small, a time beyond the end, or a live source; those of VideoReader; kCancelled. Cost: at 640 x 480 some 15 ms
/// per frame and box. The backward pass reads intervals of frames that fit into options.memory_mb, each from the key
/// frame before it if the video is seekable there, else from the beginning.
[[nodiscard]] Expected<TrackedBoxes> TrackBoxes(std::span<const std::string> videos, std::span<const UserBox> boxes,
                                                const std::optional<std::string>& telemetry,
                                                const TrackBoxesOptions& options, const CancelToken& cancel,
                                                const WarningSink& warn);

}  // namespace victorious
