// jobs/, what is found by shape (search/recognize/shape_search.h) on its way into an index: when frames are searched
// so, detections beside those by keypoints, and the errors of their poses.
#pragma once

#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/place/observe/object_pose.h"
#include "victorious/search/detect/detect.h"
#include "victorious/search/follow/follower.h"
#include "victorious/search/follow/looks_before.h"
#include "victorious/search/recognize/shape_search.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame_conditions.h"

namespace victorious {

/// Seconds between two searches by shape: those of the options, or less where a track would end before, which goes on
/// for some frames after it was recognised last.
/// @param tracked_rate  tracked frames a second; 0: unknown
/// @param spacing       at least 1: the interval of the options is longer by this factor
[[nodiscard]] double ShapeSearchInterval(const ShapeSearchOptions& options, const FollowOptions& follow,
                                         double tracked_rate, double spacing);

struct ShapeDetection {
  Detection detection;
  bool is_examined = false;  ///< ShapeMatch
  LooksBefore before;        ///< of one that is examined
};

/// What a frame shows by shape, also what is too weak to count by itself: KeepSignificant decides.
/// @param image     the frame, CV_8UC1, without impulse noise
/// @param features  of the frame; gets the points of the detections (ShapeSearch::MakeDetection)
/// Errors: those of ShapeSearch::Find.
[[nodiscard]] Expected<std::vector<ShapeDetection>> FindByShape(const ShapeSearch& shapes, const cv::Mat& image,
                                                                const FrameConditions& conditions,
                                                                const DetectOptions& options, FeatureSet& features);

/// Adds matches in a frame to the detections, but for those that do not lie in the frame or are too small. Of two of
/// one model in one place the one with more evidence stays.
/// @param features  as of FindByShape
/// Errors: those of ShapeSearch::MakeDetection.
[[nodiscard]] Status AddMatches(const ShapeSearch& shapes, std::span<const ShapeMatch> matches,
                                const DetectOptions& options, FeatureSet& features,
                                std::vector<ShapeDetection>& by_shape);

/// Removes what does not reach options.min_score: by the frames before where there are enough of them (LooksBefore),
/// else by the frame itself. What is beyond doubt in the frame itself stays in any case: trees may have hidden it. Of
/// several in one place the one with the most evidence of all frames stays.
/// @return what later frames may decide: examined, without enough frames before, and nothing stands there
[[nodiscard]] std::vector<Detection> KeepSignificant(const DetectOptions& options,
                                                     std::vector<ShapeDetection>& by_shape);

/// Joins detections by shape to those by keypoints, by falling score. Of two of one model in one place the one
/// with more evidence stays, but one by shape that was not examined never replaces one by keypoints. One by shape with
/// less evidence than one by keypoints of another model goes, too. Few keypoints that agree give a worse pose than the
/// edges.
void JoinDetections(std::vector<ShapeDetection> by_shape, std::vector<Detection>& detections);

/// Raises the standard deviations of an object pose to those of a match by shape: its points are where the match puts
/// them, so that their errors are common.
void SetShapeErrors(ObjectPose& object_pose, const ShapeSearchOptions& options);

}  // namespace victorious
