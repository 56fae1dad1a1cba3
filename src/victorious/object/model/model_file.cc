#include "victorious/object/model/model_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/base/file.h"
#include "victorious/object/model/model_metadata.h"
#include "victorious/object/model/section_file.h"

namespace victorious {
namespace {

constexpr std::string_view kMetadataTag = "metadata";
constexpr std::string_view kKeypointsTag = "keypoint";
constexpr std::string_view kDescriptorsTag = "descript";
constexpr std::string_view kPointsTag = "points3";     // only in models with depth
constexpr std::string_view kThumbnailsTag = "thumbs";  // only in models with thumbnails
constexpr std::string_view kSurfacesTag = "surfaces";  // only in models with surfaces

Expected<std::span<const std::byte>> Find(const SectionFile& file, std::string_view tag) {
  const auto it = std::ranges::find(file.sections, tag, &Section::tag);
  if (it == file.sections.end()) return Fail(ErrorCode::kDataLoss, fmt::format("damaged (no section {})", tag));
  return it->bytes;
}

bool IsFinite(const Point3& point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
}

Status Validate(const ObjectModel& model) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateMetadata(model, model.features.size()));
  if (!std::ranges::all_of(model.features.keypoints, IsUsable)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("model {}: a keypoint without a finite position and a scale above 0", model.name));
  }
  const bool points_fit = model.points_in_model.empty() || model.points_in_model.size() == model.features.size();
  if (points_fit && std::ranges::all_of(model.points_in_model, IsFinite)) return {};
  return Fail(
      ErrorCode::kInvalidArgument,
      fmt::format(
          "model {}: {} points on the object for {} features, expected one finite point per feature, or no points",
          model.name, model.points_in_model.size(), model.features.size()));
}

Expected<FeatureView> ParseFeatures(const SectionFile& file) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto keypoints, Find(file, kKeypointsTag));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto descriptors, Find(file, kDescriptorsTag));
  const std::size_t count = keypoints.size() / sizeof(Keypoint);
  if (keypoints.size() % sizeof(Keypoint) != 0 || descriptors.size() % kDescriptorSize != 0 ||
      descriptors.size() / kDescriptorSize != count) {
    return Fail(ErrorCode::kDataLoss, fmt::format("damaged ({} bytes of keypoints, {} of descriptors)",
                                                  keypoints.size(), descriptors.size()));
  }
  return FeatureView{{reinterpret_cast<const Keypoint*>(keypoints.data()), count},
                     {reinterpret_cast<const std::uint8_t*>(descriptors.data()), descriptors.size()}};
}

Expected<std::span<const Point3>> ParsePoints(const SectionFile& file) {
  const auto it = std::ranges::find(file.sections, kPointsTag, &Section::tag);
  if (it == file.sections.end()) return std::span<const Point3>();
  if (it->bytes.size() % sizeof(Point3) != 0) {
    return Fail(ErrorCode::kDataLoss, fmt::format("damaged ({} bytes of points)", it->bytes.size()));
  }
  return std::span(reinterpret_cast<const Point3*>(it->bytes.data()), it->bytes.size() / sizeof(Point3));
}

// A per-view byte block: the thumbnail or the surface.
using ViewBlock = std::span<const std::byte> ModelView::*;

Status ParseViewBlocks(const SectionFile& file, std::string_view tag, ViewBlock block, std::vector<ModelView>& views) {
  const auto it = std::ranges::find(file.sections, tag, &Section::tag);
  if (it == file.sections.end()) return {};
  const std::size_t table = views.size() * sizeof(std::uint32_t);
  const std::span<const std::byte> bytes = it->bytes;
  std::size_t end = table;
  for (std::size_t i = 0; i < views.size() && end <= bytes.size(); ++i) {
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + i * sizeof(size), sizeof(size));
    if (size <= bytes.size() - end) views[i].*block = bytes.subspan(end, size);
    end += size;
  }
  if (end == bytes.size()) return {};
  return Fail(ErrorCode::kDataLoss, fmt::format("damaged ({} bytes of {})", bytes.size(), tag));
}

// Encodes the sizes of the blocks, then the blocks; empty if no view has one.
std::vector<std::byte> EncodeViewBlocks(const ObjectModel& model, ViewBlock block) {
  std::vector<std::byte> bytes;
  const auto append = [&](std::span<const std::byte> more) { bytes.insert(bytes.end(), more.begin(), more.end()); };
  if (std::ranges::all_of(model.views, [&](const ModelView& view) { return (view.*block).empty(); })) return bytes;
  for (const ModelView& view : model.views) {
    const auto size = static_cast<std::uint32_t>((view.*block).size());
    append(std::as_bytes(std::span(&size, 1)));
  }
  for (const ModelView& view : model.views) append(view.*block);
  return bytes;
}

