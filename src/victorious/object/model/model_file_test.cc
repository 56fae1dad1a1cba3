#include "victorious/object/model/model_file.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/base/file.h"
#include "victorious/base/random.h"
#include "victorious/object/model/model_metadata.h"
#include "victorious/object/model/section_file.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

struct Features {
  std::vector<Keypoint> keypoints;
  std::vector<std::uint8_t> descriptors;
};

// A model of two views; the second has no features.
ObjectModel TestModel(std::size_t feature_count = 5) {
  const auto features = std::make_shared<Features>();
  Random random(7);
  for (std::size_t i = 0; i < feature_count; ++i) {
    features->keypoints.push_back({static_cast<float>(random.Uniform(0, 640)),
                                   static_cast<float>(random.Uniform(0, 480)), static_cast<float>(random.Uniform(1, 9)),
                                   static_cast<float>(random.Uniform(-3, 3))});
  }
  features->descriptors.resize(feature_count * kDescriptorSize);
  for (std::uint8_t& value : features->descriptors) value = static_cast<std::uint8_t>(random.Below(256));
  ObjectModel model{.name = "red box",
                    .id = "ignored",
                    .kind = ModelKind::kPhotos,
                    .engine = "opencv",
                    .options_json = R"({"octaves":4,"name":"ü"})",
                    .program_version = "0.1.0",
                    .length_m = 0.1};
  model.views.push_back({.source = "photos/box.png",
                         .width = 640,
                         .height = 480,
                         .first_feature = 0,
                         .feature_count = feature_count,
                         .outline = {{0.1, 0.2}, {600, 1.0 / 3}, {600, 470}, {-2, 470}}});
  model.views.push_back(
      {.source = "b", .width = 1, .height = 1, .first_feature = feature_count, .angles = ViewDirection{0.1, 1.2}});
  model.features = {features->keypoints, features->descriptors};
  model.storage = features;
  return model;
}

// Compares everything except id and storage.
bool AreEqual(const ObjectModel& a, const ObjectModel& b) {
  const auto views_equal = [](const ModelView& x, const ModelView& y) {
    const bool angles_equal = x.angles.has_value() == y.angles.has_value() &&
                              (!x.angles || (x.angles->azimuth_rad == y.angles->azimuth_rad &&
                                             x.angles->off_nadir_rad == y.angles->off_nadir_rad));
    return x.source == y.source && x.width == y.width && x.height == y.height && x.first_feature == y.first_feature &&
           x.feature_count == y.feature_count && x.outline == y.outline && angles_equal;
  };
  return a.name == b.name && a.kind == b.kind && a.engine == b.engine && a.options_json == b.options_json &&
         a.program_version == b.program_version && a.length_m == b.length_m &&
         std::ranges::equal(a.views, b.views, views_equal) &&
         std::ranges::equal(a.features.keypoints, b.features.keypoints) &&
         std::ranges::equal(a.features.descriptors, b.features.descriptors);
}

std::vector<std::byte> Encode(const ObjectModel& model) {
  const auto bytes = EncodeModel(model);
  EXPECT_TRUE(bytes) << bytes.error().message;
  return bytes.value_or(std::vector<std::byte>{});
}

// Keeps a copy of the bytes with the model.
Expected<ObjectModel> Parse(std::span<const std::byte> bytes) {
  const auto copy = std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end());
  return ParseModel(*copy, copy, "test.vmodel");
}

// A model file with the given metadata, keypoints and descriptors, and valid checksums.
Expected<ObjectModel> ParseParts(std::string_view metadata, std::span<const Keypoint> keypoints,
                                 std::span<const std::uint8_t> descriptors) {
  const std::array sections = {Section{"metadata", std::as_bytes(std::span(metadata))},
                               Section{"keypoint", std::as_bytes(keypoints)},
                               Section{"descript", std::as_bytes(descriptors)}};
  return Parse(EncodeSections(sections));
}

