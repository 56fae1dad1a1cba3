// Fuzzes model files: as a whole file, and as one section (metadata, keypoints, thumbnails, surfaces) of a file with
// valid checksums. Accepted models are also drawn.
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include <opencv2/core.hpp>

#include "victorious/base/check.h"
#include "victorious/input/image/image_file.h"
#include "victorious/object/model/model_file.h"
#include "victorious/object/model/section_file.h"
#include "victorious/object/model/view_sheet.h"
#include "victorious/object/model/view_surface.h"

namespace {

using victorious::Keypoint;
using victorious::ObjectModel;
using victorious::Section;

constexpr Keypoint kKeypoint = {1, 2, 3, 0.5F};
constexpr std::array<std::uint8_t, victorious::kDescriptorSize> kDescriptor = {7, 8, 9};

std::span<const std::byte> Bytes(const std::string& text) { return std::as_bytes(std::span(text)); }

// An accepted model must be completely readable, and survive a write-read round trip.
void ParseAndUse(std::span<const std::byte> bytes) {
  const auto model = victorious::ParseModel(bytes, nullptr, "fuzz");
  if (!model) return;
  float sum = 0;
  for (std::size_t view = 0; view < model->views.size(); ++view) {
    const victorious::FeatureView features = model->ViewFeatures(view);
    for (std::size_t i = 0; i < features.size(); ++i) sum += features.keypoints[i].x + features.Descriptor(i).back();
  }
  VICTORIOUS_CHECK(sum == sum);
  std::ignore = victorious::DrawViewSheet(*model);
  for (const victorious::ModelView& view : model->views) {
    if (const auto surface = victorious::DecodeSurface(view.surface, "fuzz")) {
      VICTORIOUS_CHECK(surface->grey.size() == surface->depth_map.depth_m.size());
    }
  }
  VICTORIOUS_CHECK(victorious::EncodeModel(*model).has_value());
}

std::string Encode(const ObjectModel& model) {
  const auto bytes = victorious::EncodeModel(model);
  VICTORIOUS_CHECK(bytes.has_value());
  return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

std::string DescriptionOf(const std::string& file) {
  const auto sections = victorious::ParseSections(Bytes(file));
  VICTORIOUS_CHECK(sections.has_value());
  const std::span<const std::byte> description = sections->sections.front().bytes;
  return {reinterpret_cast<const char*>(description.data()), description.size()};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> input = std::as_bytes(std::span(data, size));
  ParseAndUse(input);

  const auto keypoints = std::as_bytes(std::span(&kKeypoint, 1));
  const auto descriptors = std::as_bytes(std::span(kDescriptor));
  const std::array described = {Section{"metadata", input}, Section{"keypoint", keypoints},
                                Section{"descript", descriptors}};
  ParseAndUse(victorious::EncodeSections(described));

  ObjectModel model{.name = "fuzz", .kind = victorious::ModelKind::kPhotos};
  model.views.push_back({.width = 1, .height = 1, .feature_count = 1});
  model.features = {std::span(&kKeypoint, 1), kDescriptor};
  const std::string description = DescriptionOf(Encode(model));
  const std::array featured = {Section{"metadata", Bytes(description)}, Section{"keypoint", input},
                               Section{"descript", descriptors}};
  ParseAndUse(victorious::EncodeSections(featured));

  // As the whole section, and as an image with a matching size.
  std::string sized(sizeof(std::uint32_t), '\0');
  const auto image_size = static_cast<std::uint32_t>(size);
  std::memcpy(sized.data(), &image_size, sizeof(image_size));
  sized.append(reinterpret_cast<const char*>(data), size);
  for (const char* tag : {"thumbs", "surfaces"}) {
    for (const std::span<const std::byte> images : {input, Bytes(sized)}) {
      const std::array sections = {Section{"metadata", Bytes(description)}, Section{"keypoint", keypoints},
                                   Section{"descript", descriptors}, Section{tag, images}};
      ParseAndUse(victorious::EncodeSections(sections));
    }
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  ObjectModel model{.name = "box",
                    .kind = victorious::ModelKind::kPhotos,
                    .engine = "opencv",
                    .options_json = "{}",
                    .program_version = "0.1.0",
                    .length_m = 0.3};
  model.views.push_back({.source = "box.png",
                         .width = 64,
                         .height = 48,
                         .feature_count = 1,
                         .outline = {{0, 0}, {64, 0}, {64, 48}},
                         .angles = victorious::ViewDirection{1, 0.5}});
  model.features = {std::span(&kKeypoint, 1), kDescriptor};
  const auto jpeg = victorious::EncodeJpeg(cv::Mat(9, 12, CV_8UC3, cv::Scalar(200, 90, 30)));
  VICTORIOUS_CHECK(jpeg.has_value());
  model.views[0].thumbnail = *jpeg;
  const auto surface =
      victorious::EncodeSurface({cv::Mat(9, 12, CV_8UC1, cv::Scalar(90)),
                                 {{{100, 100, 6, 4.5, 12, 9}, {}}, cv::Mat(9, 12, CV_32FC1, cv::Scalar(5))}});
  VICTORIOUS_CHECK(surface.has_value());
  model.views[0].surface = *surface;
  const std::string file = Encode(model);
  const std::string description = DescriptionOf(file);
  return {file,
          file.substr(0, file.size() / 2),
          std::string(reinterpret_cast<const char*>(jpeg->data()), jpeg->size()),
          std::string(reinterpret_cast<const char*>(surface->data()), surface->size()),
          std::string("\x04\0\0\0abcd", 8),
          description,
          description.substr(0, description.size() / 2),
          std::string(5000, '['),
          std::string(reinterpret_cast<const char*>(&kKeypoint), sizeof(kKeypoint)),
          std::string(sizeof(kKeypoint), '\xff')};
}
