#include "victorious/category/network/detector_file.h"

#include <cstring>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/base/file.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

DetectorModel SomeDetector() {
  DetectorModel model{.program_version = "1",
                      .source = "net.onnx",
                      .trained_on = "streets from above",
                      .classes = {"vehicle/car", "boat"},
                      .settings = DefaultSettings(DetectorLayout::kNanodet)};
  model.files = {.network = std::string("\0net", 4), .weights = "weights"};
  return model;
}

TEST(DetectorFile, RoundTrip) {
  const testing::ScratchFolder folder;
  const auto path = folder / "net.vcat";
  ASSERT_TRUE(WriteDetector(path, SomeDetector()));
  const auto read = ReadDetector(path);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->source, "net.onnx");
  EXPECT_EQ(read->trained_on, "streets from above");
  EXPECT_THAT(read->classes, ElementsAre("vehicle/car", "boat"));
  EXPECT_EQ(read->settings, DefaultSettings(DetectorLayout::kNanodet));
  EXPECT_EQ(read->files.network, std::string("\0net", 4));
  EXPECT_EQ(read->files.weights, "weights");
}

TEST(DetectorFile, EveryDamageIsAnError) {
  const std::vector<std::byte> whole = EncodeDetector(SomeDetector());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(ParseDetector(std::span(whole).first(size), "cut")) << size;
  }
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (i >= 12 && i < 16) continue;  // reserved
    std::vector<std::byte> changed = whole;
    changed[i] ^= std::byte{0x41};
    const auto parsed = ParseDetector(changed, "changed");
    ASSERT_FALSE(parsed) << i;
    EXPECT_THAT(parsed.error().message, HasSubstr("changed: "));
  }
}

TEST(DetectorFile, SettingsOutOfRangeAreDamage) {
  DetectorModel model = SomeDetector();
  model.settings.width = 1 << 20;
  EXPECT_FALSE(ParseDetector(EncodeDetector(model), "wide"));
  model = SomeDetector();
  model.classes = {"car", "car"};
  EXPECT_FALSE(ParseDetector(EncodeDetector(model), "twice"));
}

TEST(ParseClassList, IsOneNameALine) {
  const auto classes = ParseClassList("\xEF\xBB\xBFperson\r\n traffic light \ncar\n\n", "coco.names");
  ASSERT_TRUE(classes) << classes.error().message;
  EXPECT_THAT(*classes, ElementsAre("person", "traffic light", "car"));
}

TEST(ParseClassList, RefusesListsThatAreNone) {
  const auto message_of = [](const std::string& text) {
    const auto classes = ParseClassList(text, "list");
    return classes ? "accepted" : classes.error().message;
  };
  EXPECT_THAT(message_of(""), HasSubstr("list: 0 classes"));
  EXPECT_THAT(message_of("a\n\nb\n"), HasSubstr("line 2"));
  EXPECT_THAT(message_of("a\nb\na\n"), HasSubstr("line 3: the class a comes twice"));
  EXPECT_THAT(message_of("a\nb\x01\n"), HasSubstr("line 2"));
  EXPECT_THAT(message_of(std::string(101, 'a')), HasSubstr("line 1"));
  std::string many;
  for (int i = 0; i < 10'001; ++i) many += std::to_string(i) + "\n";
  EXPECT_THAT(message_of(many), HasSubstr("10001 classes"));
}

}  // namespace
}  // namespace victorious
