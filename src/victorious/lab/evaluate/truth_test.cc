#include "victorious/lab/evaluate/truth.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr std::string_view kRow =
    R"({"frame":37,"time_s":1.48,"object":"humvee-1","model":"humvee","box":[1,2,30.5,40],"visible":0.93})";

std::string ErrorOf(std::string_view text) {
  const auto rows = ParseTruth(text, "t.jsonl");
  if (rows) return "no error";
  EXPECT_EQ(rows.error().code, ErrorCode::kInvalidArgument);
  return rows.error().message;
}

TEST(ParseTruthTest, ReadsTheFieldsForScoring) {
  const auto rows = ParseTruth(kRow, "t.jsonl");
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_EQ(rows->size(), 1U);
  const TruthRow& row = rows->front();
  EXPECT_EQ(row.frame, 37);
  EXPECT_EQ(row.object, "humvee-1");
  EXPECT_EQ(row.model, "humvee");
  EXPECT_EQ(row.box, (Box{1, 2, 30.5, 40}));
  EXPECT_EQ(row.visible, 0.93);
  EXPECT_FALSE(row.view);
}

TEST(ParseTruthTest, ViewsAreInRadiansOrUnknown) {
  const std::string head =
      R"({"frame":0,"object":"a","model":"m","box":[0,0,1,1],"visible":1,"latitude_deg":null,"view":)";
  const auto rows =
      ParseTruth(head + R"({"azimuth_deg":90,"off_nadir_deg":60}})" + "\n" + head + "null}\n" + head + "{}}", "t");
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_TRUE((*rows)[0].view);
  EXPECT_DOUBLE_EQ((*rows)[0].view->azimuth_rad, kPi / 2);
  EXPECT_DOUBLE_EQ((*rows)[0].view->off_nadir_rad, kPi / 3);
  EXPECT_FALSE((*rows)[1].view);
  EXPECT_FALSE((*rows)[2].view);
  EXPECT_THAT(ErrorOf(head + R"({"azimuth_deg":90}})"), HasSubstr("off_nadir_deg is missing"));
}

TEST(ParseTruthTest, AcceptsEmptyLinesAndAnyLineEndings) {
  const std::string row(kRow);
  const auto rows = ParseTruth("\n" + row + "\r\n  \n" + row, "t");
  ASSERT_TRUE(rows) << rows.error().message;
  EXPECT_EQ(rows->size(), 2U);
  EXPECT_TRUE(ParseTruth("", "t")->empty());
}

TEST(ParseTruthTest, ErrorsNameTheLineAndTheKey) {
  EXPECT_THAT(ErrorOf(std::string(kRow) + "\n\n" + R"({"frame":1,"model":"m","box":[0,0,1,1],"visible":1})"),
              StartsWith("t.jsonl:3: object is missing"));
  EXPECT_THAT(ErrorOf(R"({"object":"a","model":"m","box":[0,0,1,1],"visible":1})"),
              StartsWith("t.jsonl:1: frame is missing"));
  EXPECT_THAT(ErrorOf(R"({"frame":1,"object":"a","model":null,"box":[0,0,1,1],"visible":1})"),
              HasSubstr("model is missing"));
  EXPECT_THAT(ErrorOf(R"({"frame":1,"object":"a","model":"m","visible":1})"), HasSubstr("box is missing"));
  EXPECT_THAT(ErrorOf(R"({"frame":1,"object":"a","model":"m","box":[0,0,1,1]})"), HasSubstr("visible is missing"));
}

TEST(ParseTruthTest, RefusesInvalidValues) {
  for (const std::string_view frame : {"-1", "1.5", "1e300", "\"1\"", "[]"}) {
    EXPECT_THAT(ErrorOf(R"({"object":"a","model":"m","box":[0,0,1,1],"visible":1,"frame":)" + std::string(frame) + "}"),
                HasSubstr("frame is not a whole number"))
        << frame;
  }
  for (const std::string_view box : {"[1,2,3]", "[1,2,3,\"4\"]", "7", "{}", "[0,0,-1,5]"}) {
    EXPECT_THAT(ErrorOf(R"({"object":"a","model":"m","frame":1,"visible":1,"box":)" + std::string(box) + "}"),
                HasSubstr("box is not"))
        << box;
  }
}

TEST(ParseTruthTest, ArbitraryBytesAreSafe) {
  for (const std::string& bytes : {std::string("[1,2]"), std::string("{"), std::string("\xff\xfe{}"),
                                   std::string(3, '\0'), std::string(100000, '['), std::string("{\"frame\":1e999}")}) {
    EXPECT_THAT(ErrorOf(bytes), HasSubstr("not a JSON object on one line"));
  }
}

TEST(ReadTruthTest, ReadsAFileAndNamesAMissingOne) {
  const testing::ScratchFolder folder;
  std::ofstream(folder / "truth.jsonl") << kRow << "\n";
  EXPECT_EQ(ReadTruth(folder / "truth.jsonl")->size(), 1U);
  const auto missing = ReadTruth(folder / "none.jsonl");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(missing.error().message, HasSubstr("none.jsonl"));
}

}  // namespace
}  // namespace victorious
