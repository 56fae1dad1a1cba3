#include "victorious/category/network/detector_settings.h"

#include <cstddef>

#include <fmt/format.h>

namespace victorious {

void DetectorSettings::ListFields(FieldList& fields) {
  fields.Add("layout", layout, kDetectorLayoutTexts, {.reason = "the meaning of the outputs"});
  const FieldSpec side{
      .min = kMinInputSide_px, .max = kMaxInputSide_px, .unit = "px", .reason = "size of the network's input"};
  fields.Add("width", width, side);
  fields.Add("height", height, side);
  fields.Add("fit", fit, kImageFitTexts, {.reason = "how an image is brought to the size of the input"});
  fields.Add("channels", channels, kChannelOrderTexts, {.reason = "order of the colours"});
  fields.Add("resampling", resampling, kImageResamplingTexts, {.reason = "interpolation of the image"});
  fields.Add("border", border, {.min = 0, .max = 255, .reason = "grey level around the image"});
  for (std::size_t c = 0; c < mean.size(); ++c) {
    fields.Add(fmt::format("mean_{}", c + 1), mean[c],
               {.min = -1000, .max = 1000, .reason = "subtracted from a channel, in the order of the colours"});
    fields.Add(fmt::format("deviation_{}", c + 1), deviation[c],
               {.min = 1e-6, .max = 1e6, .reason = "by which a channel is then divided"});
  }
  fields.Add("min_score", min_score, {.min = 0, .max = 1, .reason = "minimum score of an object"});
  fields.Add(
      "max_overlap", max_overlap,
      {.min = 0,
       .max = 1,
       .reason = "of two objects of a class with a greater intersection over union the less likely is left out"});
}

DetectorSettings DefaultSettings(DetectorLayout layout) {
  // ImageNet's, in RGB.
  constexpr std::array<double, 3> kMean = {123.675, 116.28, 103.53};
  constexpr std::array<double, 3> kDeviation = {58.395, 57.12, 57.375};
  DetectorSettings settings{.layout = layout};
  switch (layout) {
    case DetectorLayout::kYolov5:
    case DetectorLayout::kYolov8:
    case DetectorLayout::kYolov10:
      break;
    case DetectorLayout::kYolox:
      settings.fit = ImageFit::kCorner;
      settings.channels = ChannelOrder::kBgr;
      settings.deviation = {1, 1, 1};
      settings.min_score = 0.3;
      break;
    case DetectorLayout::kNanodet:
      settings.channels = ChannelOrder::kBgr;
      settings.resampling = ImageResampling::kArea;
      settings.border = 0;
      settings.mean = {kMean[2], kMean[1], kMean[0]};
      settings.deviation = {kDeviation[2], kDeviation[1], kDeviation[0]};
      settings.min_score = 0.35;
      settings.max_overlap = 0.6;
      break;
    case DetectorLayout::kFastestdet:
      settings.fit = ImageFit::kSqueeze;
      settings.channels = ChannelOrder::kBgr;
      settings.resampling = ImageResampling::kArea;
      settings.min_score = 0.65;
      break;
    case DetectorLayout::kSsd:
      settings.fit = ImageFit::kSqueeze;
      settings.mean = {127, 127, 127};
      settings.deviation = {128, 128, 128};
      settings.min_score = 0.5;
      break;
    case DetectorLayout::kDetr:
      settings.fit = ImageFit::kSqueeze;
      settings.mean = kMean;
      settings.deviation = kDeviation;
      settings.min_score = 0.5;
      settings.max_overlap = 0.7;
      break;
    case DetectorLayout::kDarknet:
      settings.fit = ImageFit::kSqueeze;
      settings.min_score = 0.24;
      break;
  }
  return settings;
}

}  // namespace victorious
