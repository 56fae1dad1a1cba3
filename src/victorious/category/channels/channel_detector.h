// A detector of objects by aggregated channels and boosted trees: fast, and trained on a few hundred boxes
// (channel_training.h). In: an image in colour or grey. Out: boxes with the probability that they are right.
// Method: all windows of all levels (channel_windows.h) are scored by a cascade of trees for each heading
// (kernels/window_trees.h); of boxes that overlap the best stays, moved to the weighted mean of those it suppresses.
// Source: P. Dollár et al., "Fast feature pyramids for object detection", PAMI 2014.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/category/channels/boosted_trees.h"
#include "victorious/category/channels/channel_windows.h"
#include "victorious/category/common/calibration.h"
#include "victorious/geometry/box.h"

namespace victorious {

/// How long or wide objects of a detector may be, in sqrt(length x width).
inline constexpr double kMaxChannelLength = 10;

/// A category of a detector.
struct ChannelCategory {
  std::string name;
  double length = 1;                    ///< of its objects, in sqrt(length x width)
  double width = 1;                     ///< likewise; if `turns` is false: length is along x, width along y
  bool turns = true;                    ///< objects have any heading
  std::vector<BoostedTrees> detectors;  ///< of the trained headings; one if `turns` is false
  Calibration calibration;              ///< of scores in log odds
};

struct ChannelModel {
  std::string program_version;  ///< that trained it
  int images = 0;               ///< of its training
  int boxes = 0;
  double min_object_px = 16;  ///< smallest length that is searched for
  std::vector<ChannelCategory> categories;
};

struct ChannelBox {
  std::size_t category = 0;
  Box box;                 ///< px, inside the image
  double score = 0;        ///< log odds of the trees
  double probability = 0;  ///< calibrated
};

/// A window that the cascade accepts.
struct ChannelHit {
  int heading = 0;
  int x = 0;  ///< of its first cell
  int y = 0;
  int score = 0;  ///< in 1 / kLeafScale
};

/// The size of the cells of the finest level.
[[nodiscard]] double MinCellOf(const ChannelModel& model);

/// The number of headings that are searched: kHeadings, or 1.
[[nodiscard]] int HeadingsOf(const ChannelCategory& category);

/// The windows of a level that the cascades of a category accept, row by row.
[[nodiscard]] std::vector<ChannelHit> ScanLevel(const ChannelLevel& level, const ChannelCategory& category);

/// The box of a window's object.
[[nodiscard]] Box BoxOfHit(const ChannelLevel& level, const ChannelCategory& category, const ChannelHit& hit);

/// @param image  BGR or grey, 8 bits
/// @return by falling probability, from min_probability up. Thread-safe.
[[nodiscard]] std::vector<ChannelBox> DetectByChannels(const ChannelModel& model, const cv::Mat& image,
                                                       double min_probability);

}  // namespace victorious
