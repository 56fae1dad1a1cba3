// Errors of the object pose: direction of view and distance, of the matched view and of the 6-DoF pose fitted to the
// matches, with full telemetry, with the field of view only, and without camera data.
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "experiments/movie_search.h"
#include "experiments/recognition_experiments.h"
#include "victorious/geometry/angles.h"
#include "victorious/lab/evaluate/score.h"
#include "victorious/place/observe/object_pose.h"

namespace victorious {
namespace {

// The errors with one kind of camera data, in one movie.
struct PoseErrors {
  std::vector<double> view_deg;
  std::vector<double> distance_percent;
  std::vector<double> view_sigmas;
  std::vector<double> distance_sigmas;
};

constexpr const char* kMatched = "matched view";
constexpr const char* kTelemetry = "telemetry";
constexpr const char* kFieldOfView = "field of view only";
constexpr const char* kNothing = "nothing";

// Errors by the kind of camera data.
using ErrorsOfModels = std::map<std::string, PoseErrors>;

void Add(const ObjectPose& object_pose, const TruthRow& truth, double distance_m, PoseErrors& errors) {
  const double error_rad = AngleBetween(object_pose.view->angles, *truth.view);
  errors.view_deg.push_back(DegreesFromRadians(error_rad));
  errors.view_sigmas.push_back(error_rad / object_pose.view->sigma_rad);
  if (!object_pose.range_m) return;
  errors.distance_percent.push_back(100 * std::abs(*object_pose.range_m / distance_m - 1));
  errors.distance_sigmas.push_back(std::abs(*object_pose.range_m - distance_m) / object_pose.sigma_range_m);
}

// Adds the true detections of a frame.
void AddFrame(const SearchedFrame& searched, const std::vector<ObjectModel>& models, const ObservationOptions& options,
              ErrorsOfModels& errors) {
  if (!searched.camera || !searched.camera->IsComplete()) return;
  for (std::size_t i = 0; i < searched.detections.size(); ++i) {
    const std::optional<TruthRow>& truth = searched.truth[i];
    if (!truth || !IsClear(*truth) || !truth->view || !truth->place) continue;
    const Detection& detection = searched.detections[i];
    const ObjectModel& model = models[detection.model_index];
    const double distance_m = TangentPlane(searched.camera->place).EnuFromGeodetic(*truth->place).norm();
    errors[kMatched].view_deg.push_back(
        DegreesFromRadians(AngleBetween(*model.views[detection.view].angles, *truth->view)));
    const std::pair<const char*, CameraState> cameras[] = {
        {kTelemetry, *searched.camera},
        {kFieldOfView, CameraState{.hfov_rad = searched.camera->hfov_rad, .distortion = searched.camera->distortion}},
        {kNothing, CameraState{}}};
    for (const auto& [name, camera] : cameras) {
      if (const auto object_pose =
              EstimateObjectPose(detection, model, searched.features, camera, options, UpInCamera(camera))) {
        Add(*object_pose, *truth, distance_m, errors[name]);
      }
    }
  }
}

void AddRows(const std::string& movie, const ErrorsOfModels& errors, Report& report) {
  for (const char* camera : {kMatched, kTelemetry, kFieldOfView, kNothing}) {
    const auto found = errors.find(camera);
    if (found == errors.end()) continue;
    const PoseErrors& e = found->second;
    report.rows.push_back({movie, camera, static_cast<double>(e.view_deg.size()), FormatPercentile(e.view_deg, 50),
                           FormatPercentile(e.view_deg, 90), FormatPercentile(e.distance_percent, 50),
                           FormatPercentile(e.distance_percent, 90), FormatPercentile(e.view_sigmas, 90),
                           FormatPercentile(e.distance_sigmas, 90)});
  }
}

}  // namespace

Expected<Report> RunTableObjectPose(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::filesystem::path> movies, FindMovies(settings));
  Report report{
      .title = "Errors of the object pose",
      .notes = {"True sightings of clear objects in at most 20 frames per movie. The view error is the angle between "
                "the true and the estimated direction to the camera. In sigmas, the expected 90 % quantile is 2.15 "
                "for the view (two axes) and 1.64 for the distance (one axis)."},
      .columns = {"movie", "camera data", "sightings", "view error 50 %, deg", "90 %", "distance error 50 %, %",
                  "90 %, %", "view error 90 %, sigmas", "distance error 90 %, sigmas"}};
  ErrorsOfModels all;
  for (const std::filesystem::path& movie : movies) {
    ErrorsOfModels errors;
    const MovieSearch search{.movie = movie, .options = {}};
    VICTORIOUS_RETURN_IF_ERROR(
        SearchMovie(search, settings, [&](const SearchedFrame& searched, const std::vector<ObjectModel>& models) {
          AddFrame(searched, models, search.options.observation, errors);
          return Status{};
        }));
    AddRows(movie.filename().string(), errors, report);
    for (const auto& [camera, e] : errors) {
      PoseErrors& sum = all[camera];
      for (const auto member : {&PoseErrors::view_deg, &PoseErrors::distance_percent, &PoseErrors::view_sigmas,
                                &PoseErrors::distance_sigmas}) {
        (sum.*member).insert((sum.*member).end(), (e.*member).begin(), (e.*member).end());
      }
    }
  }
  AddRows("all", all, report);
  report.plot = {.title = "Direction of view",
                 .x = {.label = "error, degrees", .low = 0, .high = 20},
                 .y = {.label = "fraction of sightings", .low = 0, .high = 1},
                 .lines = {}};
  for (const char* camera : {kMatched, kTelemetry, kFieldOfView, kNothing}) {
    report.plot.lines.push_back(MakeCumulativeLine(camera, all[camera].view_deg));
  }
  return report;
}

}  // namespace victorious
