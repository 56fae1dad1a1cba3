// Growth of what photos found (ADR 0040). A photo shows an object from one side; recognition ends some 25 degrees
// beyond it. In: the tracklets of one photo model in one video, once all of it is searched. Out: their sightings in the
// frames before, between and after, and which tracklets are one object.
//
//   best recognition of a tracklet -> followed forward and backward (track/surround_tracker.h) until its evidence ends
//                                  -> views at which the known ones are hardly recognised are learnt
//                                  -> it meets another tracklet of the model: both are one object
//
// Evidence of a frame: the colours in the box differ from those around it as they did at first, where the motion of the
// surroundings expects it; or a view of the chain is recognised there. A view is learnt only where both grounds hold:
// it stands where its surroundings have moved to, and an older view of the chain is found in it, or it in the last
// frame in which one was. Frames without evidence are left out: after `max_lost_s` of them the colours no longer count
// alone, and after twice that the object is given up. An object that moves by itself is given up too, and what was
// added since it was last recognised is removed. Sightings between two frames that are looked at are interpolated.
//
// A tracklet that has a sighting in each frame until its object leaves the view, or the video ends, is not followed.
//
// What is found depends on the stored sightings and the video only: not on interruptions, nor on who searched it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/jobs/index/view_chain.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/types/frame.h"
#include "victorious/types/index_records.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct GrowOptions {
  bool enabled = true;
  double max_lost_s = 5;
  /// Fewest recognitions of a tracklet that is followed, and least score of the best one: a false recognition seldom
  /// has either. Not user parameters.
  int min_recognitions = 3;
  double min_score = 0.99;

  void ListFields(FieldList& fields);
};

/// A sighting that growth adds.
struct GrownSighting {
  std::int64_t tracklet = 0;
  std::int64_t frame = 0;
  Box box;           ///< px, clipped to the frame
  Polygon outline;   ///< px
  double score = 0;  ///< of the tracklet's best recognition, less for weaker evidence and by the chain's probability
  int matches = 0;   ///< of the view of the chain that was recognised here; 0: none was, or it is interpolated
};

struct TrackGrowth {
  std::vector<GrownSighting> sightings;  ///< by frame; at most one of a tracklet, and none where it has one
  /// Tracklets that are one object: the second one becomes a part of the first, whose id is lower. At most one entry of
  /// a second one, and no first one is another's second.
  std::vector<std::pair<std::int64_t, std::int64_t>> joined;
  std::vector<LearntView> views;  ///< of all tracklets
};

/// The tracklets of one model in one video.
struct GrowthInput {
  const ObjectModel& model;  ///< of photos
  std::span<const TrackletRecord> tracklets;
  std::span<const SightingRecord> sightings;  ///< of the tracklets, by frame
  const FeatureExtractor& extractor;
  const RecognizeOptions& recognize;
  const GrowOptions& options;
  /// True if a sighting may be at this place on the Earth, as far as telemetry tells; empty: nothing is known.
  std::function<bool(std::int64_t tracklet, std::int64_t frame, const Box& box)> is_plausible = {};
};

/// The frames [first, end) for which `is_wanted` is true, in colour and in order.
using ReadFrames = std::function<Expected<std::vector<Frame>>(std::int64_t first, std::int64_t end,
                                                              const std::function<bool(std::int64_t)>& is_wanted)>;

struct GrowthVideo {
  std::span<const double> times_s;  ///< of all frames, s, ascending
  std::int64_t end = 0;             ///< frames from here on are not searched
  Box frame;                        ///< of any frame, px
  ReadFrames read;
  std::int64_t max_wanted = 1;  ///< largest number of wanted frames to ask for at once
};

/// True if growth looks at a frame: the first one of each 0.15 s, and the last. @param times_s  of all frames
[[nodiscard]] bool IsGrowthStep(std::span<const double> times_s, std::int64_t frame);

/// Goes once forward and once backward through the parts of the video that are near tracklets which are followed, for
/// all models at once. Deterministic.
/// @return one for each input
/// Errors: those of `read`, of feature extraction and of Recognizer::Create; kCancelled.
[[nodiscard]] Expected<std::vector<TrackGrowth>> GrowTracks(const GrowthVideo& video,
                                                            std::span<const GrowthInput> inputs,
                                                            const CancelToken& cancel);

}  // namespace victorious
