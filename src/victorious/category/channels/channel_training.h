// Trains a detector by channels (channel_detector.h) on images with boxes.
// Method: an object's box that is clearly longer than wide tells its heading; it is turned to every trained heading,
// mirrored, and moved and sized a little at random. Negatives are windows that overlap no object, at random at first;
// then those that the detector takes for objects, in rounds. Boxes of objects that stand aslant join from the second
// round on, at the heading that scores best. Probabilities are calibrated with detectors of one half of the images, in
// the other half.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/category/channels/channel_detector.h"
#include "victorious/geometry/box.h"

namespace victorious {

struct ChannelTrainOptions {
  double min_object_px = 16;
  bool turns = true;
  int rounds = 4;
  int trees = 256;
  int copies = 6;
  int negatives = 8000;

  void ListFields(FieldList& fields);
};

/// An image in which all objects of the categories have boxes, but for the ignored regions.
struct BoxedImage {
  struct Object {
    std::size_t category = 0;
    Box box;
  };
  cv::Mat image;  ///< BGR or grey, 8 bits
  std::vector<Object> objects;
  std::vector<Box> ignored;  ///< what is in here is neither an object nor none
};

/// @param names  of the categories
/// @param done   progress, in rounds of all
/// Errors: kInvalidArgument for options out of range, and a category with fewer than kMinChannelBoxes boxes.
[[nodiscard]] Expected<ChannelModel> TrainChannelDetector(std::span<const BoxedImage> images,
                                                          const std::vector<std::string>& names,
                                                          const ChannelTrainOptions& options, std::uint64_t seed);

inline constexpr int kMinChannelBoxes = 8;

}  // namespace victorious
