// Why a picture got a score: which phrases spoke for a category, and where in the picture (thesis, section 6.1).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/category/category_model.h"
#include "victorious/geometry/box.h"

namespace victorious {

/// A phrase of a picture and what it adds to a node's raw score; of scoring "likelihood", its share of equation 3.3's
/// sum.
struct PhraseEvidence {
  std::uint32_t i = 0;  ///< keypoints of the picture
  std::uint32_t j = 0;
  double weight = 0;  ///< below 0: it speaks against the node
};

/// All phrases that say anything, the strongest for the node first.
std::vector<PhraseEvidence> EvidenceFor(const CategoryModel& model, const WordedPicture& picture, std::size_t node);

/// Where the category is: the box that gathers most evidence above the picture's mean. The picture's own box where the
/// evidence is even, or there is none.
/// Cost: some 0.1 ms beside the sum over the evidence.
Box SupportingBox(const std::vector<PhraseEvidence>& evidence, const WordedPicture& picture);

/// The picture with the phrases that spoke most for the node, the stronger the brighter, the supporting box, and a line
/// of text.
cv::Mat DrawEvidence(const cv::Mat& bgr, const WordedPicture& picture, const std::vector<PhraseEvidence>& evidence,
                     const std::string& caption);

}  // namespace victorious
