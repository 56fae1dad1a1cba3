#include "victorious/place/cameras/camera_request.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/base/file.h"
#include "victorious/base/isolated_process.h"

namespace victorious {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr std::string_view kRows =
    "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n"
    "5,42,-71,100,0,-60,0,50\n6,42,-71,100,0,-60,0,50\n7,42,-71,100,0,-60,0,50\n";

class CameraRequestTest : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(WriteFileAtomically(request_.file.value(), kRows)); }

  testing::ScratchFolder folder_;
  CameraRequest request_{.video = (folder_ / "video.mp4").string(),
                         .duration_s = 4,
                         .file = (folder_ / "telemetry.csv").string(),
                         .options = {},
                         .consequence = "no place"};
};

// By the program victorious-decoder, in its sandbox.
TEST_F(CameraRequestTest, AnswerIsThatOfLoad) {
  auto decoder = IsolatedProcess::Start("page", {});
  ASSERT_TRUE(decoder) << decoder.error().message;
  decoder->Confine({.memory_bytes = std::uint64_t{1} << 30, .readable = FilesOfCameraRequest(request_)});
  const auto answer = decoder->Ask("c" + PackCameraRequest(request_), {});
  ASSERT_TRUE(answer) << answer.error().message;
  std::vector<std::string> warnings;
  const auto cameras = UnpackCameraAnswer(*answer, [&](const std::string& warning) { warnings.push_back(warning); });
  ASSERT_TRUE(cameras) << cameras.error().message;
  EXPECT_THAT(cameras->trajectory()->states(), SizeIs(3));
  EXPECT_THAT(warnings, Contains(HasSubstr("no place"))) << "the telemetry begins after the end of the video";
}

TEST_F(CameraRequestTest, AnswerThatIsDamagedIsAnError) {
  auto answer = AnswerCameraRequest(PackCameraRequest(request_));
  ASSERT_TRUE(answer);
  EXPECT_TRUE(UnpackCameraAnswer(*answer, {}));
  answer->pop_back();
  EXPECT_FALSE(UnpackCameraAnswer(*answer, {}));
  EXPECT_FALSE(UnpackCameraAnswer("", {}));
  request_.file = "gone.csv";
  EXPECT_EQ(AnswerCameraRequest(PackCameraRequest(request_)).error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace victorious
