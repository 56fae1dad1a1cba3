// How a detection network wants its image, and what its outputs mean. The network's file states neither: the layout is
// recognised from the shapes of the outputs (output_layout.h), and the rest follows from the layout as its authors
// train it, unless a person says otherwise.
//
//   input = (pixel - mean) / deviation, channel by channel
#pragma once

#include <array>

#include "victorious/base/enum_text.h"
#include "victorious/base/options.h"

namespace victorious {

/// What the outputs of a network mean. C is the number of classes, N that of candidates.
enum class DetectorLayout {
  kYolov5,      ///< 1 x N x (5 + C): centre, size in px, objectness, classes; three anchors a cell
  kYolov8,      ///< 1 x (4 + C) x N: centre, size in px, classes; v9, v11, v12 too
  kYolov10,     ///< 1 x N x 6: corners in px, score, class; without suppression
  kYolox,       ///< 1 x N x (5 + C): centre and size relative to their cell
  kNanodet,     ///< a pair of outputs a stride, or 1 x N x (C + 4 bins): classes, and distributions of the four sides
  kFastestdet,  ///< 1 x (5 + C) x rows x columns
  kSsd,         ///< 1 x 1 x N x 7; or scores 1 x N x (1 + C), the background first, and corners 1 x N x 4
  kDetr,        ///< logits 1 x N x (C + 1), nothing last, or 1 x N x C; and centre, size 1 x N x 4
  kDarknet,     ///< any number of N x (5 + C): centre, size, objectness, classes times objectness
};

inline constexpr auto kDetectorLayoutTexts =
    std::to_array<EnumText<DetectorLayout>>({{DetectorLayout::kYolov5, "yolov5"},
                                             {DetectorLayout::kYolov8, "yolov8"},
                                             {DetectorLayout::kYolov10, "yolov10"},
                                             {DetectorLayout::kYolox, "yolox"},
                                             {DetectorLayout::kNanodet, "nanodet"},
                                             {DetectorLayout::kFastestdet, "fastestdet"},
                                             {DetectorLayout::kSsd, "ssd"},
                                             {DetectorLayout::kDetr, "detr"},
                                             {DetectorLayout::kDarknet, "darknet"}});

/// How an image is brought to the size of the input.
enum class ImageFit {
  kSqueeze,    ///< each side by itself
  kLetterbox,  ///< aspect kept, in the middle of a border
  kCorner,     ///< aspect kept, at the top left
};

inline constexpr auto kImageFitTexts = std::to_array<EnumText<ImageFit>>(
    {{ImageFit::kSqueeze, "squeeze"}, {ImageFit::kLetterbox, "letterbox"}, {ImageFit::kCorner, "corner"}});

enum class ChannelOrder { kRgb, kBgr };

inline constexpr auto kChannelOrderTexts =
    std::to_array<EnumText<ChannelOrder>>({{ChannelOrder::kRgb, "rgb"}, {ChannelOrder::kBgr, "bgr"}});

/// Interpolation of the image.
enum class ImageResampling { kLinear, kArea };

inline constexpr auto kImageResamplingTexts =
    std::to_array<EnumText<ImageResampling>>({{ImageResampling::kLinear, "linear"}, {ImageResampling::kArea, "area"}});

inline constexpr int kMinInputSide_px = 32;
inline constexpr int kMaxInputSide_px = 4096;

struct DetectorSettings {
  DetectorLayout layout = DetectorLayout::kYolov8;
  int width = 640;  ///< of the input, px
  int height = 640;
  ImageFit fit = ImageFit::kLetterbox;
  ChannelOrder channels = ChannelOrder::kRgb;
  ImageResampling resampling = ImageResampling::kLinear;
  int border = 114;  ///< grey level around the image
  std::array<double, 3> mean = {0, 0, 0};
  std::array<double, 3> deviation = {255, 255, 255};
  double min_score = 0.25;
  double max_overlap = 0.45;

  void ListFields(FieldList& fields);
  bool operator==(const DetectorSettings&) const = default;
};

/// As the authors of the layout train it.
[[nodiscard]] DetectorSettings DefaultSettings(DetectorLayout layout);

}  // namespace victorious