ErrorCode CodeOf(const Expected<ObjectModel>& model) {
  EXPECT_FALSE(model) << "accepted";
  return model ? ErrorCode::kInternal : model.error().code;
}

TEST(ModelFileTest, ModelRoundTrips) {
  const testing::ScratchFolder folder;
  const ObjectModel model = TestModel();
  ASSERT_TRUE(WriteModelFile(folder / "box.vmodel", model));
  const auto read = ReadModelFile(folder / "box.vmodel");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(AreEqual(*read, model));
  EXPECT_EQ(read->id.size(), 16u);
  EXPECT_EQ(read->ViewFeatures(1).size(), 0u);
}

TEST(ModelFileTest, PointsAndNeighboursRoundTrip) {
  ObjectModel model = TestModel();
  const std::vector<Point3> points = {{1, 2, 3}, {4, 5, 6}, {-7, 8, 9}, {0, 0, 0}, {1e-3F, 1, -1}};
  model.kind = ModelKind::kCad;
  model.points_in_model = points;
  model.views[0].neighbours = {1};
  const std::vector<std::byte> bytes = EncodeModel(model).value();
  const ObjectModel read = ParseModel(bytes, nullptr, "test").value();
  EXPECT_TRUE(AreEqual(read, model));
  EXPECT_TRUE(std::ranges::equal(read.points_in_model, points));
  EXPECT_EQ(read.views[0].neighbours, std::vector<std::uint32_t>{1});
  EXPECT_TRUE(read.views[1].neighbours.empty());
}

TEST(ModelFileTest, ThumbnailsRoundTripAndDoNotChangeTheId) {
  ObjectModel model = TestModel();
  const std::string id = Parse(Encode(model)).value().id;
  EXPECT_TRUE(Parse(Encode(model)).value().views[0].thumbnail.empty());
  const std::array images = {std::byte{1}, std::byte{2}, std::byte{3}};
  model.views[1].thumbnail = images;
  const ObjectModel read = Parse(Encode(model)).value();
  EXPECT_TRUE(read.views[0].thumbnail.empty());
  EXPECT_TRUE(std::ranges::equal(read.views[1].thumbnail, images));
  EXPECT_EQ(read.id, id);
}

TEST(ModelFileTest, RefusesThumbnailsOfWrongSize) {
  const std::vector<std::byte> whole = Encode(TestModel());
  const auto with = [&](const std::vector<std::uint32_t>& words) {
    std::vector<Section> sections = ParseSections(whole).value().sections;
    sections.push_back({"thumbs", std::as_bytes(std::span(words))});
    return Parse(EncodeSections(sections));
  };
  EXPECT_TRUE(with({0, 0}));
  EXPECT_TRUE(with({0, 4, 7}));
  EXPECT_EQ(CodeOf(with({})), ErrorCode::kDataLoss);
  EXPECT_EQ(CodeOf(with({0})), ErrorCode::kDataLoss);
  EXPECT_EQ(CodeOf(with({0, 5, 7})), ErrorCode::kDataLoss);
  EXPECT_EQ(CodeOf(with({4, 4, 7})), ErrorCode::kDataLoss);
  EXPECT_EQ(CodeOf(with({0, 0, 7})), ErrorCode::kDataLoss);
  EXPECT_EQ(CodeOf(with({0xFFFFFFFF, 0xFFFFFFFF, 7})), ErrorCode::kDataLoss);
}

TEST(ModelFileTest, RefusesInvalidPointsAndNeighbours) {
  ObjectModel model = TestModel();
  std::vector<Point3> points(4);
  model.points_in_model = points;
  EXPECT_FALSE(EncodeModel(model).has_value());
  points.resize(5);
  points[2].y = std::numeric_limits<float>::quiet_NaN();
  model.points_in_model = points;
  EXPECT_FALSE(EncodeModel(model).has_value());
  model.points_in_model = {};
  model.views[0].neighbours = {2};
  EXPECT_FALSE(EncodeModel(model).has_value());
  model.views[0].neighbours = {0};
  EXPECT_FALSE(EncodeModel(model).has_value());
}

