#include "victorious/track/box_tracker.h"

#include <cmath>
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/drawn_town.h"
#include "victorious/base/random.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

// A view of a town with a small moving car; the camera may translate, rotate and approach.
class Drive {
 public:
  Drive() : town_(testing::DrawTown({1100, 900}, 6)) {
    cv::Mat image = testing::DrawTown({60, 60}, 31);
    car_ = image(cv::Rect(10, 20, 30, 18)).clone();
    cv::rectangle(car_, {0, 0, 30, 18}, cv::Scalar(30, 40, 200), 3);
    cv::rectangle(car_, {9, 4, 8, 10}, cv::Scalar(40, 20, 20), cv::FILLED);
    cv::rectangle(car_, {22, 4, 4, 10}, cv::Scalar(220, 220, 210), cv::FILLED);
  }

  // `car_on_ground` is the car's top left corner; empty: the car is occluded.
  [[nodiscard]] cv::Mat Draw(std::optional<cv::Point> car_on_ground, const Similarity2& frame_from_ground) const {
    cv::Mat ground = town_.clone();
    if (car_on_ground) car_.copyTo(ground(cv::Rect(*car_on_ground, car_.size())));
    const Eigen::Matrix2d linear = frame_from_ground.Linear();
    const Eigen::Vector2d offset = frame_from_ground.Apply({0.5, 0.5}) - Eigen::Vector2d(0.5, 0.5);
    cv::Mat frame;
    cv::warpAffine(ground, frame,
                   cv::Matx23d(linear(0, 0), linear(0, 1), offset.x(), linear(1, 0), linear(1, 1), offset.y()),
                   {400, 300});
    return frame;
  }

  [[nodiscard]] static Box BoxOf(cv::Point car_on_ground, const Similarity2& frame_from_ground) {
    Polygon corners = BoxCorners({static_cast<double>(car_on_ground.x), static_cast<double>(car_on_ground.y), 30, 18});
    for (Eigen::Vector2d& corner : corners) corner = frame_from_ground.Apply(corner);
    return BoundingBox(corners);
  }

 private:
  cv::Mat town_;
  cv::Mat car_;
};

Similarity2 Over(double x, double y, double scale = 1, double rotation_rad = 0) {
  Similarity2 frame_from_ground{scale, rotation_rad, {0, 0}};
  frame_from_ground.translation = Eigen::Vector2d(200, 150) - frame_from_ground.Linear() * Eigen::Vector2d(x, y);
  return frame_from_ground;
}

BoxTracker Started(const cv::Mat& frame, const Box& box) {
  BoxTracker tracker = BoxTracker::Create({}).value();
  tracker.Step({0, 0, frame});
  EXPECT_TRUE(tracker.Start(box)->seen());
  return tracker;
}

TEST(BoxTracker, FollowsASmallMovingCarFromAMovingCamera) {
  const Drive drive;
  BoxTracker tracker =
      Started(drive.Draw(cv::Point(500, 400), Over(500, 400)), Drive::BoxOf({500, 400}, Over(500, 400)));
  for (int i = 1; i <= 25; ++i) {
    const cv::Point car(500 + 3 * i, 400 + i);
    const Similarity2 camera = Over(500 - 4 * i, 400 + 5 * i);
    const BoxTrackStep step = tracker.Step({i, 0.1 * i, drive.Draw(car, camera)}).front();
    ASSERT_TRUE(step.seen()) << i;
    EXPECT_GT(IntersectionOverUnion(step.box, Drive::BoxOf(car, camera)), 0.6) << i;
  }
}

TEST(BoxTracker, FollowsScaleAndRotationOfTheCamera) {
  const Drive drive;
  const cv::Point car(500, 400);
  const auto camera = [](int i) { return Over(515, 409, 1 + 0.015 * i, 0.03 * i); };
  BoxTracker tracker = Started(drive.Draw(car, camera(0)), Drive::BoxOf(car, camera(0)));
  for (int i = 1; i <= 40; ++i) {
    const BoxTrackStep step = tracker.Step({i, 0.1 * i, drive.Draw(car, camera(i))}).front();
    ASSERT_TRUE(step.seen()) << i;
    const Box truth = Drive::BoxOf(car, camera(i));
    const Eigen::Vector2d miss(step.box.x + step.box.width / 2 - truth.x - truth.width / 2,
                               step.box.y + step.box.height / 2 - truth.y - truth.height / 2);
    EXPECT_LT(miss.norm(), 4) << i;
    // The tracker bounds the ellipse inscribed in the rotated box; the truth bounds the box's corners.
    EXPECT_GT(IntersectionOverUnion(step.box, truth), 0.45) << i;
  }
}

