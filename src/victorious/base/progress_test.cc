#include "victorious/base/progress.h"

#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace victorious {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Progress, WithoutTerminalPrintsOneFinalLine) {
  ::testing::internal::CaptureStderr();
  {
    Progress progress("a.mp4", 250, "frames");
    for (int done = 1; done <= 250; ++done) progress.Update(done);
  }
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(text, HasSubstr("a.mp4: 250 of 250 frames"));
  EXPECT_EQ(text.find('\r'), std::string::npos);
  EXPECT_EQ(text.find('\n'), text.size() - 1);
}

TEST(Progress, UnknownTotalIsOmitted) {
  ::testing::internal::CaptureStderr();
  {
    Progress("rtsp://camera", std::nullopt, "frames").Update(7);
  }
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("rtsp://camera: 7 frames"));
}

TEST(Progress, DoesNotShowPasswords) {
  ::testing::internal::CaptureStderr();
  {
    Progress("rtsp://ann:secret@camera", std::nullopt, "frames").Update(7);
  }
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("rtsp://camera: 7 frames"));
}

// The library prints nothing: what it reports goes to its caller.
TEST(ProgressCapture, ReceivesInPlaceOfStderr) {
  std::vector<ProgressEvent> received;
  ::testing::internal::CaptureStderr();
  {
    const ProgressCapture capture([&](const ProgressEvent& event) { received.push_back(event); });
    Progress progress("a.mp4", 250, "frames");
    progress.Update(1);
    progress.Update(250);
  }
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), IsEmpty());
  ASSERT_EQ(received.size(), 1);
  EXPECT_EQ(received.back().label, "a.mp4");
  EXPECT_EQ(received.back().done, 250);
  EXPECT_EQ(received.back().total, 250);
  EXPECT_EQ(ProgressCapture::Current(), nullptr) << "ended with its scope";
}

TEST(Progress, PrintsNothingWithoutSteps) {
  ::testing::internal::CaptureStderr();
  {
    const Progress progress("a.mp4", 250, "frames");
  }
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), IsEmpty());
}

TEST(Progress, ClosedStderrIsHarmless) {
  const auto work = [] {
    ::close(STDERR_FILENO);
    {
      Progress("a.mp4", 250, "frames").Update(1);
    }
    std::_Exit(0);
  };
  EXPECT_EXIT(work(), ::testing::ExitedWithCode(0), "");
}

TEST(TimeLeftText, IsMinutesOrHours) {
  EXPECT_EQ(TimeLeftText(0), "0:00 left");
  EXPECT_EQ(TimeLeftText(4.2), "0:05 left");
  EXPECT_EQ(TimeLeftText(65), "1:05 left");
  EXPECT_EQ(TimeLeftText(7260), "2:01:00 left");
}

TEST(TimeLeftText, UnknownTimesAreNotShown) {
  for (const double spent_s :
       {-1.0, 1e9, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(TimeLeftText(spent_s), "");
  }
}

}  // namespace
}  // namespace victorious