TEST(ModelFileTest, FeaturesAreNotCopied) {
  const testing::ScratchFolder folder;
  ASSERT_TRUE(WriteModelFile(folder / "box.vmodel", TestModel()));
  const auto model = ReadModelFile(folder / "box.vmodel");
  ASSERT_TRUE(model);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(model->features.keypoints.data()) % kSectionAlignment, 0u);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(model->features.descriptors.data()) % kSectionAlignment, 0u);
}

TEST(ModelFileTest, IdIsThatOfTheContent) {
  const ObjectModel model = TestModel();
  const std::string id = Parse(Encode(model))->id;
  ObjectModel other = model;
  other.id = "another";
  EXPECT_EQ(Parse(Encode(other))->id, id) << "the id is not part of the content";
  other.options_json = "{}";
  other.program_version = "9.9.9";
  other.name = "blue box";
  other.views[0].source = "/elsewhere/box.png";
  EXPECT_EQ(Parse(Encode(other))->id, id) << "no detection depends on these";
  other = model;
  other.views[0].outline[0].x() += 1;
  EXPECT_NE(Parse(Encode(other))->id, id);
  other = TestModel(4);
  EXPECT_NE(Parse(Encode(other))->id, id);
}

TEST(ModelFileTest, UnalignedBytesAreCopied) {
  const std::vector<std::byte> bytes = Encode(TestModel());
  std::vector<std::byte> shifted(bytes.size() + 1);
  std::ranges::copy(bytes, shifted.begin() + 1);
  const auto model = ParseModel(std::span(shifted).subspan(1), nullptr, "test.vmodel");
  ASSERT_TRUE(model);
  EXPECT_TRUE(AreEqual(*model, TestModel()));
}

TEST(ModelFileTest, TruncationAnywhereIsAnError) {
  const std::vector<std::byte> bytes = Encode(TestModel());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(CodeOf(Parse(cut)), ErrorCode::kDataLoss) << size;
  }
}

TEST(ModelFileTest, FlippedBitIsAnErrorOrHarmless) {
  const ObjectModel model = TestModel();
  std::vector<std::byte> bytes = Encode(model);
  const std::size_t header_and_table = 64 + 3 * 32;
  std::size_t harmless = 0;
  for (std::size_t bit = 0; bit < bytes.size() * 8; bit += bit < header_and_table * 8 ? 1 : 7) {
    bytes[bit / 8] ^= std::byte{1} << (bit % 8);
    if (const auto read = Parse(bytes)) {
      EXPECT_GE(bit / 8, header_and_table);
      EXPECT_TRUE(AreEqual(*read, model)) << bit;
      ++harmless;
    }
    bytes[bit / 8] ^= std::byte{1} << (bit % 8);
  }
  EXPECT_LT(harmless, 3 * kSectionAlignment * 8) << "only the gaps between sections are not checked";
}

TEST(ModelFileTest, RefusesTrailingBytesAndOtherFiles) {
  std::vector<std::byte> bytes = Encode(TestModel());
  bytes.resize(bytes.size() + 1);
  EXPECT_EQ(CodeOf(Parse(bytes)), ErrorCode::kDataLoss);
  const std::string text = "this is not a model, and long enough to hold a header of 64 bytes";
  const auto model = Parse(std::as_bytes(std::span(text)));
  EXPECT_EQ(CodeOf(model), ErrorCode::kDataLoss);
  EXPECT_THAT(model.error().message, HasSubstr("test.vmodel: not a model file"));
  const testing::ScratchFolder folder;
  EXPECT_EQ(CodeOf(ReadModelFile(folder / "none.vmodel")), ErrorCode::kNotFound);
}

// The bytes of a model file of another format version.
std::vector<std::byte> EncodeAsVersion(int version) {
  std::vector<std::byte> bytes = Encode(TestModel());
  bytes[8] = static_cast<std::byte>(version);
  const std::uint64_t checksum = Checksum(std::span(bytes).first(56));
  std::memcpy(bytes.data() + 56, &checksum, sizeof(checksum));
  return bytes;
}

