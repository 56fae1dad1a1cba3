// Fuzzes detectors by channels: whole files, and payloads with a valid checksum. An accepted model must search an
// image, and survive a write-read round trip.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/base/file.h"
#include "victorious/category/channels/channel_file.h"

namespace {

constexpr std::size_t kHeaderSize = 32;

void ParseAndSearch(std::span<const std::byte> bytes) {
  const auto model = victorious::ParseChannelModel(bytes, "fuzz");
  if (!model) {
    VICTORIOUS_CHECK(model.error().message.find('\n') == std::string::npos);
    return;
  }
  cv::Mat image(24, 30, CV_8UC3);
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 255);
  for (const victorious::ChannelBox& one : victorious::DetectByChannels(*model, image, 0)) {
    VICTORIOUS_CHECK(one.category < model->categories.size() && std::isfinite(one.score));
    VICTORIOUS_CHECK(one.probability >= 0 && one.probability <= 1 && !one.box.IsEmpty());
  }
  VICTORIOUS_CHECK(victorious::ParseChannelModel(EncodeChannelModel(*model), "again").has_value());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> input = std::as_bytes(std::span(data, size));
  ParseAndSearch(input);
  if (size >= kHeaderSize) {  // the payload after the header, with a matching size and checksum
    std::vector<std::byte> mended(input.begin(), input.end());
    const std::uint64_t payload_size = size - kHeaderSize;
    const std::uint64_t checksum = victorious::Checksum(input.subspan(kHeaderSize));
    std::memcpy(mended.data() + 16, &payload_size, sizeof(payload_size));
    std::memcpy(mended.data() + 24, &checksum, sizeof(checksum));
    ParseAndSearch(mended);
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  victorious::BoostedTrees trained{.trees = std::vector<victorious::FeatureTree>(9), .floors = {-300, -300}};
  for (std::size_t t = 0; t < trained.trees.size(); ++t) {
    const auto feature = static_cast<std::uint16_t>(97 * t);
    trained.trees[t] = {.feature = {feature, 3000, 7}, .threshold = {100, 20, 40}, .leaf = {-20, 30, 5, -9}};
  }
  victorious::ChannelModel model{.program_version = "1", .images = 3, .boxes = 40, .min_object_px = 16};
  model.categories.push_back({.name = "car", .length = 1.4, .width = 0.7, .detectors = {trained, trained, trained}});
  model.categories.push_back({.name = "person", .turns = false, .detectors = {trained}});
  const std::vector<std::byte> bytes = EncodeChannelModel(model);
  return {{reinterpret_cast<const char*>(bytes.data()), bytes.size()}};
}
