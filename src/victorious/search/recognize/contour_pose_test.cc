#include "victorious/search/recognize/contour_pose.h"

#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "victorious/geometry/view_direction.h"
#include "victorious/search/recognize/contour_search.h"
#include "victorious/search/recognize/contour_track.h"
#include "victorious/search/recognize/shape_search.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

// The front and one side of a box of 2 x 1 x 1 m in outline and crease, from in front, above and beside.
ContourModel MakeBox(const Vector3d& size_m) {
  ContourModel model{.diagonal_m = size_m.norm(), .views = {}};
  for (int azimuth = -60; azimuth <= 60; azimuth += 10) {
    ContourView view;
    view.camera_from_model = Eigen::AngleAxisd(0.5, Vector3d::UnitX()).toRotationMatrix() *
                             Eigen::AngleAxisd(azimuth * 0.0174533, Vector3d::UnitY()).toRotationMatrix();
    const Vector3d towards = -view.camera_from_model.row(2).transpose();
    for (int axis = 0; axis < 3; ++axis) {
      const int second = (axis + 1) % 3;
      const int third = (axis + 2) % 3;
      for (const double a : {-0.5, 0.5}) {
        for (const double b : {-0.5, 0.5}) {
          if (a * towards[second] <= 0 && b * towards[third] <= 0) continue;  // behind
          for (double along = -0.48; along < 0.49; along += 0.02) {
            Vector3d at = Vector3d::Zero();
            at[axis] = along * size_m[axis];
            at[second] = a * size_m[second];
            at[third] = b * size_m[third];
            Vector3d beside = at;
            beside[axis] += 0.02 * size_m[axis];
            view.points.push_back({at, beside});
          }
        }
      }
    }
    model.views.push_back(view);
  }
  return model;
}

const Vector3d kBox_m(1, 0.6, 2);

// As in the model's view number 9, moved a little.
ContourPose TruePose(const ContourModel& model) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.04, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  return {.camera_from_model = turn * model.views[9].camera_from_model,
          .centre_in_camera_m = {0.1, -0.1, 5},
          .focal_px = 700};
}

cv::Mat MakeWall(bool has_stripes) {
  cv::Mat grey(480, 640, CV_8U, cv::Scalar(90));
  if (has_stripes) {
    for (int x = 20; x < 640; x += 90) cv::line(grey, {x, 0}, {x - 60, 480}, cv::Scalar(120), 3);
  }
  return grey;
}

// The box in white lines on a wall.
cv::Mat DrawLines(const ContourModel& model, const ContourPose& pose) {
  cv::Mat grey = MakeWall(false);
  for (const ProjectedContour& point : ProjectContours(model, pose, {320, 240})) {
    cv::circle(grey, cv::Point(static_cast<int>(point.at_px.x()), static_cast<int>(point.at_px.y())), 1,
               cv::Scalar(200), -1);
  }
  cv::GaussianBlur(grey, grey, {}, 1);
  return grey;
}

// The box of kBox_m, each face in another grey, before a wall.
cv::Mat Draw(const ContourPose& pose, bool has_stripes) {
  cv::Mat grey = MakeWall(has_stripes);
  for (int axis = 0; axis < 3; ++axis) {
    const int second = (axis + 1) % 3;
    const int third = (axis + 2) % 3;
    for (const double side : {-0.5, 0.5}) {
      const Vector3d outwards = side * pose.camera_from_model.col(axis);
      if (outwards.dot(pose.centre_in_camera_m + kBox_m[axis] * outwards) >= 0) continue;  // seen from behind
      std::vector<cv::Point> corners;
      for (const auto& [a, b] :
           {std::pair(-0.5, -0.5), std::pair(-0.5, 0.5), std::pair(0.5, 0.5), std::pair(0.5, -0.5)}) {
        Vector3d at = Vector3d::Zero();
        at[axis] = side * kBox_m[axis];
        at[second] = a * kBox_m[second];
        at[third] = b * kBox_m[third];
        const Vector3d in_camera_m = pose.camera_from_model * at + pose.centre_in_camera_m;
        corners.emplace_back(cvRound(320 + pose.focal_px * in_camera_m.x() / in_camera_m.z()),
                             cvRound(240 + pose.focal_px * in_camera_m.y() / in_camera_m.z()));
      }
      cv::fillConvexPoly(grey, corners, cv::Scalar(150 + 45 * axis));
    }
  }
  cv::GaussianBlur(grey, grey, {}, 1);
  return grey;
}