TEST(ModelFileTest, RefusesANewerVersion) {
  const auto model = Parse(EncodeAsVersion(3));
  EXPECT_EQ(CodeOf(model), ErrorCode::kUnsupported);
  EXPECT_THAT(model.error().message, HasSubstr("format 3; this program reads up to 2"));
}

TEST(ModelFileTest, OlderVersionMustBeRebuilt) {
  const auto model = Parse(EncodeAsVersion(1));
  EXPECT_EQ(CodeOf(model), ErrorCode::kUnsupported);
  EXPECT_EQ(model.error().message,
            "test.vmodel: made by an older version (format 1; this program reads from 2): make the model again, by "
            "`victorious model add`");
}

TEST(ModelFileTest, UnknownKindIsDataLoss) {
  std::string metadata = EncodeMetadata(TestModel());
  const std::size_t at = metadata.find("\"photos\"");
  ASSERT_NE(at, std::string::npos);
  metadata.replace(at, 8, "\"poems\"");
  const auto model = ParseMetadata(metadata);
  EXPECT_EQ(CodeOf(model), ErrorCode::kDataLoss);
}

TEST(ModelFileTest, UnknownSectionIsIgnored) {
  const ObjectModel model = TestModel();
  const std::string metadata = EncodeMetadata(model);
  const std::string points = "3-D points";
  const std::array sections = {Section{"points3d", std::as_bytes(std::span(points))},
                               Section{"metadata", std::as_bytes(std::span(metadata))},
                               Section{"keypoint", std::as_bytes(model.features.keypoints)},
                               Section{"descript", std::as_bytes(model.features.descriptors)}};
  const auto read = Parse(EncodeSections(sections));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(AreEqual(*read, model));
  EXPECT_EQ(CodeOf(Parse(EncodeSections(std::span(sections).first(3)))), ErrorCode::kDataLoss) << "no descriptors";
}

TEST(ModelFileTest, RefusesDuplicateSections) {
  const std::array sections = {Section{"metadata", {}}, Section{"metadata", {}}};
  EXPECT_EQ(CodeOf(Parse(EncodeSections(sections))), ErrorCode::kDataLoss);
}

TEST(ModelFileTest, RefusesInconsistentSizes) {
  const ObjectModel model = TestModel();
  const std::string metadata = EncodeMetadata(model);
  const auto& [keypoints, descriptors] = model.features;
  ASSERT_TRUE(ParseParts(metadata, keypoints, descriptors));
  EXPECT_EQ(CodeOf(ParseParts(metadata, keypoints.first(4), descriptors)), ErrorCode::kDataLoss);
  EXPECT_EQ(CodeOf(ParseParts(metadata, keypoints, descriptors.first(127))), ErrorCode::kDataLoss);
  EXPECT_EQ(CodeOf(ParseParts(metadata, keypoints.first(4), descriptors.first(4 * kDescriptorSize))),
            ErrorCode::kDataLoss)
      << "fewer than the views say";
}

TEST(ModelFileTest, RefusesInvalidKeypoints) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const ObjectModel model = TestModel(1);
  const std::string metadata = EncodeMetadata(model);
  const std::array bad = {Keypoint{kNan, 1, 1, 0}, Keypoint{1, kInfinity, 1, 0}, Keypoint{1, 1, 0, 0},
                          Keypoint{1, 1, -1, 0},   Keypoint{1, 1, kNan, 0},      Keypoint{1, 1, 1, kNan}};
  for (const Keypoint& keypoint : bad) {
    EXPECT_EQ(CodeOf(ParseParts(metadata, std::span(&keypoint, 1), model.features.descriptors)), ErrorCode::kDataLoss);
    ObjectModel unwritable = model;
    unwritable.features.keypoints = std::span(&keypoint, 1);
    EXPECT_EQ(EncodeModel(unwritable).error().code, ErrorCode::kInvalidArgument);
  }
}

