// Children here are shells that write events; tests/e2e/test_serve.py and test_cluster.py run the program itself.
#include "victorious/base/child_task.h"

#include <string>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char kStarted[] = R"(echo '{"event":"info","message":"started"}' >&3; )";

struct Outcome {
  ChildEnd end;
  std::vector<ProgramEvent> events;
};

// Runs a shell script. `control` gets the number of events so far.
template <typename Control>
Outcome RunScript(const std::string& script, Control control, std::chrono::milliseconds grace = std::chrono::hours(1)) {
  Outcome outcome;
  const auto end = RunChild({.command = {.executable = "/bin/sh", .arguments = {"sh", "-c", script}},
                             .on_event = [&](const ProgramEvent& event) { outcome.events.push_back(event); },
                             .control = [&] { return control(outcome.events.size()); },
                             .grace = grace});
  EXPECT_TRUE(end) << end.error().message;
  if (end) outcome.end = *end;
  return outcome;
}

ChildControl Continue(std::size_t /*events*/) { return ChildControl::kContinue; }

ChildControl InterruptOnceStarted(std::size_t events) {
  return events > 0 ? ChildControl::kInterrupt : ChildControl::kContinue;
}

TEST(RunChild, PassesEventsOnAndReturnsTheStatus) {
  const Outcome outcome = RunScript(
      R"(echo '{"event":"progress","label":"a","done":3,"total":9,"unit":"frames","elapsed_s":1.5}' >&3
         echo '{"event":"error","code":"data_loss","message":"a: damaged"}' >&3
         printf '{"event":"video_left","video":"b"}' >&3
         exit 3)",
      Continue);
  const ProgressEvent progress{.label = "a", .done = 3, .total = 9, .unit = "frames", .elapsed_s = 1.5};
  const Error error{ErrorCode::kDataLoss, "a: damaged"};
  EXPECT_THAT(outcome.events, ElementsAre(progress, ErrorEvent{error}, VideoLeftEvent{"b"}))
      << "also the last line, which has no end";
  EXPECT_EQ(outcome.end.status, 3);
  EXPECT_EQ(outcome.end.error, error);
  EXPECT_EQ(DescribeFailure(outcome.end), "a: damaged");
}

TEST(RunChild, LineThatIsNoEventIsAWarning) {
  const Outcome outcome = RunScript("echo hello >&3; yes | head -c 3000000 | tr -d '\\n' >&3", Continue);
  ASSERT_EQ(outcome.events.size(), 2U);
  for (const ProgramEvent& event : outcome.events) {
    ASSERT_TRUE(std::holds_alternative<WarningEvent>(event));
    EXPECT_THAT(std::get<WarningEvent>(event).message, HasSubstr("ignored"));
  }
  EXPECT_THAT(std::get<WarningEvent>(outcome.events[1]).message, HasSubstr("more than 1048576 bytes"));
  EXPECT_EQ(outcome.end.status, 0);
}

TEST(RunChild, InterruptedChildEndsInOrder) {
  const Outcome outcome =
      RunScript("trap 'exit 7' INT; " + std::string(kStarted) + "while :; do :; done", InterruptOnceStarted);
  EXPECT_EQ(outcome.end.status, 7);
}

TEST(RunChild, ChildThatIgnoresTheInterruptIsKilledAfterTheGracePeriod) {
  const Outcome outcome = RunScript("trap '' INT; " + std::string(kStarted) + "kill -STOP $$", InterruptOnceStarted,
                                    std::chrono::milliseconds(1));
  EXPECT_EQ(outcome.end.status, 128 + 9);
  EXPECT_THAT(DescribeFailure(outcome.end), HasSubstr("killed"));
}

TEST(RunChild, ChildThatClosesItsEventsAndGoesOnIsStillInterrupted) {
  int asked = 0;
  const Outcome outcome = RunScript("trap 'exit 7' INT; exec 3>&-; while :; do :; done", [&](std::size_t) {
    return ++asked > 3 ? ChildControl::kInterrupt : ChildControl::kContinue;
  });
  EXPECT_EQ(outcome.end.status, 7);
}

TEST(RunChild, KillsAtOnce) {
  const Outcome outcome = RunScript(std::string(kStarted) + "kill -STOP $$", [](std::size_t events) {
    return events > 0 ? ChildControl::kKill : ChildControl::kContinue;
  });
  EXPECT_EQ(outcome.end.status, 128 + 9);
}

TEST(RunChild, ProgramThatIsAbsentHasTheStatusOfAShell) {
  const auto end = RunChild({.command = {.executable = "/none/such", .arguments = {"such"}},
                             .on_event = [](const ProgramEvent&) {},
                             .control = [] { return ChildControl::kContinue; }});
  ASSERT_TRUE(end) << end.error().message;
  EXPECT_EQ(end->status, 127);
  EXPECT_EQ(DescribeFailure(*end), "its process ended with the status 127");
}

TEST(DescribeFailure, NamesTheLikelyCauseOfASignal) {
  EXPECT_THAT(DescribeFailure({.status = 128 + 11, .error = {}}), HasSubstr("signal 11"));
  EXPECT_THAT(DescribeFailure({.status = 128 + 2, .error = {}}), HasSubstr("ended from outside"));
}

}  // namespace
}  // namespace victorious
