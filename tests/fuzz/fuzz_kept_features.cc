// Fuzzes the reader of the features of a frame, whose bytes come from the index: a row is refused, or has whole
// features that the search by image can use.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/store/sql/records.h"

namespace {

using victorious::kDescriptorSize;
using victorious::Keypoint;

constexpr const auto& kColumns = victorious::sql::kKeptFrameColumns;
constexpr std::size_t kHeadBytes = 5;  // width and height (16 bits), in how many bytes of the rest the keypoints are

class BytesRow final : public victorious::sql::Row {
 public:
  explicit BytesRow(std::span<const std::byte> bytes) {
    std::int16_t size = 0;
    std::memcpy(&size, bytes.data(), 2);
    width_ = size;
    std::memcpy(&size, bytes.data() + 2, 2);
    height_ = size;
    const std::span<const std::byte> rest = bytes.subspan(kHeadBytes);
    const std::size_t end = std::min(rest.size(), std::to_integer<std::size_t>(bytes[4]) * sizeof(Keypoint));
    keypoints_ = rest.first(end);
    descriptors_ = rest.subspan(end);
  }

  [[nodiscard]] bool IsNull(int /*column*/) const override { return false; }
  [[nodiscard]] std::int64_t Integer(int column) const override {
    if (column == kColumns.Index("image_width_px")) return width_;
    return column == kColumns.Index("image_height_px") ? height_ : 1;
  }
  [[nodiscard]] double Real(int /*column*/) const override { return 0.5; }
  [[nodiscard]] std::string Text(int /*column*/) const override { return ""; }
  [[nodiscard]] std::span<const std::byte> Blob(int column) const override {
    return column == kColumns.Index("keypoints") ? keypoints_ : descriptors_;
  }

 private:
  std::int64_t width_ = 0;
  std::int64_t height_ = 0;
  std::span<const std::byte> keypoints_;
  std::span<const std::byte> descriptors_;
};

// A frame with `count` keypoints and descriptors of `descriptor_bytes` each.
std::string Seed(int count, std::size_t descriptor_bytes) {
  std::string seed("\x40\x01\xF0\x00", 4);  // 320 x 240
  seed += static_cast<char>(count);
  for (int i = 0; i < count; ++i) {
    const Keypoint keypoint = {10.0F + static_cast<float>(i), 20, 3, 0.5F};
    seed.append(reinterpret_cast<const char*>(&keypoint), sizeof(keypoint));
  }
  return seed + std::string(static_cast<std::size_t>(count) * descriptor_bytes, '\x12');
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < kHeadBytes) return 0;
  const auto kept = victorious::sql::ReadKeptFrame(BytesRow(std::as_bytes(std::span(data, size))), "fuzz");
  if (!kept) {
    VICTORIOUS_CHECK(kept.error().message.find('\n') == std::string::npos);
    return 0;
  }
  const victorious::FeatureSet& features = kept->features;
  VICTORIOUS_CHECK(features.descriptors.size() == features.size() * kDescriptorSize);
  for (const Keypoint& keypoint : features.keypoints) {
    VICTORIOUS_CHECK(std::isfinite(keypoint.x) && std::isfinite(keypoint.y) && features.image_width > 0);
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  return {Seed(0, 0), Seed(2, kDescriptorSize), Seed(3, victorious::sql::kPackedDescriptorSize)};
}