TEST(ModelFileTest, RefusesInvalidViews) {
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(ObjectModel&)>> faults = {
      [](ObjectModel& m) { m.views.clear(); },
      [](ObjectModel& m) { m.name.clear(); },
      [](ObjectModel& m) { m.length_m = -1; },
      [](ObjectModel& m) { m.length_m = 0; },
      [](ObjectModel& m) { m.views[0].width = 0; },
      [](ObjectModel& m) { m.views[0].height = -5; },
      [](ObjectModel& m) { m.views[0].first_feature = 1; },
      [](ObjectModel& m) { m.views[0].feature_count = ~std::uint64_t{0}; },
      [](ObjectModel& m) { m.views[1].first_feature = 0; },
      [](ObjectModel& m) { m.views[1].feature_count = 1; },
      [](ObjectModel& m) { m.views.pop_back(), m.views[0].feature_count = 4; },
      [](ObjectModel& m) { m.views[0].outline[1].x() = kNan; },
      [](ObjectModel& m) { m.views[0].outline[1].y() = 1e30; },
      [](ObjectModel& m) { m.views[0].outline.resize(2); },
      [](ObjectModel& m) { m.views[1].angles->azimuth_rad = kNan; },
  };
  for (std::size_t i = 0; i < faults.size(); ++i) {
    ObjectModel model = TestModel();
    faults[i](model);
    const auto encoded = EncodeModel(model);
    ASSERT_FALSE(encoded) << i;
    EXPECT_EQ(encoded.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(CodeOf(ParseParts(EncodeMetadata(model), model.features.keypoints, model.features.descriptors)),
              ErrorCode::kDataLoss)
        << i;
  }
}

TEST(ModelFileTest, RefusesInvalidMetadata) {
  const ObjectModel model = TestModel();
  const std::string whole = EncodeMetadata(model);
  std::vector<std::string> texts = {"",
                                    "null",
                                    "[]",
                                    "{}",
                                    "{\"name\":1}",
                                    "\xff\xfe",
                                    whole + "x",
                                    std::string(1'000'000, '['),
                                    "{\"a\":" + std::string(100'000, '[')};
  for (const std::string_view from : {"640", "\"first_feature\":0", "0.2", "[600", "\"photos/box.png\""}) {
    for (const std::string_view to : {"1e400", "true", "null", "[[[[[[[[[[]]]]]]]]]]", "{}"}) {
      std::string text = whole;
      text.replace(text.find(from), from.size(), to);
      texts.push_back(text);
    }
  }
  for (const std::string& text : texts) {
    EXPECT_EQ(CodeOf(ParseParts(text, model.features.keypoints, model.features.descriptors)), ErrorCode::kDataLoss)
        << text.substr(0, 400);
  }
}

TEST(ModelFileTest, NonUtf8NameIsWritten) {
  ObjectModel model = TestModel();
  model.views[0].source = "photo\xff.png";
  const auto read = Parse(Encode(model));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->views[0].source, "photo\xEF\xBF\xBD.png");
}

TEST(ModelFileTest, RandomBytesNeverCrash) {
  Random random(11);
  const std::vector<std::byte> whole = Encode(TestModel(2));
  for (int round = 0; round < 20'000; ++round) {
    std::vector<std::byte> bytes = whole;
    for (std::uint32_t changes = 1 + random.Below(6); changes > 0; --changes) {
      bytes[random.Below(static_cast<std::uint32_t>(std::min<std::size_t>(bytes.size(), 160)))] =
          static_cast<std::byte>(random.Next());
    }
    // With valid checksums of header and table, so that their content is checked.
    const std::uint64_t table = Checksum(std::span(bytes).subspan(64, 96));
    std::memcpy(bytes.data() + 24, &table, sizeof(table));
    const std::uint64_t header = Checksum(std::span(bytes).first(56));
    std::memcpy(bytes.data() + 56, &header, sizeof(header));
    static_cast<void>(Parse(bytes));
  }
}

}  // namespace
}  // namespace victorious
