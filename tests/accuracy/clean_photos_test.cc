// The impulse noise filter (input/image/impulse_noise.h) does not change photos without noise, even with foliage and
// print.
#include <algorithm>
#include <filesystem>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "testing/data.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/image/impulse_noise.h"
#include "victorious/object/features/feature_extractor.h"

namespace victorious::testing {
namespace {

namespace fs = std::filesystem;

TEST(CleanPhotos, AreNotDetectedAsNoisy) {
  VICTORIOUS_DATA_OR_SKIP(folder, "caltech101");
  std::vector<fs::path> photos;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".jpg") photos.push_back(entry.path());
  }
  std::ranges::sort(photos);
  constexpr std::size_t kEvery = 9;
  int looked_at = 0;
  int altered = 0;
  for (std::size_t i = 0; i < photos.size(); i += kEvery) {
    const auto image = ReadImage(photos[i]);
    ASSERT_TRUE(image) << image.error().message;
    const cv::Mat grey = GreyFromBgr(image->bgr);
    ++looked_at;
    altered += cv::norm(RemoveImpulses(grey, FeatureOptions().impulse_fraction), grey, cv::NORM_INF) > 0 ? 1 : 0;
  }
  fmt::print("{} of {} photos altered\n", altered, looked_at);
  EXPECT_LE(altered, 0.05 * looked_at);
}

}  // namespace
}  // namespace victorious::testing
