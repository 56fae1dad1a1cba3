// Fuzzes the reader of relit templates on disk: bytes are refused, or are those that the writer makes of what was read.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/base/file.h"
#include "victorious/base/packed_bytes.h"
#include "victorious/object/model/relit_template_folder.h"

using victorious::PackRelitTemplate;
using victorious::RelitTemplate;
using victorious::UnpackRelitTemplate;

namespace {

void CheckRead(std::span<const std::byte> bytes) {
  const auto one = UnpackRelitTemplate(bytes);
  if (!one) return;
  VICTORIOUS_CHECK(PackRelitTemplate(*one) == std::vector(bytes.begin(), bytes.end()));
  VICTORIOUS_CHECK(one->points_in_model.size() == one->features.size());
}

std::string ToText(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

// As they are, and with the checksum that a mutation would need.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
  CheckRead(bytes);
  victorious::ByteWriter writer;
  writer.Put(victorious::Checksum(bytes));
  writer.PutItems(bytes);
  CheckRead(writer.Take());
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  RelitTemplate one;
  one.features.image_width = 64;
  one.features.image_height = 48;
  one.features.keypoints = {{.x = 3, .y = 4, .scale_px = 2, .orientation_rad = 1}, {.x = 30, .y = 40}};
  one.features.descriptors.assign(one.features.size() * victorious::kDescriptorSize, 7);
  one.points_in_model = {{1, 2, 3}, {4, 5, 6}};
  one.shortened = victorious::ShortenDescriptors(one.features.descriptors);
  const std::string packed = ToText(PackRelitTemplate(one));
  constexpr std::size_t kHead = 16;  // checksum and length
  return {packed, packed.substr(kHead), ToText(PackRelitTemplate({})), ToText(PackRelitTemplate({})).substr(kHead)};
}
