// Figure 3.16: objects detected in an image of every scene file, with the box and the matched template; and the numbers
// of detections, misses and false positives.
#include <algorithm>
#include <array>
#include <map>
#include <set>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "experiments/draw_matches.h"
#include "experiments/match_experiments.h"
#include "experiments/match_pool.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/image/montage.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/lab/evaluate/score.h"
#include "victorious/object/model/view_surface.h"

namespace victorious {
namespace {

constexpr std::array kKinds = {"jeep", "tank", "helicopter", "jet"};
constexpr double kFoundOverlap = 0.5;  // minimum IoU of a detection with the true box
constexpr double kMinVisible = 0.5;

struct DetectionCounts {
  int in_view = 0;
  int found = 0;
  int false_positives = 0;  ///< false positives
  std::vector<double> view_errors_deg;
};

// A detection to draw.
struct ShownDetection {
  const AnnotatedImage* scene;
  const ModelView* view;
  Box box;
  std::string caption;
  bool right;
};

double ViewErrorDegrees(const ModelView& view, const LabelledObject& object) {
  return DegreesFromRadians(AngleBetween(*view.angles, object.view));
}

// Compares the detections of an image with its truth and updates the count of each model.
void ScoreDetections(const AnnotatedImage& scene, const std::vector<Detection>& detections,
                     const std::vector<ObjectModel>& models, std::map<std::string, DetectionCounts>& counts,
                     std::vector<ShownDetection>& shown) {
  std::set<const LabelledObject*> found;
  for (const Detection& detection : detections) {
    const std::string kind = kKinds[detection.model_index];
    const ModelView& view = models[detection.model_index].views[detection.view];
    const LabelledObject* best = nullptr;
    for (const LabelledObject& object : scene.objects) {
      const bool better =
          object.model == kind && (best == nullptr || IntersectionOverUnion(object.box, detection.box) >
                                                          IntersectionOverUnion(best->box, detection.box));
      if (better) best = &object;
    }
    const bool right = best != nullptr && IntersectionOverUnion(best->box, detection.box) >= kFoundOverlap;
    if (!right) ++counts[kind].false_positives;
    if (right && best->visible >= kMinVisible && found.insert(best).second) {
      ++counts[kind].found;
      counts[kind].view_errors_deg.push_back(ViewErrorDegrees(view, *best));
    }
    shown.push_back({&scene, &view, detection.box, fmt::format("{} in {}", kind, scene.name), right});
  }
  for (const LabelledObject& object : scene.objects) {
    const bool sought = std::ranges::find(kKinds, object.model) != kKinds.end();
    if (sought && object.visible >= kMinVisible) ++counts[object.model].in_view;
  }
}

// Draws the whole image, the crop around the box and the template, from top to bottom.
Expected<cv::Mat> Column(const ShownDetection& shown) {
  constexpr int kSide = 176;
  constexpr int kWhole = 132;
  cv::Mat grey;
  cv::cvtColor(GreyFromBgr(shown.scene->bgr), grey, cv::COLOR_GRAY2BGR);
  const cv::Scalar colour = shown.right ? cv::Scalar(60, 220, 60) : cv::Scalar(40, 40, 255);
  const cv::Rect box(static_cast<int>(shown.box.x), static_cast<int>(shown.box.y), static_cast<int>(shown.box.width),
                     static_cast<int>(shown.box.height));
  cv::rectangle(grey, box, colour, 2);
  cv::Mat whole;
  cv::resize(grey, whole, cv::Size(kSide, kWhole), 0, 0, cv::INTER_AREA);
  const int side = std::min({std::max(box.width, box.height) + 30, grey.cols, grey.rows});
  const cv::Point corner(std::clamp(box.x + box.width / 2 - side / 2, 0, grey.cols - side),
                         std::clamp(box.y + box.height / 2 - side / 2, 0, grey.rows - side));
  cv::Mat part;
  cv::resize(grey(cv::Rect(corner, cv::Size(side, side))), part, cv::Size(kSide, kSide), 0, 0, cv::INTER_AREA);
  VICTORIOUS_ASSIGN_OR_RETURN(const ViewSurface surface, DecodeSurface(shown.view->surface, shown.view->source));
  cv::Mat object;
  cv::cvtColor(surface.grey, object, cv::COLOR_GRAY2BGR);
  cv::resize(object, object, cv::Size(kSide, kSide), 0, 0, cv::INTER_AREA);
  cv::Mat column;
  cv::vconcat(std::vector<cv::Mat>{whole, part, object}, column);
  constexpr double kStep = 24;  // step of the grey levels; few levels keep the file small
  cv::medianBlur(column, column, 3);
  column.convertTo(column, CV_8U, 1 / kStep);
  column.convertTo(column, CV_8U, kStep);
  cv::putText(column, shown.caption, {3, 12}, cv::FONT_HERSHEY_SIMPLEX, 0.33, cv::Scalar::all(255), 1);
  return column;
}

// Tiles up to four true detections, one per model, and one false positive if there is any.
Expected<cv::Mat> DrawDetections(const std::vector<ShownDetection>& shown) {
  std::vector<cv::Mat> columns;
  std::set<std::string> kinds;
  for (const bool right : {true, false}) {
    for (const ShownDetection& one : shown) {
      const std::string kind = one.caption.substr(0, one.caption.find(' '));
      const std::size_t most = kKinds.size() + (right ? 0 : 1);
      if (one.right != right || columns.size() >= most || (right && !kinds.insert(kind).second)) continue;
      VICTORIOUS_ASSIGN_OR_RETURN(cv::Mat column, Column(one));
      columns.push_back(std::move(column));
    }
  }
  if (columns.empty()) return cv::Mat(1, 1, CV_8UC3, cv::Scalar::all(0));
  return Montage(columns, static_cast<int>(columns.size()));
}

}  // namespace

Expected<Report> RunFigure316(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<PooledScene> scenes, PoolScenes(settings, 1, IncludeMovies::kNo));
  Report report{
      .title = "Objects detected in one image of each scene, with all views of four models",
      .columns = {"setting", "object", "in view", "found", "false detections", "view error (degrees), median"}};
  std::vector<MatchSetup> setups = {ThesisSetup(), DefaultSetup()};
  setups.back().recognize.method = SearchMethod::kVotes;
  for (const MatchSetup& setup : setups) {
    std::vector<ObjectModel> models;
    for (const char* kind : kKinds) {
      VICTORIOUS_ASSIGN_OR_RETURN(
          const auto model,
          LoadOrBuildModel(settings, scenes.front().cad_folder / fmt::format("{}.glb", kind), setup.cad));
      models.push_back(*model);
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer,
                                Recognizer::Create(models, setup.features.engine, setup.recognize));
    std::map<std::string, DetectionCounts> counts;
    std::vector<ShownDetection> shown;
    for (const PooledScene& pooled : scenes) {
      VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
      VICTORIOUS_ASSIGN_OR_RETURN(const auto features, ExtractImageFeatures(*pooled.scene, setup.features));
      VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Detection> detections, recognizer.Recognize(*features));
      ScoreDetections(*pooled.scene, detections, models, counts, shown);
      settings.progress(fmt::format("{}: {}", setup.name, pooled.scene->name));
    }
    for (auto& [kind, count] : counts) {
      std::ranges::sort(count.view_errors_deg);
      Cell view_error = std::string();
      if (!count.view_errors_deg.empty()) view_error = count.view_errors_deg[count.view_errors_deg.size() / 2];
      report.rows.push_back({setup.name, kind, static_cast<double>(count.in_view), static_cast<double>(count.found),
                             static_cast<double>(count.false_positives), view_error});
    }
    if (setup.kind != MatchSetup::Kind::kDefault) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat image, DrawDetections(shown));
    VICTORIOUS_RETURN_IF_ERROR(WriteImage(settings.out / "figure3.16.png", image));
  }
  report.notes = {
      fmt::format("Found: a detection of the model has an IoU of {:g} or more with the true box; in view: visible by "
                  "0.5 or more. Ours: votes of ranked matches, without telemetry. The "
                  "image: whole images, crops around the box, templates; true detections green, a false one red.",
                  kFoundOverlap)};
  return report;
}

}  // namespace victorious
