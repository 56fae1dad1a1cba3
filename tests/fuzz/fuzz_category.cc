// Fuzzes category models and image lists: whole files, and payloads with a valid checksum. An accepted model must
// classify, and survive a write-read round trip.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/base/file.h"
#include "victorious/base/random.h"
#include "victorious/category/category_file.h"
#include "victorious/category/common/category_list.h"

namespace {

using victorious::CategoryModel;

constexpr std::size_t kHeaderSize = 32;

victorious::FeatureSet SomeFeatures(std::uint64_t seed) {
  victorious::Random random(seed);
  victorious::FeatureSet features{.image_width = 60, .image_height = 60};
  for (int i = 0; i < 12; ++i) {
    features.keypoints.push_back({static_cast<float>(random.Uniform(0, 60)), static_cast<float>(random.Uniform(0, 60)),
                                  static_cast<float>(random.Uniform(1, 3)), static_cast<float>(random.Uniform(-3, 3))});
    for (std::size_t k = 0; k < victorious::kDescriptorSize; ++k)
      features.descriptors.push_back(static_cast<std::uint8_t>(random.Below(256)));
  }
  return features;
}

void ParseAndUse(std::span<const std::byte> bytes) {
  const auto model = victorious::ParseCategoryModel(bytes, "fuzz");
  if (!model) {
    VICTORIOUS_CHECK(model.error().message.find('\n') == std::string::npos);
    return;
  }
  const victorious::QuantisedImage image = QuantiseFeatures(*model, SomeFeatures(1));
  for (const auto method : {victorious::CategoryMethod::kPhrases, victorious::CategoryMethod::kWords}) {
    const auto result = Classify(*model, image, method);
    VICTORIOUS_CHECK(result.scores.size() == model->nodes.size());
  }
  VICTORIOUS_CHECK(victorious::ParseCategoryModel(EncodeCategoryModel(*model), "again").has_value());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> input = std::as_bytes(std::span(data, size));
  ParseAndUse(input);
  if (size >= kHeaderSize) {  // the payload after the header, with a matching size and checksum
    std::vector<std::byte> mended(input.begin(), input.end());
    const std::uint64_t payload_size = size - kHeaderSize;
    const std::uint64_t checksum = victorious::Checksum(input.subspan(kHeaderSize));
    std::memcpy(mended.data() + 16, &payload_size, sizeof(payload_size));
    std::memcpy(mended.data() + 24, &checksum, sizeof(checksum));
    ParseAndUse(mended);
  }
  const auto rows = victorious::ParseCategoryList({reinterpret_cast<const char*>(data), size}, "list.csv");
  if (rows) {
    for (const auto& row : *rows) VICTORIOUS_CHECK(!row.image.empty() && (!row.box || !row.box->IsEmpty()));
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  std::vector<victorious::CategoryExample> examples;
  for (int i = 0; i < 6; ++i)
    examples.push_back(
        {.category = i % 2 == 0 ? "a" : "b/c", .features = SomeFeatures(static_cast<std::uint64_t>(i)), .image = i});
  std::vector<std::string> seeds = {"image,category,x0,y0,x1,y1\na.jpg,b,1,2,3,4\n\"c,d\",e,,,,\n",
                                    "image,mark\na.png,right\nb.png,wrong\n"};
  using victorious::CategoryScoring;
  for (const CategoryScoring scoring : {CategoryScoring::kLinear, CategoryScoring::kLikelihood}) {
    victorious::CategoryOptions options{.scoring = scoring};
    options.vocabulary.words = 8;
    options.linear.phrases.word_clusters = 2;
    options.thesis.grammar.word_fraction = 1;
    if (scoring == CategoryScoring::kLinear) options.linear.shapes = {.weight = 1, .dimensions = 4};
    auto model = TrainCategories(examples, options);
    VICTORIOUS_CHECK(model.has_value());
    if (scoring == CategoryScoring::kLinear)
      model->windows = {.background_category = "a", .windows_per_background = 12};
    const std::vector<std::byte> bytes = EncodeCategoryModel(*model);
    seeds.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  return seeds;
}
