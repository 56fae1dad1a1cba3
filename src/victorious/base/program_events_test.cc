#include "victorious/base/program_events.h"

#include <array>
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "victorious/base/progress.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

TEST(ProgramEvents, LinesAreThoseOfTheFormat) {
  EXPECT_EQ(FormatEvent(ProgressEvent{.label = "a.mp4", .done = 12, .total = 40, .unit = "frames", .elapsed_s = 2.5}),
            R"({"event":"progress","label":"a.mp4","done":12,"total":40,"unit":"frames","elapsed_s":2.5})");
  EXPECT_EQ(FormatEvent(ProgressEvent{.label = "a", .done = 1, .total = {}, .unit = "views", .elapsed_s = 0}),
            R"({"event":"progress","label":"a","done":1,"total":null,"unit":"views","elapsed_s":0.0})");
  EXPECT_EQ(FormatEvent(ProgressEvent{.label = "a", .done = 1, .unit = "frames", .elapsed_s = 2, .behind_s = 0.5}),
            R"({"event":"progress","label":"a","done":1,"total":null,"unit":"frames","elapsed_s":2.0,"behind_s":0.5})");
  EXPECT_EQ(FormatEvent(InfoEvent{"x"}), R"({"event":"info","message":"x"})");
  EXPECT_EQ(FormatEvent(WarningEvent{"x"}), R"({"event":"warning","message":"x"})");
  EXPECT_EQ(FormatEvent(ErrorEvent{{ErrorCode::kNoSpace, "x"}}),
            R"({"event":"error","message":"x","code":"no_space"})");
  EXPECT_EQ(FormatEvent(VideoLeftEvent{"x"}), R"({"event":"video_left","video":"x"})");
  EXPECT_EQ(FormatEvent(VideoCutEvent{"x", 3}), R"({"event":"video_cut","video":"x","cut":3})");
}

TEST(ProgramEvents, HaveNoCredentials) {
  EXPECT_EQ(FormatEvent(WarningEvent{"rtsp://ann:secret@host/one: no packet"}),
            R"({"event":"warning","message":"rtsp://host/one: no packet"})");
  EXPECT_EQ(FormatEvent(VideoLeftEvent{"srt://host:1?passphrase=secret"}),
            R"({"event":"video_left","video":"srt://host:1?…"})");
}

TEST(ProgramEvents, ComeBackAsTheyWereWritten) {
  for (const ProgramEvent& event : std::initializer_list<ProgramEvent>{
           ProgressEvent{.label = "a \"b\"\\", .done = 12, .total = 40, .unit = "frames", .elapsed_s = 0.1},
           ProgressEvent{.label = "", .done = 0, .total = {}, .unit = "", .elapsed_s = 0},
           ProgressEvent{.label = "a", .done = 3, .total = {}, .unit = "frames", .elapsed_s = 9, .behind_s = 1.25},
           InfoEvent{"é"}, WarningEvent{"{\"event\":\"info\"}"}, VideoLeftEvent{"rtsp://a"},
           VideoCutEvent{"/a.mp4", 12}}) {
    EXPECT_EQ(ParseEvent(FormatEvent(event)), event) << FormatEvent(event);
  }
  for (const EnumText<ErrorCode>& code : kErrorCodeTexts) {
    const ProgramEvent event = ErrorEvent{{code.value, "m"}};
    EXPECT_EQ(ParseEvent(FormatEvent(event)), event) << code.text;
  }
}

TEST(ProgramEvents, AnyTextIsOneBoundedLine) {
  const std::string line = FormatEvent(VideoLeftEvent{"a\nb\xFF\t" + std::string(10 * kMaxEventBytes, '"')});
  EXPECT_EQ(line.find('\n'), std::string::npos);
  EXPECT_LE(line.size(), kMaxEventBytes);
  const auto read = ParseEvent(line);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_THAT(std::get<VideoLeftEvent>(*read).video, HasSubstr("a?b\xEF\xBF\xBD?\""));
}

TEST(ProgramEvents, OtherLinesAreErrors) {
  for (const char* line :
       {"",
        "error: x",
        "[]",
        "{}",
        R"({"event":"dance"})",
        R"({"event":3})",
        R"({"event":"info"})",
        R"({"event":"info","message":3})",
        R"({"event":"info","message":"a\nb"})",
        R"({"event":"error","message":"x"})",
        R"({"event":"error","message":"x","code":"dance"})",
        R"({"event":"video_left"})",
        R"({"event":"video_cut","video":"a"})",
        R"({"event":"info","message":"x","message":"y"})",
        R"({"event":"progress","label":"a","done":-1,"total":1,"unit":"u","elapsed_s":1})",
        R"({"event":"progress","label":"a","done":1,"total":1,"unit":"u","elapsed_s":1,"behind_s":-1})",
        R"({"event":"progress","label":"a","done":1.5,"total":1,"unit":"u","elapsed_s":1})",
        R"({"event":"progress","label":"a","done":1,"total":18446744073709551615,"unit":"u","elapsed_s":1})",
        R"({"event":"progress","label":"a","done":1,"total":1,"unit":"u","elapsed_s":-1})",
        R"({"event":"progress","label":"a","done":1,"total":1,"elapsed_s":1})"}) {
    const auto event = ParseEvent(line);
    ASSERT_FALSE(event) << line;
    EXPECT_EQ(event.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(event.error().message.find('\n'), std::string::npos);
  }
  EXPECT_THAT(ParseEvent(R"({"event":"dance"})").error().message, HasSubstr("dance"));
  EXPECT_TRUE(ParseEvent(R"({"event":"info","message":"x","later":[1]})")) << "a member of a later version";
}

TEST(ProgramEvents, DescriptorThatCannotBeWrittenIsAnError) {
  EXPECT_THAT(OpenEventOutput(987).error().message, HasSubstr("987"));
  const int readable = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  EXPECT_FALSE(OpenEventOutput(readable));
  ::close(readable);
  EXPECT_FALSE(HasEventOutput());
}

// What a process writes with `--events 2`. In a process of its own: its output cannot be closed again.
TEST(ProgramEvents, GoToTheDescriptorAndTheProgressWithThem) {
  const auto work = [] {
    if (!OpenEventOutput(STDERR_FILENO)) std::_Exit(1);
    ReportEvent(InfoEvent{"begun"});
    {
      Progress("a.mp4", 250, "frames").Update(7);
    }
    std::_Exit(0);
  };
  EXPECT_EXIT(work(), ::testing::ExitedWithCode(0),
              R"(^\{"event":"info","message":"begun"\}
\{"event":"progress","label":"a.mp4","done":7,"total":250,"unit":"frames","elapsed_s":[0-9.e-]+\}
$)");
}

// The death test runs in a process of its own, whose events are its own.
TEST(ReportEvent, SurvivesAReaderThatWentAway) {
  const auto report = [] {
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0 || ::close(ends[0]) != 0 || !OpenEventOutput(ends[1])) std::_Exit(1);
    ReportEvent(InfoEvent{"nobody reads this"});
    std::_Exit(7);
  };
  EXPECT_EXIT(report(), ::testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace victorious
