// Figure 3.18 and section 3.5.9: detection of CAD models in real images. The thesis shows one image of a vehicle. Here
// the objects have both a video and a CAD file: a tea box, and a cube and a dragon whose poses are known in every
// frame. Their CAD files have no colours, so that each object is searched for twice: untextured, and textured with the
// first frame.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "experiments/painted_mesh.h"
#include "experiments/real_objects.h"
#include "experiments/recognition_experiments.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/lab/evaluate/score.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/place/observe/object_pose.h"

namespace victorious {
namespace {

// The result of the search in one image.
struct ViewResult {
  std::optional<Detection> detection;
  std::optional<ObjectPose> object_pose;
  std::vector<Eigen::Vector2d> matched;  // scene keypoints of the inliers, px
};

CameraState CameraOf(const RealView& view) { return {.hfov_rad = 2 * std::atan(view.bgr.cols / 2.0 / view.focal_px)}; }

Expected<ViewResult> Search(const RealView& view, const Recognizer& recognizer, const FeatureExtractor& extractor,
                            const ObservationOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet features, extractor.Extract(GreyFromBgr(view.bgr)));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Detection> detections, recognizer.Recognize(features));
  ViewResult result;
  if (detections.empty()) return result;
  result.detection = detections.front();
  result.object_pose =
      EstimateObjectPose(detections.front(), recognizer.models()[0], features, CameraOf(view), options);
  for (const FitInlier& inlier : detections.front().fit.inliers) {
    const Keypoint& keypoint = features.keypoints[inlier.scene_keypoint];
    result.matched.emplace_back(keypoint.x, keypoint.y);
  }
  return result;
}

// Draws the edges of the object's 3-D bounding box.
void DrawBox(const Rigid3& camera_from_object, const Eigen::AlignedBox3d& box, double focal_px,
             const cv::Scalar& colour, cv::Mat& image) {
  const auto corner = [&](int which) {
    const Eigen::Vector3d half = box.diagonal() / 2;
    const Eigen::Vector3d at((which & 1) != 0 ? half.x() : -half.x(), (which & 2) != 0 ? half.y() : -half.y(),
                             (which & 4) != 0 ? half.z() : -half.z());
    const Eigen::Vector3d p = camera_from_object.Apply(at);
    return cv::Point2d(focal_px * p.x() / p.z() + image.cols / 2.0, focal_px * p.y() / p.z() + image.rows / 2.0);
  };
  for (int a = 0; a < 8; ++a) {
    for (const int bit : {1, 2, 4}) {
      if ((a & bit) == 0) cv::line(image, corner(a), corner(a | bit), colour, 2, cv::LINE_AA);
    }
  }
}

cv::Mat Draw(const RealView& view, const ViewResult& result, const Eigen::AlignedBox3d& box) {
  cv::Mat image = view.bgr.clone();
  if (result.object_pose) DrawBox(*result.object_pose->camera_from_object, box, view.focal_px, {0, 255, 0}, image);
  for (const Eigen::Vector2d& at : result.matched) {
    cv::circle(image, cv::Point2d(at.x(), at.y()), 3, {0, 255, 255}, 1, cv::LINE_AA);
  }
  if (!result.detection) cv::rectangle(image, {0, 0, image.cols, image.rows}, {0, 0, 255}, 12);
  cv::resize(image, image, {}, 0.5, 0.5, cv::INTER_AREA);
  return image;
}

// Tiles at most twelve evenly chosen images, four per row.
cv::Mat MakeContactSheet(const std::vector<cv::Mat>& images) {
  constexpr std::size_t kMost = 12;
  constexpr std::size_t kColumns = 4;
  std::vector<cv::Mat> rows;
  std::vector<cv::Mat> row;
  const std::size_t count = std::min(kMost, images.size());
  for (std::size_t i = 0; i < count; ++i) {
    row.push_back(images[i * images.size() / count]);
    if (row.size() < kColumns && i + 1 < count) continue;
    while (row.size() < kColumns) row.emplace_back(cv::Mat::zeros(row.front().size(), row.front().type()));
    cv::hconcat(row, rows.emplace_back());
    row.clear();
  }
  cv::Mat sheet;
  cv::vconcat(rows, sheet);
  return sheet;
}

// Errors of the detections with known truth.
struct Errors {
  std::vector<double> view_deg;
  std::vector<double> turn_deg;  // angle of the rotation error
  std::vector<double> distance_percent;
  std::vector<double> middle_px;  // image distance of the centre of the bounding box
};

void AddErrors(const RealView& view, const ObjectPose& object_pose, Errors& errors) {
  if (!view.camera_from_object) return;
  const Rigid3& truth = *view.camera_from_object;
  const Rigid3& found = *object_pose.camera_from_object;
  const Eigen::Vector3d to_camera = found.rotation.conjugate() * -found.translation.normalized();
  const Eigen::Vector3d true_to_camera = truth.rotation.conjugate() * -truth.translation.normalized();
  errors.view_deg.push_back(DegreesFromRadians(std::acos(std::clamp(to_camera.dot(true_to_camera), -1.0, 1.0))));
  errors.turn_deg.push_back(DegreesFromRadians(found.rotation.angularDistance(truth.rotation)));
  errors.distance_percent.push_back(100 * std::abs(found.translation.norm() / truth.translation.norm() - 1));
  errors.middle_px.push_back(view.focal_px *
                             (found.translation.hnormalized() - truth.translation.hnormalized()).norm());
}

