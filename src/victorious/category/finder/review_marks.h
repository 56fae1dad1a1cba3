// What people decided about objects of categories, as marks for category/refine.h. Input: an index with reviews, the
// videos that it names. Output: for each accepted or rejected object of a category the frame of its best sighting, from
// which the category was recognised.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/file_roots.h"
#include "victorious/store/index_store.h"

namespace victorious {

struct ReviewMark {
  std::string category;
  bool is_right = true;  ///< the team accepted the object
  VideoRecord video;
  double time_s = 0;  ///< of the sighting with the best score
};

/// By video, then time, then category.
[[nodiscard]] Expected<std::vector<ReviewMark>> ListReviewMarks(IndexStore& store);

/// Reads the frame of a mark, CV_8UC1.
/// @param roots  that its video must lie below
/// Errors: those of VideoReader and of FileRoots::Check; kNotFound beyond the end; kUnsupported for a live source,
/// whose frames are not kept; kCancelled.
[[nodiscard]] Expected<cv::Mat> ReadMarkedFrame(const ReviewMark& mark, const FileRoots& roots,
                                                const CancelToken& cancel);

}  // namespace victorious