TEST(ContourImage, LeavesTheImageThatItIsMadeOf) {
  cv::Mat grey = cv::Mat::zeros(40, 40, CV_8UC1);
  grey.colRange(20, 40).setTo(200);
  const cv::Mat before = grey.clone();
  const ContourImage image(grey);
  EXPECT_EQ(cv::countNonZero(grey != before), 0);
  EXPECT_GT(cv::countNonZero(image.grey() != before), 0);
}

TEST(ContourPose, IsRefinedToTheEdges) {
  const ContourModel model = MakeBox(kBox_m);
  const ContourPose truth = TruePose(model);
  const ContourImage image(Draw(truth, false));
  ContourPose start = truth;
  start.camera_from_model = Eigen::AngleAxisd(0.02, Vector3d::UnitZ()).toRotationMatrix() * start.camera_from_model;
  start.centre_in_camera_m += Vector3d(0.04, 0.04, 0);
  const ContourPose refined = RefineContourPose(model, image, start, {.reach = 0.035, .free_focal = false});
  const auto distance_px = [&](const ContourPose& pose) {
    const Eigen::Vector2d centre_px = pose.centre_in_camera_m.head<2>() / pose.centre_in_camera_m.z() * 700;
    return (centre_px - truth.centre_in_camera_m.head<2>() / truth.centre_in_camera_m.z() * 700).norm();
  };
  EXPECT_GT(distance_px(start), 7);
  EXPECT_LT(distance_px(refined), 3);
  EXPECT_GT(NegLog10NfaOf(EvidenceOf(model, image, refined)), kMinContourNegLog10Nfa);
}

TEST(ContourPose, PointsBeyondTheFrameAreNoEvidence) {
  const ContourModel model = MakeBox(kBox_m);
  const ContourImage image(Draw(TruePose(model), true));
  const ContourEvidence whole = EvidenceOf(model, image, TruePose(model));
  EXPECT_NEAR(whole.seen, 1, 1e-9);
  const double middle_px = whole.box.x + whole.box.width / 2;
  const ContourEvidence half =
      EvidenceOf(model, image, TruePose(model), [&](const Eigen::Vector2d& at_px) { return at_px.x() < middle_px; });
  EXPECT_NEAR(half.seen, 0.5, 0.2);
  EXPECT_NEAR(half.mean, half.seen * whole.mean, 0.1 * whole.mean);
}

TEST(ContourPose, StepIsLargeOfBodiesAndSmallOfLines) {
  const ContourModel model = MakeBox(kBox_m);
  const ContourPose pose = TruePose(model);
  EXPECT_LT(EvidenceOf(model, ContourImage(DrawLines(model, pose)), pose).step, 0.4);
  EXPECT_GT(EvidenceOf(model, ContourImage(Draw(pose, false)), pose).step, 0.8);
}

TEST(ContourPose, WrongPoseHasEvidenceAgainstIt) {
  const ContourModel model = MakeBox(kBox_m);
  const ContourImage image(Draw(TruePose(model), true));
  ContourPose wrong = TruePose(model);
  wrong.centre_in_camera_m.x() += 0.3;
  EXPECT_LT(EvidenceOf(model, image, wrong).decades, 0);
}

TEST(ContourSearch, LinesAndPartsOfAShapeAreNotSignificant) {
  const ContourEvidence whole{.decades = 100, .mean = 0.6, .hit_fraction = 0.95, .seen = 1, .step = 0.7};
  EXPECT_DOUBLE_EQ(NegLog10NfaOf(whole), 4);
  ContourEvidence lines = whole;
  lines.step = 0.2;
  EXPECT_LT(NegLog10NfaOf(lines), 0);
  ContourEvidence part = whole;
  part.hit_fraction = 0.7;
  EXPECT_LT(NegLog10NfaOf(part), 0);
  part.hit_fraction = 0.825;
  EXPECT_NEAR(NegLog10NfaOf(part), 1.5, 1e-9);
  part.step = 0.4;
  EXPECT_NEAR(NegLog10NfaOf(part), 0.25, 1e-9);
}