TEST(BoxTracker, ReacquiresAfterOcclusionElsewhere) {
  const Drive drive;
  const cv::Point car(500, 400);
  const Similarity2 camera = Over(500, 400);
  BoxTracker tracker = Started(drive.Draw(car, camera), Drive::BoxOf(car, camera));
  for (int i = 1; i <= 8; ++i) ASSERT_TRUE(tracker.Step({i, 0.1 * i, drive.Draw(car, camera)}).front().seen());
  for (int i = 9; i <= 20; ++i) {
    const BoxTrackStep step = tracker.Step({i, 0.1 * i, drive.Draw(std::nullopt, camera)}).front();
    EXPECT_FALSE(step.seen()) << i;
    EXPECT_EQ(step.loss, TrackLoss::kOccluded) << i;
    EXPECT_TRUE(step.box.IsEmpty()) << i;
  }
  const cv::Point elsewhere(390, 480);  // 136 px away: beyond the reach of a lost object of 23 px
  BoxTrackStep step{.loss = TrackLoss::kOccluded};
  for (int i = 21; i <= 26 && !step.seen(); ++i) {
    step = tracker.Step({i, 0.1 * i, drive.Draw(elsewhere, camera)}).front();
  }
  EXPECT_TRUE(step.seen());
  EXPECT_GT(IntersectionOverUnion(step.box, Drive::BoxOf(elsewhere, camera)), 0.5);
}

// A car of another paint stands on plain tarmac, 170 px away, while the target is behind a roof. Nothing beside it
// disturbs the response of the filter, but it looks less like the target than the target itself.
TEST(BoxTracker, ASimilarObjectOutOfReachIsNotTheTarget) {
  const Drive drive;
  const cv::Point car(500, 400);
  const cv::Point other(350, 320);
  const Similarity2 camera = Over(500, 400);
  const auto around = [&](cv::Point at) {
    const Box box = Drive::BoxOf(at, camera);
    return cv::Rect(cvRound(box.x), cvRound(box.y), cvRound(box.width), cvRound(box.height));
  };
  const cv::Mat with_car = drive.Draw(car, camera);
  const cv::Mat paint = testing::DrawTown({60, 60}, 7)(cv::Rect({5, 5}, around(car).size()));
  for (const double similarity : {0.3, 0.4, 0.5}) {
    BoxTracker tracker = Started(with_car, Drive::BoxOf(car, camera));
    for (int i = 1; i <= 8; ++i) tracker.Step({i, 0.1 * i, with_car});
    cv::Mat without = drive.Draw(std::nullopt, camera);
    without(around(other) + cv::Size(80, 80) - cv::Point(40, 40)) = cv::Scalar::all(110);
    cv::addWeighted(with_car(around(car)), similarity, paint, 1 - similarity, 0, without(around(other)));
    int seen = 0;
    for (int i = 9; i <= 20; ++i) {
      const BoxTrackStep step = tracker.Step({i, 0.1 * i, without}).front();
      seen += step.seen() && !step.tentative ? 1 : 0;
    }
    EXPECT_EQ(seen, 0) << similarity;
    BoxTrackStep step{.loss = TrackLoss::kOccluded};
    for (int i = 21; i <= 28 && (!step.seen() || step.tentative); ++i)
      step = tracker.Step({i, 0.1 * i, with_car}).front();
    EXPECT_TRUE(step.seen() && !step.tentative) << "back where it was";
  }
}

// Two cars of one type stand 170 px apart; one of them is the target, and leaves.
TEST(BoxTracker, ATwinThatWasInViewBesideTheTargetIsNotTheTarget) {
  const Drive drive;
  const cv::Point car(500, 400);
  const cv::Point twin(350, 320);
  const Similarity2 camera = Over(500, 400);
  const cv::Mat alone = drive.Draw(twin, camera);
  const Box box = Drive::BoxOf(car, camera);
  const cv::Rect around(cvRound(box.x), cvRound(box.y), cvRound(box.width), cvRound(box.height));
  cv::Mat both = alone.clone();
  drive.Draw(car, camera)(around).copyTo(both(around));
  BoxTracker tracker = Started(both, box);
  for (int i = 1; i <= 12; ++i) ASSERT_TRUE(tracker.Step({i, 0.1 * i, both}).front().seen());
  for (int i = 13; i <= 30; ++i) EXPECT_FALSE(tracker.Step({i, 0.1 * i, alone}).front().seen()) << i;
  BoxTrackStep step{.loss = TrackLoss::kOccluded};
  for (int i = 31; i <= 36 && !step.seen(); ++i) step = tracker.Step({i, 0.1 * i, both}).front();
  EXPECT_TRUE(step.seen());
  EXPECT_GT(IntersectionOverUnion(step.box, box), 0.5);
}

