#include "victorious/base/foreign_file.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

std::optional<std::string> Describe(const std::string& bytes) {
  return DescribeForeignFile(std::as_bytes(std::span(bytes)));
}

// The head of an archive whose first file has this name.
std::string Archive(const std::string& name) {
  std::string bytes = std::string("PK\x03\x04", 4) + std::string(22, '\0');
  bytes.push_back(static_cast<char>(name.size()));
  return bytes + std::string(3, '\0') + name;
}

TEST(DescribeForeignFile, NamesTheKindAndTheRemedy) {
  EXPECT_THAT(Describe("ISO-10303-21;\nHEADER;"), Optional(HasSubstr("a STEP file")));
  EXPECT_THAT(Describe("Kaydara FBX Binary  "), Optional(HasSubstr("export it as glTF")));
  EXPECT_THAT(Describe("OFF\n8 6 12\n"), Optional(HasSubstr("an OFF file")));
  EXPECT_THAT(Describe(std::string("LASF\0\0", 6)), Optional(HasSubstr("point cloud")));
}

TEST(DescribeForeignFile, ArchivesDifferByTheirNames) {
  EXPECT_THAT(Describe(Archive("box.usdc")), Optional(HasSubstr("USDZ")));
  EXPECT_THAT(Describe(Archive("3D/3dmodel.model")), Optional(HasSubstr("3MF")));
  EXPECT_THAT(Describe(Archive("photo.jpg")), Optional(HasSubstr("unpack")));
}

TEST(DescribeForeignFile, SaysNothingOfOthers) {
  EXPECT_FALSE(Describe(""));
  EXPECT_FALSE(Describe("OFFICE"));
  EXPECT_FALSE(Describe("\x89PNG"));
}

}  // namespace
}  // namespace victorious
