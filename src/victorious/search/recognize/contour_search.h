// recognize/, the search for one CAD model in any pose, by its outline and creases, where nothing is known of the
// camera: an object of one colour in a photograph or in a video without telemetry (docs/adr/0042).
//
// Method: coarse templates of 64 px, of directions 10 degrees apart, three rolls and all sizes, count the edge pixels
// of the right orientation (as LINE-2D, Hinterstoisser et al., PAMI 2012) against what the surroundings make likely.
// That ranks the right pose among the best hundred of its size, no better. Their poses are refined on the image's edges
// (contour_pose.h), the best of them from many starts nearby, and the evidence of the refined pose decides, by how many
// of its points have an edge, and how much its contours are steps.
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

/// The -log10 NFA of a refined pose in one image. The evidence of its contours counts in full where nine of ten points
/// have an edge and the contours stand out as steps: wrong poses on marked roads and among leaves have fewer hits, or
/// lie on lines (docs/adr/0042).
[[nodiscard]] double NegLog10NfaOf(const ContourEvidence& evidence);

/// What a match needs, decades. The search of a frame wants more (DetectOptions::min_score); other frames of the video
/// add to it (shape_search.h).
inline constexpr double kMinContourNegLog10Nfa = 2;

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
/// Deterministic. Cost: about 1 s on two cores.
/// @param grey  CV_8UC1, without impulse noise
[[nodiscard]] std::optional<ContourMatch> FindByContours(const ContourModel& model, const cv::Mat& grey);

}  // namespace victorious