// The camera passes the target, and then a car of the same type that was not in view before; it returns.
TEST(BoxTracker, ATwinThatComesIntoViewWhenTheTargetHasLeftIsNotTheTarget) {
  const Drive drive;
  const cv::Point car(215, 400);
  const cv::Point twin(640, 390);
  const auto camera = [](int i) { return Over(300 + 8 * (i <= 40 ? i : 80 - i), 400); };
  const auto draw = [&](int i) {
    cv::Mat frame = drive.Draw(car, camera(i));
    const Box box = Drive::BoxOf(twin, camera(i));
    const cv::Rect around = cv::Rect(cvFloor(box.x), cvFloor(box.y), cvCeil(box.width) + 1, cvCeil(box.height) + 1) &
                            cv::Rect({0, 0}, frame.size());
    if (!around.empty()) drive.Draw(twin, camera(i))(around).copyTo(frame(around));
    return frame;
  };
  BoxTracker tracker = Started(draw(0), Drive::BoxOf(car, camera(0)));
  BoxTrackStep step;
  for (int i = 1; i <= 80; ++i) {
    step = tracker.Step({i, 0.1 * i, draw(i)}).front();
    const Box truth = Drive::BoxOf(car, camera(i));
    const Box of_twin = Drive::BoxOf(twin, camera(i));
    if (truth.x > 30) {
      EXPECT_TRUE(step.seen() || i > 40) << i;
    } else if (truth.x + truth.width < 0) {
      EXPECT_FALSE(step.seen()) << i;
      if (of_twin.x > 0 && of_twin.x + of_twin.width < 400) {
        EXPECT_FALSE(tracker.Resume(0, of_twin, 0, BoxTracker::ResumeBasis::kRecognised).seen()) << i;
      }
    }
  }
  EXPECT_TRUE(step.seen());
  EXPECT_GT(IntersectionOverUnion(step.box, Drive::BoxOf(car, camera(80))), 0.5);
}

TEST(BoxTracker, ReportsLeavingTheFrame) {
  const Drive drive;
  const cv::Point car(500, 400);
  BoxTracker tracker = Started(drive.Draw(car, Over(400, 400)), Drive::BoxOf(car, Over(400, 400)));
  BoxTrackStep step;
  for (int i = 1; i <= 30; ++i) {
    const Similarity2 camera = Over(400 - 6 * i, 400);
    step = tracker.Step({i, 0.1 * i, drive.Draw(car, camera)}).front();
    if (!step.seen()) break;
    EXPECT_LE(step.box.x + step.box.width, 400);
  }
  EXPECT_EQ(step.loss, TrackLoss::kLeftFrame);
}

// Salt-and-pepper noise on a fraction of the pixels.
cv::Mat Noisy(cv::Mat frame, double share, Random& random) {
  for (cv::Vec3b& pixel : cv::Mat_<cv::Vec3b>(frame)) {
    if (random.Uniform() < share) pixel = cv::Vec3b::all(random.Below(2) == 0 ? 0 : 255);
  }
  return frame;
}

// Noise makes appearances similar, and at the edge the filter responds to the content that remains in the frame.
TEST(BoxTracker, NoFalseReacquisitionAtTheEdgeOfANoisyImage) {
  const Drive drive;
  int seen_after = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Random random(seed);
    const auto car = [&](int i) { return cv::Point(500 + 3 * i, 400 + 7 * static_cast<int>(seed)); };
    const auto camera = [](int i) { return Over(450 - 10 * i, 400 + 2 * i, 2); };
    const auto frame = [&](int i) { return Noisy(drive.Draw(car(i), camera(i)), 0.25, random); };
    BoxTracker tracker = Started(frame(0), Drive::BoxOf(car(0), camera(0)));
    for (int i = 1; i <= 60; ++i) {
      const BoxTrackStep step = tracker.Step({i, 0.1 * i, frame(i)}).front();
      const bool left = Drive::BoxOf(car(i), camera(i)).x >= 400;
      EXPECT_TRUE(i > 3 || step.seen()) << "seed " << seed;
      seen_after += left && step.seen() && !step.tentative ? 1 : 0;
    }
  }
  EXPECT_LE(seen_after, 1);
}

TEST(BoxTracker, ResumesOnlyAtMatchingAppearance) {
  const Drive drive;
  const cv::Point car(500, 400);
  const Similarity2 camera = Over(500, 400);
  BoxTracker tracker = Started(drive.Draw(car, camera), Drive::BoxOf(car, camera));
  for (int i = 1; i <= 5; ++i) tracker.Step({i, 0.1 * i, drive.Draw(car, camera)});
  for (int i = 6; i <= 8; ++i) tracker.Step({i, 0.1 * i, drive.Draw(std::nullopt, camera)});
  EXPECT_FALSE(tracker.Resume(0, {40, 60, 30, 18}, 0, BoxTracker::ResumeBasis::kRecognised).seen());
  tracker.Step({9, 0.9, drive.Draw(car, camera)});
  const BoxTrackStep step = tracker.Resume(0, Drive::BoxOf(car, camera), 0, BoxTracker::ResumeBasis::kRecognised);
  EXPECT_TRUE(step.seen());
  EXPECT_GT(IntersectionOverUnion(step.box, Drive::BoxOf(car, camera)), 0.7);
}

