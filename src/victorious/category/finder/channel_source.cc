#include "victorious/category/finder/channel_source.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/category/channels/channel_file.h"
#include "victorious/input/image/image_file.h"
#include "victorious/object/mesh/load_mesh.h"

namespace victorious {

Expected<ChannelSource> ChannelSource::Create(ChannelModel model, const CategoryFindOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  ChannelSource source;
  source.content_id_ = fmt::format("{:016x}", Checksum(EncodeChannelModel(model)));
  source.min_probability_ = options.min_probability;
  for (const ChannelCategory& category : model.categories) source.reported_.Add(category.name, options);
  source.model_ = std::move(model);
  if (!source.names().empty()) return source;
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("categories: all categories of the detector are background ({})", options.background));
}

std::string ChannelSource::DescribeSearch(cv::Size frame) const {
  return fmt::format("the detector by channels searches {} x {} px for objects of {:g} px or more", frame.width,
                     frame.height, model_.min_object_px);
}

Expected<std::vector<FoundCategory>> ChannelSource::FindIn(const Frame& frame) const {
  const cv::Mat& image = frame.bgr.empty() ? frame.image : frame.bgr;
  std::vector<FoundCategory> found;
  for (const ChannelBox& one : DetectByChannels(model_, image, min_probability_)) {
    const std::optional<std::size_t> category = reported_.Of(one.category);
    if (category) found.push_back({.category = *category, .box = one.box, .probability = one.probability});
  }
  return found;
}

bool HasSeveralBoxesAnImage(std::span<const CategoryListRow> rows) {
  std::set<std::string> boxed;
  return std::ranges::any_of(rows, [&](const CategoryListRow& row) {
    return row.box && row.category != kIgnoredCategory && !boxed.insert(row.image).second;
  });
}

Expected<ChannelModel> TrainChannelsOnList(const std::filesystem::path& folder, std::span<const CategoryListRow> rows,
                                           const ChannelTrainOptions& options, std::uint64_t seed,
                                           const std::function<void(std::size_t)>& done) {
  std::map<std::string, std::size_t> number_of_image;
  std::map<std::string, std::size_t> number_of_category;
  std::vector<std::string> names;
  std::vector<BoxedImage> images;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const CategoryListRow& row = rows[r];
    if (row.category.empty()) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: no category: name the category that the box shows", row.where));
    }
    if (IsCadFile(row.image)) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: a CAD file: a detector by channels is trained on images", row.where));
    }
    const auto [at, is_new] = number_of_image.try_emplace(row.image, images.size());
    if (is_new) {
      Expected<Image> image = ReadImage(folder / row.image);
      if (!image) return std::unexpected(std::move(image).error().WithContext(row.where));
      images.push_back({.image = std::move(image->bgr), .objects = {}, .ignored = {}});
    }
    done(r + 1);
    if (!row.box) continue;
    BoxedImage& image = images[at->second];
    VICTORIOUS_ASSIGN_OR_RETURN(const Box box, ClippedBox(row, image.image.cols, image.image.rows));
    if (row.category == kIgnoredCategory) {
      image.ignored.push_back(box);
      continue;
    }
    const auto [category, is_first] = number_of_category.try_emplace(row.category, names.size());
    if (is_first) names.push_back(row.category);
    image.objects.push_back({.category = category->second, .box = box});
  }
  if (names.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "a list without boxes: a detector needs a box for every object");
  }
  return TrainChannelDetector(images, names, options, seed);
}

}  // namespace victorious
