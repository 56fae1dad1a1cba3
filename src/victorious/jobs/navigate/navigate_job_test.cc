#include "victorious/jobs/navigate/navigate_job.h"

#include <gtest/gtest.h>

#include "testing/drawn_flight.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using testing::DrawnFlight;
using testing::ShortFlight;

// Real landmarks are tested with the whole command (tests/e2e/test_navigate.py).

constexpr std::string_view kCrate = R"({"model":"crate","latitude_deg":52.5,"longitude_deg":13.4,"altitude_m":75.5})";

class NavigateJobTest : public ::testing::Test {
 protected:
  std::string List(std::string_view text) {
    const std::filesystem::path path = flight_ / "landmarks.jsonl";
    EXPECT_TRUE(WriteFileAtomically(path, text));
    return path.string();
  }

  Expected<NavigationResult> Run(const std::string& landmarks, std::vector<ObjectModel> models,
                                 const NavigateVideoOptions& options) {
    warnings_.clear();
    return NavigateVideo({.video = flight_.video(), .landmarks = landmarks}, std::move(models), options, CancelToken(),
                         [&](const std::string& warning) { warnings_.push_back(warning); });
  }

  static NavigateVideoOptions WithView() {
    NavigateVideoOptions options;
    options.telemetry.hfov_deg = 20;
    return options;
  }

  DrawnFlight flight_{ShortFlight(6)};
  std::vector<std::string> warnings_;
};

TEST_F(NavigateJobTest, PhotoModelWithoutLengthIsNotALandmark) {
  const auto result = Run(List(kCrate), flight_.Models(), WithView());
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->frames, 6);
  EXPECT_TRUE(result->states.empty());
  EXPECT_EQ(result->navigation.landmark_by_sighting.size(), 0);
}

TEST_F(NavigateJobTest, RefusesUnusableInput) {
  const auto refused = [](const Expected<NavigationResult>& result) {
    return result ? "not refused" : std::string(Name(result.error().code)) + ": " + result.error().message;
  };
  EXPECT_NE(refused(Run(List(kCrate), flight_.Models(), {})).find("--hfov"), std::string::npos);
  EXPECT_NE(refused(Run(List(kCrate), {flight_.Model(1)}, WithView())).find("crate"), std::string::npos);
  EXPECT_NE(refused(Run(List(""), flight_.Models(), WithView())).find("landmarks.jsonl"), std::string::npos);
  NavigateVideoOptions wrong = WithView();
  wrong.every = 0;
  EXPECT_NE(refused(Run(List(kCrate), flight_.Models(), wrong)).find("every"), std::string::npos);
}

TEST_F(NavigateJobTest, NamesLandmarksWithoutModel) {
  std::string other(kCrate);
  other.replace(other.find("crate"), 5, "wagon");
  ASSERT_TRUE(Run(List(std::string(kCrate) + "\n" + other), flight_.Models(), WithView()));
  ASSERT_EQ(warnings_.size(), 1);
  EXPECT_NE(warnings_.front().find("wagon"), std::string::npos);
}

TEST(NavigateVideoOptions, ParametersOfTheSearchAreThoseOfIndex) {
  NavigateVideoOptions options;
  const Status set = SetFromJsonText(R"({"method": "votes", "daylight.sun": "off", "pose": {"min_inliers": 7}})",
                                     CollectFields(options));
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(options.recognize.method, SearchMethod::kVotes);
  EXPECT_EQ(options.sun_direction.sun, SunSearch::kOff);
  EXPECT_EQ(options.recognize.pose.min_inliers, 7);
}

TEST(NavigationCsv, EmptyNavigationHasTheHeader) {
  const std::string text = ToCsv({});
  EXPECT_TRUE(
      text.starts_with("time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg,"
                       "sigma_position_m,sigma_attitude_deg,vertical_datum,landmarks,covariance_east_east_m2,"))
      << text;
  EXPECT_EQ(text.find('\n'), text.size() - 1) << text;
}

TEST(NavigationCsv, HasTelemetryColumnsAndSigmas) {
  NavigationResult result;
  for (int i = 0; i < 2; ++i) {
    NavigatedFrame frame;
    frame.camera = {.time_s = 0.1 * i, .place = {0.9, 0.2, 100}, .attitude = Attitude{1, -1, 0}};
    frame.camera.sigma_position_m = 0.5;
    frame.covariance = Matrix6::Identity() * 0.25;
    frame.landmarks = i;
    result.states.push_back(frame.camera);
    result.navigation.frames.push_back(frame);
  }
  const std::string without = ToCsv(result);
  EXPECT_EQ(without.find("offset"), std::string::npos);
  result.navigation.frames[1].offset = TelemetryOffset{{1.5, 0, -2}, {0, 0, kPi / 180}, Matrix6::Identity()};
  const std::string text = ToCsv(result);
  EXPECT_NE(text.find(",landmarks,covariance_east_east_m2,"), std::string::npos) << text;
  EXPECT_NE(text.find(",0,0.25,0,0,0.25,0,0.25,,,,,,\n"), std::string::npos) << text;
  EXPECT_NE(text.find(",1,0.25,0,0,0.25,0,0.25,1.5000,0.0000,-2.0000,0.0000,0.0000,1.0000\n"), std::string::npos)
      << text;
}

}  // namespace
}  // namespace victorious
