#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/caltech.h"
#include "experiments/experiment.h"
#include "experiments/roc.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

TEST(Roc, AreaIsTheProbabilityOfCorrectRanking) {
  EXPECT_EQ(RocArea(std::vector<double>{4, 3, 2, 1}, {true, true, false, false}), 1);
  EXPECT_EQ(RocArea(std::vector<double>{4, 3, 2, 1}, {false, false, true, true}), 0);
  EXPECT_EQ(RocArea(std::vector<double>{4, 3, 2, 1}, {true, false, true, false}), 0.75);
  EXPECT_EQ(RocArea(std::vector<double>{7, 7, 7, 7}, {true, false, true, false}), 0.5) << "equal scores count half";
}

TEST(Roc, CurveIsInterpolated) {
  const auto curve = RocCurve(std::vector<double>{4, 3, 2, 1}, {true, false, true, false});
  EXPECT_EQ(DetectionRateAt(curve, 0), 0.5);
  EXPECT_EQ(DetectionRateAt(curve, 0.5), 1);
  const auto tied = RocCurve(std::vector<double>{1, 1}, {true, false});
  EXPECT_EQ(DetectionRateAt(tied, 0.25), 0.25);
}

TEST(MeanWithError, IsTheMeanWithItsStandardError) {
  const MeanWithError measured = ComputeMean({1, 2, 3, 4});
  EXPECT_EQ(measured.mean, 2.5);
  EXPECT_NEAR(measured.standard_error, 0.6455, 1e-4);
  EXPECT_EQ(ComputeMean({5}).standard_error, 0);
}

TEST(Split, TrainsOnBoxesAndTestsOnTheRest) {
  std::vector<CategoryListRow> rows;
  for (int i = 0; i < 50; ++i)
    rows.push_back({.image = "a",
                    .category = "boxed",
                    .box = i < 48 ? std::optional(Box{0, 0, 1, 1}) : std::nullopt,
                    .mark = {},
                    .where = {}});
  for (int i = 0; i < 180; ++i) rows.push_back({.image = "b", .category = "whole", .box = {}, .mark = {}, .where = {}});
  const Split split = MakeRandomSplit(rows, 3);
  EXPECT_EQ(split.train.size(), 25U + 30U) << "half of few, 30 of many";
  EXPECT_EQ(split.test.size(), 25U + 100U) << "all of few, 100 of many";
  for (const std::size_t i : split.train) EXPECT_TRUE(rows[i].box || rows[i].category == "whole");
  EXPECT_EQ(MakeRandomSplit(rows, 3).train, split.train);
  EXPECT_NE(MakeRandomSplit(rows, 4).train, split.train);
}

TEST(Experiments, ErrorsNameUnknownNamesAndMissingData) {
  const ExperimentSettings settings{.data = "/nowhere", .out = ::testing::TempDir()};
  EXPECT_THAT(RunExperiment("table9.9", settings).error().message, HasSubstr("table3.7"));
  EXPECT_THAT(RunExperiment("table3.7", settings).error().message, HasSubstr("/nowhere/caltech101/list.csv"));
}

std::string TextOf(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(Report, IsWrittenAsJsonCsvAndSvg) {
  Report report{.name = "table0.0",
                .title = "A title",
                .notes = {"a note"},
                .columns = {"what, where", "share"},
                .rows = {{std::string("one \"x\""), MeanWithError{0.5, 0.1}}, {std::string("two"), 0.25}}};
  report.plot.title = "a < b";
  report.plot.lines = {{.name = "line", .points = {{0, 0, 0.1}, {1, 2, 0}}}};
  const std::filesystem::path folder = ::testing::TempDir();
  ASSERT_TRUE(WriteReport(report, folder).has_value());
  EXPECT_EQ(TextOf(folder / "table0.0.csv"),
            "\"what, where\",share,share standard error\n\"one \"\"x\"\"\",0.5,0.1\ntwo,0.25,\n");
  EXPECT_THAT(TextOf(folder / "table0.0.json"), HasSubstr("\"standard_error\": 0.1"));
  EXPECT_THAT(TextOf(folder / "table0.0.svg"), HasSubstr("a &lt; b"));
  EXPECT_THAT(ToMarkdown(report), HasSubstr("| two | 0.25 |"));
}

}  // namespace
}  // namespace victorious
