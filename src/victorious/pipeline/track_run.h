// User-specified tracking: boxes that a person drew in frames of a video are followed to its end and to its beginning,
// and looked for in other videos.
//
// Each box is followed by track/ (box_tracker.h), and becomes an object model on the spot where it has keypoints
// enough. While its object is lost, every so many frames the recogniser looks for that model in the whole frame, at any
// scale and turn; what it finds is taken up again if the tracker trusts it as well.
//
// With telemetry each object gets a place on Earth (box_place.h), on the ground that is told or that it was drawn on.
// What stands still is also looked for by its place in other videos that have telemetry, and what is found there
// elsewhere is not it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/model/photo_model.h"
#include "victorious/pipeline/box_place.h"
#include "victorious/pipeline/box_sighting.h"
#include "victorious/pipeline/warning_sink.h"
#include "victorious/recognize/recognizer.h"
#include "victorious/telemetry/telemetry.h"
#include "victorious/terrain/terrain.h"
#include "victorious/track/box_track_options.h"

namespace victorious {

struct TrackRunOptions {
  BoxTrackOptions box;
  TelemetryOptions telemetry;
  BoxPlaceOptions place;
  GroundOptions ground;
  PhotoModelOptions model;
  RecognizeOptions recognize;
  int recognize_every = 5;
  int memory_mb = 512;

  void ListFields(FieldList& fields);
};

struct TrackedBoxes {
  std::vector<BoxSighting> sightings;     ///< by video, frame, box
  std::vector<std::string> why_no_place;  ///< by box; empty for what has one
};

/// @param videos     the first is the one that the boxes are drawn in; each a file or a folder, read twice
/// @param telemetry  a file of the first video's; nothing: what is in it or beside it, as for the others
/// Errors: those of MakeGround; kInvalidArgument for options out of range, no boxes, a box that is outside its frame or
/// too small, a time beyond the end, a live source; those of VideoReader; kCancelled. Cost: at 640 x 480 some 15 ms a
/// frame for one box. Frames before the boxes are read again in stretches that fit into options.memory_mb, each from
/// the key frame before it where the video can be entered there, else from the beginning.
Expected<TrackedBoxes> TrackBoxes(std::span<const std::string> videos, std::span<const DrawnBox> boxes,
                                  const std::optional<std::string>& telemetry, const TrackRunOptions& options,
                                  const CancelToken& cancel, const WarningSink& warn);

}  // namespace victorious
