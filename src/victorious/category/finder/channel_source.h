// A detector by channels (category/channels/) as a source of categories, and its training from a list of images.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/category/channels/channel_detector.h"
#include "victorious/category/channels/channel_training.h"
#include "victorious/category/common/category_list.h"
#include "victorious/category/finder/category_source.h"

namespace victorious {

class ChannelSource : public CategorySource {
 public:
  /// Errors: kInvalidArgument for options out of range, and if all categories are background.
  [[nodiscard]] static Expected<ChannelSource> Create(ChannelModel model, const CategoryFindOptions& options);

  [[nodiscard]] const std::vector<std::string>& names() const override { return reported_.names(); }
  [[nodiscard]] const std::string& content_id() const override { return content_id_; }
  [[nodiscard]] bool IsDetector() const override { return true; }
  [[nodiscard]] std::string DescribeSearch(cv::Size frame) const override;
  /// Of a frame without colour: in its luma.
  [[nodiscard]] Expected<std::vector<FoundCategory>> FindIn(const Frame& frame) const override;

 private:
  ChannelSource() = default;

  ChannelModel model_;
  double min_probability_ = 0.5;
  ReportedCategories reported_;
  std::string content_id_;
};

/// The category of a list's boxes in which nothing is labelled: neither an object nor background.
inline constexpr const char* kIgnoredCategory = "ignored";

/// True if the list is one for a detector: an image has more than one box.
[[nodiscard]] bool HasSeveralBoxesAnImage(std::span<const CategoryListRow> rows);

/// Trains on the images of a list, one row a box; every object of the categories has a box, except in boxes of
/// kIgnoredCategory. A row without a box is an image without objects, whatever its category.
/// @param done  progress callback, with the number of rows read
/// Errors: those of reading images and TrainChannelDetector; kInvalidArgument for a row without a category, a box
/// outside its image, a CAD file, and a list without boxes.
[[nodiscard]] Expected<ChannelModel> TrainChannelsOnList(const std::filesystem::path& folder,
                                                         std::span<const CategoryListRow> rows,
                                                         const ChannelTrainOptions& options, std::uint64_t seed,
                                                         const std::function<void(std::size_t)>& done);

}  // namespace victorious
