// recognize/, the search for one CAD model in any pose, by its outline and creases, where nothing is known of the
// camera: an object of one colour in a photograph or in a video without telemetry (docs/adr/0042).
//
// Method: coarse templates of 64 px, of directions 10 degrees apart, three rolls and all sizes, count the edge pixels
// of the right orientation (as LINE-2D, Hinterstoisser et al., PAMI 2012) against what the surroundings make likely.
// That ranks the right pose among the best hundred of its size, no better. Their poses are refined on the image's edges
// (contour_pose.h), the best of them from many starts nearby, and the evidence of the refined pose decides: a right
// pose has an edge at nine of ten points, wrong ones do not reach that however they are refined.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/search/recognize/contour_pose.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// What a right pose has: a mean evidence of each point of its contours, and evidence of all. Wrong poses of a box
/// reach 0.53 and 75 in other videos, right ones 0.83 and 170 (docs/adr/0042).
inline constexpr double kMinContourMean = 0.65;
inline constexpr double kContourDecadesOfOneFalseAlarm = 85;
/// Edges of one scene are not independent: decades of evidence for one of -log10 NFA.
inline constexpr double kContourDecadesPerNfa = 12;

/// A model found in one image.
struct ContourMatch {
  ContourPose pose;
  ContourEvidence evidence;
  double neg_log10_nfa = 0;  ///< decades
};

/// The contours of all views of a model.
/// Errors: those of RelitTemplateSource.
[[nodiscard]] Expected<ContourModel> ReadContourModel(const ObjectModel& model, const RelitTemplateSource& source);

/// The best pose of a model in an image, in the image's pixels. std::nullopt if it is not significant: in most images.
/// An image of more than 800 px is searched at that size; objects of less than 180 px in it are not found.
/// Deterministic. Cost: some 2 s.
/// @param grey  CV_8UC1, without impulse noise
[[nodiscard]] std::optional<ContourMatch> FindByContours(const ContourModel& model, const cv::Mat& grey);

}  // namespace victorious