TEST(ContourSearch, MatchIsSeenAlongTheLineOfSight) {
  const ViewDirection direction{.azimuth_rad = 1, .off_nadir_rad = 0.7};
  const Vector3d centre(1, -0.5, 5);
  ContourMatch match;
  match.pose.camera_from_model = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), centre).toRotationMatrix() *
                                 Eigen::AngleAxisd(0.2, Vector3d::UnitZ()).toRotationMatrix() *
                                 CameraFromModel(direction).toRotationMatrix();
  match.pose.centre_in_camera_m = centre;
  match.pose.focal_px = 700;
  const ShapeMatch found = ShapeMatchOf(match, 3, {640, 480});
  EXPECT_EQ(found.model_index, 3);
  EXPECT_NEAR(found.to_camera.azimuth_rad, 1, 1e-9);
  EXPECT_NEAR(found.to_camera.off_nadir_rad, 0.7, 1e-9);
  EXPECT_NEAR(found.lean_rad, 0.2, 1e-9);
  EXPECT_NEAR(found.pixels_per_m, 140, 1e-9);
  EXPECT_NEAR((found.centre_px - Eigen::Vector2d(460, 170)).norm(), 0, 1e-9);
}

TEST(ContourSearch, FindsABoxInAnUnknownPose) {
  const ContourModel model = MakeBox(kBox_m);
  const ContourPose truth = TruePose(model);
  const cv::Mat grey = Draw(truth, true);
  const cv::Mat before = grey.clone();
  const std::optional<ContourMatch> match = FindByContours(model, grey);
  EXPECT_EQ(cv::countNonZero(grey != before), 0) << "other stages read the frame, too";
  ASSERT_TRUE(match);
  const cv::Rect2d box = EvidenceOf(model, ContourImage(grey), truth).box;
  const double common = (match->evidence.box & box).area();
  EXPECT_GT(common / (match->evidence.box.area() + box.area() - common), 0.8);
  EXPECT_GE(match->neg_log10_nfa, kMinContourNegLog10Nfa);
}

TEST(ContourSearch, FindsAKnownPoseAgain) {
  const ContourModel model = MakeBox(kBox_m);
  const cv::Mat grey = Draw(TruePose(model), true);
  ContourPose start = TruePose(model);
  start.centre_in_camera_m += Vector3d(0.04, 0.04, 0.1);
  const cv::Mat before = grey.clone();
  const std::optional<ContourMatch> match = FindContoursNear(model, grey, start);
  EXPECT_EQ(cv::countNonZero(grey != before), 0);
  ASSERT_TRUE(match);
  EXPECT_NEAR(match->evidence.box.x, EvidenceOf(model, ContourImage(grey), TruePose(model)).box.x, 5);
  start.centre_in_camera_m.x() -= 1.5;  // beside it
  EXPECT_FALSE(FindContoursNear(model, grey, start));
}

TEST(ContourSearch, FindsNothingOfABoxOfAnotherShape) {
  const ContourModel model = MakeBox(kBox_m);
  const cv::Mat grey = Draw(TruePose(model), true);
  EXPECT_FALSE(FindByContours(MakeBox({0.7, 1.6, 1.2}), grey));
}

TEST(ContourSearch, FindsNothingInStripes) {
  const ContourModel model = MakeBox(kBox_m);
  cv::Mat grey(480, 640, CV_8U, cv::Scalar(90));
  for (int x = 20; x < 640; x += 40) cv::line(grey, {x, 0}, {x - 60, 480}, cv::Scalar(160), 8);
  EXPECT_FALSE(FindByContours(model, grey));
}

}  // namespace
}  // namespace victorious