TEST(BoxTracker, SurvivesBlankFramesAndFramesOfAnotherSize) {
  const Drive drive;
  const cv::Point car(500, 400);
  const Similarity2 camera = Over(500, 400);
  BoxTracker tracker = Started(drive.Draw(car, camera), Drive::BoxOf(car, camera));
  for (int i = 1; i <= 4; ++i) tracker.Step({i, 0.1 * i, drive.Draw(car, camera)});
  EXPECT_FALSE(tracker.Step({5, 0.5, cv::Mat(300, 400, CV_8UC3, cv::Scalar::all(0))}).front().seen());
  EXPECT_FALSE(tracker.Step({6, 0.6, cv::Mat(9, 7, CV_8UC1, cv::Scalar(90))}).front().seen());
  BoxTrackStep step{.loss = TrackLoss::kOccluded};
  for (int i = 7; i <= 10 && !step.seen(); ++i) step = tracker.Step({i, 0.1 * i, drive.Draw(car, camera)}).front();
  EXPECT_TRUE(step.seen());
}

TEST(BoxTracker, UniformBoxIsLost) {
  const cv::Mat grey(300, 400, CV_8UC3, cv::Scalar::all(128));
  BoxTracker tracker = Started(grey, {100, 100, 40, 30});
  BoxTrackStep last;
  for (int i = 1; i <= 5; ++i) {
    last = tracker.Step({i, 0.1 * i, grey}).front();
    EXPECT_TRUE(std::isfinite(last.confidence));
  }
  EXPECT_FALSE(last.seen());
}

TEST(BoxTracker, AcceptsFramesOfAnyShape) {
  const Drive drive;
  const cv::Mat first = drive.Draw(cv::Point(500, 400), Over(500, 400));
  for (const Box& box : {Box{0, 0, 400, 300}, Box{10, 10, 4, 280}, Box{30, 30, 4, 4}}) {
    BoxTracker tracker = Started(first, box);
    tracker.Step({1, 0.1, first});
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(3000, 1), cv::Size(2, 900), cv::Size(33, 21)}) {
      for (int i = 0; i < 3; ++i) tracker.Step({2 + i, 0.2 + 0.1 * i, testing::DrawTown(size, 3)});
    }
  }
}

TEST(BoxTracker, BoxesAreTrackedIndependently) {
  const Drive drive;
  const cv::Point car(500, 400);
  const Similarity2 camera = Over(500, 400);
  const cv::Mat first = drive.Draw(car, camera);
  BoxTracker alone = Started(first, Drive::BoxOf(car, camera));
  BoxTracker both = Started(first, Drive::BoxOf(car, camera));
  ASSERT_TRUE(both.Start({40, 60, 50, 40}));
  for (int i = 1; i <= 5; ++i) {
    const Similarity2 moved = Over(500 + 3 * i, 400);
    const cv::Mat frame = drive.Draw(car, moved);
    const std::vector<BoxTrackStep> steps = both.Step({i, 0.1 * i, frame});
    EXPECT_EQ(steps.at(0).box, alone.Step({i, 0.1 * i, frame}).front().box);
    EXPECT_NEAR(steps.at(1).box.x, 40 - 3 * i, 2);
  }
}

TEST(BoxTracker, RefusesEmptyBoxes) {
  BoxTracker tracker = BoxTracker::Create({}).value();
  tracker.Step({0, 0, cv::Mat(300, 400, CV_8UC3, cv::Scalar::all(9))});
  EXPECT_THAT(tracker.Start({500, 10, 40, 40}).error().message, HasSubstr("outside the frame"));
  EXPECT_THAT(tracker.Start({380, 10, 60, 40}).error().message, HasSubstr("outside the frame"));
  EXPECT_THAT(tracker.Start({50, 10, 3, 40}).error().message, HasSubstr("too small"));
  EXPECT_THAT(tracker.Start({50, 10, std::numeric_limits<double>::infinity(), 40}).error().message, HasSubstr("small"));
  EXPECT_TRUE(tracker.Start({0, 0, 400, 300}));
}

TEST(BoxTracker, RefusesOptionsOutOfRange) {
  EXPECT_EQ(BoxTracker::Create({.lost_confidence = 2}).error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace victorious
