// A CAD model as the example of its kind: pictures of it from many sides, before pictures that do not show it.
// Method: renderings lit softly or by a hard sun, with the shadows that the object throws on itself; brighter or darker
// by chance, as things of a kind are painted; laid over a picture that they fill for the most part.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/recognize/window_training.h"
#include "victorious/render/mesh.h"

namespace victorious {

struct CadPictureOptions {
  int views = 25;
  double least_off_nadir_deg = 60.0;
  double most_off_nadir_deg = 100.0;
  double sunlit_share = 0.5;

  void ListFields(FieldList& fields);
};

/// Error: kInvalidArgument, a range without views.
Status CheckRange(const CadPictureOptions& options);

/// A picture as CAD models are drawn before it: not larger than they are drawn, so that both are as sharp.
[[nodiscard]] cv::Mat BackgroundForCad(const cv::Mat& grey);

/// @param backgrounds  CV_8UC1, at least one
/// @return             pictures of the backgrounds' sizes, of `category`, the object in its box
/// Errors: kInvalidArgument for options out of range; kInternal where nothing can render.
Expected<std::vector<BoxedPicture>> PicturesOfCad(const Mesh& mesh, const std::string& category,
                                                  std::span<const cv::Mat> backgrounds,
                                                  const CadPictureOptions& options, std::uint64_t seed);

}  // namespace victorious
