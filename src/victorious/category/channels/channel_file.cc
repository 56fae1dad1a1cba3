#include "victorious/category/channels/channel_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/base/packed_bytes.h"
#include "victorious/base/sealed_bytes.h"
#include "victorious/kernels/window_trees.h"

namespace victorious {
namespace {

constexpr FileMagic kChannelMagic = {0x8A, 'V', 'C', 'H', 'N', 0x0D, 0x0A, 0x1A};
constexpr std::uint32_t kChannelVersion = 1;
constexpr std::size_t kMaxChannelBytes = std::size_t{1} << 26;
constexpr std::size_t kTreeBytes = 13;

Error DamagedChannels(const std::string& name, const char* how) {
  return {ErrorCode::kDataLoss, fmt::format("{}: a damaged detector by channels ({}): train it again", name, how)};
}

bool IsCategoryName(std::string_view name) {
  constexpr std::size_t kMaxBytes = 1000;
  constexpr char kDelete = 0x7f;
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == kDelete; };
  return !name.empty() && name.size() <= kMaxBytes && std::ranges::none_of(name, is_control);
}

void PutTrees(const BoostedTrees& trained, ByteWriter& writer) {
  writer.Put(std::uint64_t{trained.trees.size()});
  for (const FeatureTree& tree : trained.trees) {
    for (const std::uint16_t feature : tree.feature) writer.Put(feature);
    for (const std::uint8_t threshold : tree.threshold) writer.Put(threshold);
    for (const std::int8_t leaf : tree.leaf) writer.Put(leaf);
  }
  writer.PutItems(std::span<const std::int16_t>(trained.floors));
}

// Trees that the kernel can run: std::nullopt otherwise.
std::optional<BoostedTrees> GetTrees(ByteReader& reader) {
  BoostedTrees trained;
  trained.trees.resize(reader.GetCount(kTreeBytes));
  if (trained.trees.size() > kernels::kMaxWindowTrees) return std::nullopt;
  for (FeatureTree& tree : trained.trees) {
    for (std::uint16_t& feature : tree.feature) {
      feature = reader.Get<std::uint16_t>();
      if (feature >= kWindowFeatures) return std::nullopt;
    }
    for (std::uint8_t& threshold : tree.threshold) threshold = reader.Get<std::uint8_t>();
    for (std::int8_t& leaf : tree.leaf) {
      leaf = reader.Get<std::int8_t>();
      if (leaf == std::numeric_limits<std::int8_t>::min()) return std::nullopt;  // sums of 256 must fit 16 bits
    }
  }
  trained.floors = reader.GetItems<std::int16_t>();
  const std::size_t stages = (trained.trees.size() + kernels::kTreesPerStage - 1) / kernels::kTreesPerStage;
  if (trained.floors.size() != stages) return std::nullopt;
  return trained;
}

std::optional<ChannelCategory> GetCategory(ByteReader& reader) {
  ChannelCategory category;
  category.name = reader.GetText();
  category.length = reader.Get<double>();
  category.width = reader.Get<double>();
  category.turns = reader.Get<bool>();
  category.calibration.slope = reader.Get<double>();
  category.calibration.offset = reader.Get<double>();
  const auto is_side = [](double side) { return side >= 1 / kMaxChannelLength && side <= kMaxChannelLength; };
  if (!IsCategoryName(category.name) || !is_side(category.length) || !is_side(category.width) ||
      !std::isfinite(category.calibration.slope) || !std::isfinite(category.calibration.offset)) {
    return std::nullopt;
  }
  for (int h = 0; h < (category.turns ? kTrainedHeadings : 1); ++h) {
    std::optional<BoostedTrees> trained = GetTrees(reader);
    if (!trained) return std::nullopt;
    category.detectors.push_back(*std::move(trained));
  }
  return category;
}

std::optional<ChannelModel> GetModel(std::span<const std::byte> payload) {
  ByteReader reader(payload);
  ChannelModel model;
  model.program_version = reader.GetText();
  model.images = reader.Get<std::int32_t>();
  model.boxes = reader.Get<std::int32_t>();
  model.min_object_px = reader.Get<double>();
  constexpr double kMaxObject_px = 10000;
  const bool is_searched = model.min_object_px >= 1 && model.min_object_px <= kMaxObject_px;
  if (!is_searched || model.images < 0 || model.boxes < 0) return std::nullopt;
  constexpr std::size_t kMinCategoryBytes = 8;
  const std::size_t count = reader.GetCount(kMinCategoryBytes);
  if (count == 0 || count > kMaxChannelCategories) return std::nullopt;
  std::set<std::string> names;
  for (std::size_t c = 0; c < count; ++c) {
    std::optional<ChannelCategory> category = GetCategory(reader);
    if (!category || !names.insert(category->name).second) return std::nullopt;
    model.categories.push_back(*std::move(category));
  }
  if (!reader.IsAtEnd()) return std::nullopt;
  return model;
}

}  // namespace

bool IsChannelModelFile(std::span<const std::byte> bytes) { return HasMagic(bytes, kChannelMagic); }

std::vector<std::byte> EncodeChannelModel(const ChannelModel& model) {
  ByteWriter writer;
  writer.PutText(model.program_version);
  writer.Put(std::int32_t{model.images});
  writer.Put(std::int32_t{model.boxes});
  writer.Put(model.min_object_px);
  writer.Put(std::uint64_t{model.categories.size()});
  for (const ChannelCategory& category : model.categories) {
    writer.PutText(category.name);
    writer.Put(category.length);
    writer.Put(category.width);
    writer.Put(category.turns);
    writer.Put(category.calibration.slope);
    writer.Put(category.calibration.offset);
    for (const BoostedTrees& trained : category.detectors) PutTrees(trained, writer);
  }
  return Seal(kChannelMagic, kChannelVersion, writer.Take());
}

Status WriteChannelModel(const std::filesystem::path& path, const ChannelModel& model) {
  return WriteFileAtomically(path, EncodeChannelModel(model));
}

Expected<ChannelModel> ReadChannelModel(const std::filesystem::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, kMaxChannelBytes));
  return ParseChannelModel(std::as_bytes(std::span(bytes)), path.string());
}

Expected<ChannelModel> ParseChannelModel(std::span<const std::byte> bytes, const std::string& name_for_errors) {
  if (!IsChannelModelFile(bytes)) {
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: not a detector by channels", name_for_errors));
  }
  const std::optional<SealedHeader> header = ReadSealedHeader(bytes);
  if (!header) return std::unexpected(DamagedChannels(name_for_errors, "it ends in its header"));
  if (header->version != kChannelVersion) {
    return Fail(ErrorCode::kUnsupported, fmt::format("{}: a detector by channels of format {}, not {}: train it again",
                                                     name_for_errors, header->version, kChannelVersion));
  }
  const std::span<const std::byte> payload = PayloadOf(bytes);
  if (const char* fault = FaultOfPayload(*header, payload)) {
    return std::unexpected(DamagedChannels(name_for_errors, fault));
  }
  std::optional<ChannelModel> model = GetModel(payload);
  if (!model) return std::unexpected(DamagedChannels(name_for_errors, "its content is out of range"));
  return *std::move(model);
}

}  // namespace victorious