// The id hashes only the data that the search depends on, not the paths of the images or the program version.
std::string ComputeModelId(const ObjectModel& model) {
  std::string text = fmt::format("{} {} {:016x} {:016x}", ToText(model.kind), model.engine,
                                 Checksum(std::as_bytes(model.features.keypoints)),
                                 Checksum(std::as_bytes(model.features.descriptors)));
  for (const ModelView& view : model.views) {
    text += fmt::format(" {}", view.feature_count);
    for (const Eigen::Vector2d& corner : view.outline) text += fmt::format(" {},{}", corner.x(), corner.y());
  }
  return fmt::format("{:016x}", Checksum(std::as_bytes(std::span(text))));
}

// `bytes` must be aligned to alignof(Keypoint).
Expected<ObjectModel> ParseAligned(std::span<const std::byte> bytes, std::shared_ptr<const void> storage) {
  VICTORIOUS_ASSIGN_OR_RETURN(const SectionFile file, ParseSections(bytes));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto metadata, Find(file, kMetadataTag));
  VICTORIOUS_ASSIGN_OR_RETURN(ObjectModel model,
                              ParseMetadata({reinterpret_cast<const char*>(metadata.data()), metadata.size()}));
  VICTORIOUS_ASSIGN_OR_RETURN(model.features, ParseFeatures(file));
  VICTORIOUS_ASSIGN_OR_RETURN(model.points_in_model, ParsePoints(file));
  VICTORIOUS_RETURN_IF_ERROR(ParseViewBlocks(file, kThumbnailsTag, &ModelView::thumbnail, model.views));
  VICTORIOUS_RETURN_IF_ERROR(ParseViewBlocks(file, kSurfacesTag, &ModelView::surface, model.views));
  if (Status status = Validate(model); !status) {
    return Fail(ErrorCode::kDataLoss, fmt::format("damaged ({})", status.error().message));
  }
  model.id = ComputeModelId(model);
  model.storage = std::move(storage);
  return model;
}

}  // namespace

Expected<std::vector<std::byte>> EncodeModel(const ObjectModel& model) {
  VICTORIOUS_CHECK(model.features.descriptors.size() == model.features.size() * kDescriptorSize);
  VICTORIOUS_RETURN_IF_ERROR(Validate(model));
  const std::string metadata = EncodeMetadata(model);
  std::vector sections = {Section{kMetadataTag, std::as_bytes(std::span(metadata))},
                          Section{kKeypointsTag, std::as_bytes(model.features.keypoints)},
                          Section{kDescriptorsTag, std::as_bytes(model.features.descriptors)}};
  if (!model.points_in_model.empty()) sections.push_back({kPointsTag, std::as_bytes(model.points_in_model)});
  const std::vector<std::byte> thumbnails = EncodeViewBlocks(model, &ModelView::thumbnail);
  if (!thumbnails.empty()) sections.push_back({kThumbnailsTag, thumbnails});
  const std::vector<std::byte> surfaces = EncodeViewBlocks(model, &ModelView::surface);
  if (!surfaces.empty()) sections.push_back({kSurfacesTag, surfaces});
  return EncodeSections(sections);
}

Status WriteModelFile(const std::filesystem::path& path, const ObjectModel& model) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes, EncodeModel(model));
  return WriteFileAtomically(path, bytes);
}

Expected<ObjectModel> ReadModelFile(const std::filesystem::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const MappedFile> file, MappedFile::Open(path));
  Expected<ObjectModel> model = ParseModel(file->bytes(), file, path.string());
  file->ReleasePages();  // the checksums have read all of it; a search needs a part
  return model;
}

Expected<ObjectModel> ParseModel(std::span<const std::byte> bytes, std::shared_ptr<const void> storage,
                                 const std::string& name_for_errors) {
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(Keypoint) != 0) {
    auto copy = std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end());
    bytes = *copy;
    storage = std::move(copy);
  }
  Expected<ObjectModel> model = ParseAligned(bytes, std::move(storage));
  if (model) return model;
  Error error = std::move(model).error();
  error.message += ": make the model again, by `victorious model add`";
  return std::unexpected(std::move(error).WithContext(name_for_errors));
}

}  // namespace victorious
