#include "victorious/apps/cli/argument_parser.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious::cli {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

// The parser's error message for these words; empty if they are accepted.
std::string ErrorOf(const ArgumentParser& program, const std::vector<std::string>& words) {
  const auto ended = ParseArguments(program, words);
  return ended ? "" : ended.error().message;
}

// What the program prints for --help after these words.
std::string HelpOf(const ArgumentParser& program, std::vector<std::string> words = {}) {
  words.emplace_back("--help");
  ::testing::internal::CaptureStdout();
  const auto ended = ParseArguments(program, words);
  const std::string printed = ::testing::internal::GetCapturedStdout();
  EXPECT_EQ(ended.value(), std::optional<int>(0));
  return printed;
}

TEST(ArgumentParser, ConvertsToTheTypeOfTheVariable) {
  struct {
    std::string text;
    int whole = 0;
    std::uint64_t seed = 0;
    std::optional<std::int64_t> id;
    std::optional<double> number;
    std::vector<std::string> words;
    std::vector<double> times;
    bool flag = false;
  } values;
  ProgramParser program("program", "Does");
  program.Add("TEXT", values.text).Required();
  program.Add("--whole", values.whole);
  program.Add("--seed", values.seed);
  program.Add("--id", values.id);
  program.Add("--number", values.number);
  program.Add("--words", values.words);
  program.Add("--times", values.times);
  program.AddFlag("--flag", values.flag, "A flag");
  EXPECT_EQ(ErrorOf(program, {"a text", "--whole", "-3", "--seed", "18446744073709551615", "--id", "9000000000",
                              "--words", "a", "b", "--times", "0.5", "1e3", "--flag"}),
            "");
  EXPECT_EQ(values.text, "a text");
  EXPECT_EQ(values.whole, -3);
  EXPECT_EQ(values.seed, UINT64_MAX);
  EXPECT_EQ(values.id, 9'000'000'000);
  EXPECT_EQ(values.number, std::nullopt);
  EXPECT_THAT(values.words, ElementsAre("a", "b"));
  EXPECT_THAT(values.times, ElementsAre(0.5, 1000));
  EXPECT_TRUE(values.flag);
}

TEST(ArgumentParser, AnEmptyNumberIsNone) {
  std::optional<int> every;
  std::optional<double> from_s;
  ProgramParser program("program", "Does");
  program.Add("--every", every, "Interval").TypeName("N");
  program.Add("--from", from_s, "Time").TypeName("S");
  EXPECT_THAT(ErrorOf(program, {"--every", ""}), StartsWith("--every: \"\": must be a number ("));
  EXPECT_THAT(ErrorOf(program, {"--from", ""}), StartsWith("--from: \"\": must be a number ("));
}

TEST(ArgumentParser, ANumberThatIsNoneIsExplained) {
  int every = 0;
  double step = 0;
  ProgramParser program("program", "Does");
  program.Add("--every", every, "Interval").TypeName("N");
  program.Add("--step", step, "Step");
  for (const std::string bad : {"two", "2.5"})
    EXPECT_THAT(ErrorOf(program, {"--every", bad}), StartsWith("--every " + bad + ": give a whole number ("));
  EXPECT_THAT(ErrorOf(program, {"--step", "wide"}), StartsWith("--step wide: give a number ("));
}

TEST(ArgumentParser, RangesAreSaidInErrorsAndHelp) {
  int threads = 0;
  double pitch_deg = 0;
  std::optional<std::int64_t> frame;
  ProgramParser program("program", "Does");
  program.Add("--threads", threads, "Threads").Range(0, 1024).TypeName("N");
  program.Add("--pitch", pitch_deg, "Pitch").Range(-90.0, 90.0).TypeName("DEG");
  program.Add("--frame", frame, "Frame").AtLeast(0).TypeName("N");
  for (const std::string bad : {"2000", "-1", "2.5", "many", "99999999999"}) {
    EXPECT_THAT(ErrorOf(program, {"--threads", bad}),
                StartsWith("--threads: \"" + bad + "\": must be a whole number from 0 to 1024 ("));
  }
  for (const std::string bad : {"90.5", "-91", "nan", "inf", "down"}) {
    EXPECT_THAT(ErrorOf(program, {"--pitch", bad}),
                StartsWith("--pitch: \"" + bad + "\": must be a number from -90 to 90 ("));
  }
  for (const std::string bad : {"-1", "1.5", "first"}) {
    EXPECT_THAT(ErrorOf(program, {"--frame", bad}),
                StartsWith("--frame: \"" + bad + "\": must be a whole number from 0 ("));
  }
  EXPECT_THAT(ErrorOf(program, {"--frame", ""}), StartsWith("--frame: \"\": must be a "));
  EXPECT_EQ(ErrorOf(program, {"--threads", "1024", "--pitch", "-90", "--frame", "9223372036854775807"}), "");
  EXPECT_EQ(threads, 1024);
  EXPECT_EQ(pitch_deg, -90);
  EXPECT_EQ(frame, INT64_MAX);
  EXPECT_THAT(HelpOf(program),
              AllOf(HasSubstr("--threads N:0..1024 "), HasSubstr("--pitch DEG:-90..90 "), HasSubstr("--frame N:0.. ")));
}

TEST(ArgumentParser, ChecksAndTransformsTexts) {
  std::string name;
  std::optional<double> minutes;
  ProgramParser program("program", "Does");
  program.Add("--name", name).Check([](const std::string& text) -> Status {
    if (text != "x") return {};
    return Fail(ErrorCode::kInvalidArgument, "not x");
  });
  program.Add("--minutes", minutes).Transform([](std::string& text) -> Status {
    if (!text.ends_with("min")) return Fail(ErrorCode::kInvalidArgument, "must end in min");
    text.resize(text.size() - 3);
    return {};
  });
  EXPECT_EQ(ErrorOf(program, {"--name", "y", "--minutes", "2.5min"}), "");
  EXPECT_EQ(minutes, 2.5);
  EXPECT_THAT(ErrorOf(program, {"--name", "x"}), StartsWith("--name: not x ("));
  EXPECT_THAT(ErrorOf(program, {"--minutes", "2.5"}), StartsWith("--minutes: must end in min ("));
}

TEST(ArgumentParser, OneOfNamesTheWords) {
  std::string role;
  ProgramParser program("program", "Does");
  program.Add("--role", role).OneOf({"viewer", "admin"});
  EXPECT_THAT(ErrorOf(program, {"--role", "root"}), StartsWith("--role: \"root\": must be one of viewer, admin ("));
  EXPECT_EQ(ErrorOf(program, {"--role", "admin"}), "");
  EXPECT_THAT(HelpOf(program), HasSubstr("{viewer,admin}"));
}

TEST(ArgumentParser, ArgumentsNeedAndExcludeOthers) {
  bool draw = false;
  bool plain = false;
  std::string folder;
  ProgramParser program("program", "Does");
  const Argument wanted = program.AddFlag("--draw", draw, "Draw");
  program.Add("--folder", folder).Needs(wanted);
  program.AddFlag("--plain", plain, "Plain").Excludes(wanted);
  EXPECT_THAT(ErrorOf(program, {"--folder", "a"}), AllOf(HasSubstr("--folder"), HasSubstr("requires --draw")));
  EXPECT_THAT(ErrorOf(program, {"--draw", "--plain"}),
              AllOf(HasSubstr("--plain"), HasSubstr(" excludes "), HasSubstr("--draw")));
  EXPECT_EQ(ErrorOf(program, {"--draw", "--folder", "a"}), "");
}

TEST(ArgumentParser, ListsAreSplitOrTakeOneValueEach) {
  std::vector<std::string> models;
  std::vector<std::string> boxes;
  std::vector<std::string> photos;
  ProgramParser program("program", "Does");
  program.Add("--models", models).SplitAt(',');
  program.Add("--box", boxes).OneValueEach();
  program.Add("PHOTO", photos).Required();
  EXPECT_EQ(ErrorOf(program, {"--box", "1,2,3,4", "a.png", "b.png", "--box", "5,6,7,8", "--models", "x,y"}), "");
  EXPECT_THAT(boxes, ElementsAre("1,2,3,4", "5,6,7,8"));
  EXPECT_THAT(photos, ElementsAre("a.png", "b.png"));
  EXPECT_THAT(models, ElementsAre("x", "y"));
  EXPECT_THAT(ErrorOf(program, {"a.png", "--box"}), HasSubstr("--box"));
}

TEST(ArgumentParser, HelpShowsDefaultsOnRequest) {
  int shown = 365;
  int hidden = 366;
  ProgramParser program("program", "Does");
  program.Add("--days", shown, "Days").ShowDefault();
  program.Add("--others", hidden, "Others");
  EXPECT_THAT(HelpOf(program), AllOf(HasSubstr("=365"), ::testing::Not(HasSubstr("366"))));
}

TEST(ArgumentParser, AnActionRunsBeforeTheRestIsParsed) {
  std::vector<int> descriptors;
  ProgramParser program("program", "Does");
  program.AddAction(
      "--events",
      [&](int descriptor) -> Status {
        descriptors.push_back(descriptor);
        return descriptor < 9 ? Status() : Fail(ErrorCode::kInvalidArgument, "is not open");
      },
      "Events");
  EXPECT_THAT(ErrorOf(program, {"--events", "3", "--unknown"}), HasSubstr("--unknown"));
  EXPECT_THAT(descriptors, ElementsAre(3));
  EXPECT_THAT(ErrorOf(program, {"--events", "9"}), StartsWith("--events: is not open ("));
}

// `program model add|list`
class CommandsTest : public ::testing::Test {
 protected:
  CommandsTest()
      : model(program.AddCommand("model", "Models", "Make")),
        add(model.AddCommand("add", "Make one")),
        list(model.AddCommand("list", "List them")) {
    program.RequireCommand();
    model.RequireCommand();
    add.Add("--models", folder).Required();
  }

  ProgramParser program{"program", "Does", "1.2.3"};
  ArgumentParser model;
  ArgumentParser add;
  ArgumentParser list;
  std::string folder;
};

TEST_F(CommandsTest, KnowsWhichWereGiven) {
  EXPECT_EQ(ErrorOf(program, {"model", "list"}), "");
  EXPECT_TRUE(model.IsGiven());
  EXPECT_TRUE(list.IsGiven());
  EXPECT_FALSE(add.IsGiven());
}

TEST_F(CommandsTest, AreListedInTheirOrder) {
  std::vector<std::string> names;
  for (const ArgumentParser& command : model.Commands()) names.push_back(command.Name());
  EXPECT_THAT(names, ElementsAre("add", "list"));
  EXPECT_THAT(add.Commands(), IsEmpty());
  EXPECT_EQ(add.Program().Name(), "program");
  EXPECT_EQ(program.Program().Name(), "program");
  EXPECT_THAT(HelpOf(program), AllOf(HasSubstr("Make:\n"), HasSubstr("--version")));
}

TEST_F(CommandsTest, AnErrorNamesTheCommandWhoseHelpDescribesIt) {
  EXPECT_THAT(ErrorOf(program, {}), HasSubstr("(see `program --help`)"));
  EXPECT_THAT(ErrorOf(program, {"model"}), HasSubstr("(see `program model --help`)"));
  EXPECT_THAT(ErrorOf(program, {"model", "add"}),
              AllOf(HasSubstr("--models is required"), HasSubstr("(see `program model add --help`)")));
  EXPECT_THAT(ErrorOf(program, {"model", "add", "--model", "a"}), HasSubstr("did you mean --models?"));
  EXPECT_THAT(ErrorOf(program, {"model", "lst"}), HasSubstr("did you mean list?"));
}

}  // namespace
}  // namespace victorious::cli