// Whether a detection lies within 40 px of the true centre; true for views without truth.
bool IsCorrectlyLocated(const RealView& view, const ViewResult& result) {
  if (!view.camera_from_object) return result.detection.has_value();
  const Eigen::Vector2d truth = view.focal_px * view.camera_from_object->translation.hnormalized();
  const Box& box = result.detection->box;
  const Eigen::Vector2d found =
      result.object_pose
          ? Eigen::Vector2d(view.focal_px * result.object_pose->camera_from_object->translation.hnormalized())
          : Eigen::Vector2d(box.x + (box.width - view.bgr.cols) / 2, box.y + (box.height - view.bgr.rows) / 2);
  constexpr double kFarPx = 40;
  return (found - truth).norm() < kFarPx;
}

// One row of the table; there is none if no view is left.
struct Trial {
  std::string object;
  std::string paint;
  const Mesh& mesh;
  const std::vector<RealView>& views;
  std::size_t first_view;  // the views before it supplied the texture
};

Status EvaluateTrial(const Trial& trial, const ExperimentSettings& settings, Report& report) {
  if (trial.views.size() <= trial.first_view) return {};  // the only image supplied the texture
  VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
  settings.progress(fmt::format("{}, {}", trial.object, trial.paint));
  CadModelOptions making;
  making.sphere.max_off_nadir_deg = 90;
  Expected<ObjectModel> model = MakeCadModel("object", trial.mesh, trial.object, making);
  const auto not_found = [&](const std::string& why) {
    report.rows.push_back({trial.object, trial.paint, static_cast<double>(trial.views.size() - trial.first_view), 0.0,
                           why, "-", "-", "-", "-", "-", "-"});
    return Status{};
  };
  // An untextured model: no view has features.
  if (!model && model.error().code == ErrorCode::kInvalidArgument) return not_found("no features");
  if (!model) return std::unexpected(std::move(model).error());
  const Eigen::AlignedBox3d box = *model->box_m;
  const IndexOptions options;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options.features));
  std::vector<ObjectModel> models;
  models.push_back(*std::move(model));
  VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer,
                              Recognizer::Create(std::move(models), options.features.engine, options.recognize));
  Errors errors;
  double found = 0;
  double wrong = 0;
  std::vector<cv::Mat> images;
  for (std::size_t i = trial.first_view; i < trial.views.size(); ++i) {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    const RealView& view = trial.views[i];
    VICTORIOUS_ASSIGN_OR_RETURN(const ViewResult result, Search(view, recognizer, *extractor, options.observation));
    images.push_back(Draw(view, result, box));
    if (!result.detection) continue;
    if (!IsCorrectlyLocated(view, result)) {
      ++wrong;
      continue;
    }
    ++found;
    if (result.object_pose) AddErrors(view, *result.object_pose, errors);
  }
  const auto views = static_cast<double>(trial.views.size() - trial.first_view);
  report.rows.push_back({trial.object, trial.paint, views, found / views, wrong, FormatPercentile(errors.view_deg, 50),
                         FormatPercentile(errors.view_deg, 90), FormatPercentile(errors.turn_deg, 50),
                         FormatPercentile(errors.distance_percent, 50), FormatPercentile(errors.middle_px, 50),
                         FormatPercentile(errors.middle_px, 90)});
  std::string name = fmt::format("figure3.18-{}-{}.png", trial.object, trial.paint);
  std::ranges::replace(name, ' ', '-');
  return WriteImage(settings.out / name, MakeContactSheet(images));
}

}  // namespace

Expected<Report> RunFigure318(const ExperimentSettings& settings) {
  Report report{
      .title = "Detection of CAD models in real images",
      .notes = {"SearchedBox with a known field of view and without telemetry; the first frame is left out if it "
                "supplied the texture. The true pose of cube and dragon is the first frame's pose, moved with a board "
                "of tags beside the object; frames of the tea box have no truth: judge by the images (green: box at "
                "the estimated pose; yellow: matches; red frame: not detected)."},
      .columns = {"object", "paint", "frames", "found", "elsewhere", "view error 50 %, deg", "90 %",
                  "rotation error 50 %, deg", "distance error 50 %, %", "centre offset 50 %, px", "90 %"}};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<RealObject> objects, LoadRealObjects(settings.data));
  for (const RealObject& object : objects) {
    VICTORIOUS_RETURN_IF_ERROR(EvaluateTrial({object.name, "plain", object.mesh, object.views, 0}, settings, report));
    const RealView& first = object.views.front();
    VICTORIOUS_ASSIGN_OR_RETURN(const Mesh painted, ProjectTexture(object.mesh, first.bgr, object.first_camera));
    VICTORIOUS_RETURN_IF_ERROR(EvaluateTrial({object.name, "painted", painted, object.views, 1}, settings, report));
    if (!object.other_views.empty()) {
      VICTORIOUS_RETURN_IF_ERROR(EvaluateTrial(
          {object.name + " by another camera", "painted", painted, object.other_views, 0}, settings, report));
    }
  }
  return report;
}

}  // namespace victorious
