#include "experiments/place_trials.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "experiments/pose_by_points.h"
#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;

Expected<nlohmann::json> ReadJson(const fs::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(path));
  auto json = ParseJson(text);
  if (!json) return std::unexpected(std::move(json).error().WithContext(path.string()));
  return json;
}

Error Damaged(const fs::path& path, const nlohmann::json::exception& error) {
  return {ErrorCode::kDataLoss, fmt::format("{}: not in the format of this survey: {}", path.string(), error.what())};
}

struct Survey {
  TangentPlane plane{GeodeticPoint()};  // east, north, up of the survey grid
  std::vector<std::string> names;
  std::vector<Vector3d> points;  // in the tangent plane, m
};

PlaceTrial MakePlaceTrial(const Survey& survey, std::size_t point) {
  PlaceTrial trial{.point = survey.names[point],
                   .truth = survey.plane.GeodeticFromEnu(survey.points[point]),
                   .locate_options = {},
                   .lines = {},
                   .others_height_m = 0,
                   .others_sigma_m = 0};
  std::vector<double> others_height_m;
  for (std::size_t i = 0; i < survey.points.size(); ++i) {
    if (i != point) others_height_m.push_back(survey.plane.GeodeticFromEnu(survey.points[i]).altitude_m);
  }
  const auto count = static_cast<double>(others_height_m.size());
  for (const double height_m : others_height_m) trial.others_height_m += height_m / count;
  double squares = 0;
  for (const double height_m : others_height_m) squares += std::pow(height_m - trial.others_height_m, 2);
  trial.others_sigma_m = std::sqrt(squares / (count - 1) * (1 + 1 / count));  // prediction error of a further point
  return trial;
}

struct Beach {
  Survey survey;
  PinholeCamera pinhole;
  LensDistortion lens = {};
  std::vector<Vector2d> clicked;                    // pixel of each point in the first frame
  std::vector<Eigen::Matrix<double, 6, 1>> frames;  // x, y, z; azimuth, tilt, roll
  Eigen::Matrix<double, 6, 1> telemetry;            // the same, as recorded
  double frame_s = 0;
};

template <typename Vector>
Vector ParseVector(const nlohmann::json& numbers) {
  Vector vector;
  for (Eigen::Index i = 0; i < vector.size(); ++i) vector(i) = numbers.at(static_cast<std::size_t>(i)).get<double>();
  return vector;
}

Beach ParseBeach(const nlohmann::json& json) {
  // An approximate position of the site; the axes are those of the survey. An error of 0.001 degrees is negligible.
  Beach beach{
      .survey = {.plane = TangentPlane({RadiansFromDegrees(-33.73), RadiansFromDegrees(151.30), 0}),
                 .names = {},
                 .points = {}},
      .pinhole = {},
      .clicked = {},
      .frames = {},
      .telemetry = ParseVector<Eigen::Matrix<double, 6, 1>>(json.at("telemetry_start_beta0_x_y_z_az_tilt_roll_rad")),
      .frame_s = json.at("frame_dt_s").get<double>()};
  const nlohmann::json& lens = json.at("lens");
  beach.pinhole = {lens.at("fx"),
                   lens.at("fy"),
                   lens.at("c0U"),
                   lens.at("c0V"),
                   static_cast<int>(lens.at("NU")),
                   static_cast<int>(lens.at("NV"))};
  beach.lens = {lens.at("d1"), lens.at("d2"), lens.at("t1"), lens.at("t2"), lens.at("d3")};
  const nlohmann::json& origin = json.at("local_origin");
  for (const nlohmann::json& point : json.at("gcps")) {
    const auto clicked = json.at("gcp_pixels_frame1_clicked").find(std::to_string(point.at("num").get<int>()));
    if (clicked == json.at("gcp_pixels_frame1_clicked").end()) continue;
    beach.survey.names.push_back(point.at("name"));
    beach.survey.points.emplace_back(point.at("E").get<double>() - origin.at("X0").get<double>(),
                                     point.at("N").get<double>() - origin.at("Y0").get<double>(),
                                     point.at("z").get<double>());
    beach.clicked.push_back(ParseVector<Vector2d>(*clicked));
  }
  for (const nlohmann::json& pose : json.at("solved_betas_per_frame_x_y_z_az_tilt_roll_rad_LOCAL")) {
    beach.frames.push_back(ParseVector<Eigen::Matrix<double, 6, 1>>(pose));
  }
  return beach;
}

GeoreferencedCamera CameraAt(const Beach& beach, const Eigen::Matrix<double, 6, 1>& pose) {
  return {.pinhole = beach.pinhole,
          .lens = beach.lens,
          .place = beach.survey.plane.GeodeticFromEnu(pose.head<3>()),
          .attitude = {.yaw_rad = pose(3), .pitch_rad = pose(4) - kPi / 2, .roll_rad = -pose(5)}};
}

// The error model of poses solved from points at a few hundred metres, with residuals of about a pixel.
LocateOptions SolvedErrors() {
  LocateOptions options;
  options.line.position_m = 0.1;
  options.common = {.position_m = 0.3,
                    .height_m = 0.3,
                    .heading_deg = 0.02,
                    .boresight_side_deg = 0,
                    .boresight_rise_deg = 0.02,
                    .range_fraction = 0};
  return options;
}

// Tracks the patch around a pixel into another image of the same camera from nearly the same place, by NCC with
// sub-pixel refinement (parabola). Returns std::nullopt below an NCC score of 0.7 or for a peak on the border.
std::optional<Vector2d> TrackPatch(const cv::Mat& first, const Vector2d& at, const cv::Mat& next) {
  constexpr int kHalf = 30;
  constexpr int kSearchRadius = 90;  // search radius, px, for the drift of a hovering drone
  constexpr double kMinNcc = 0.7;
  const cv::Point middle(static_cast<int>(at.x()), static_cast<int>(at.y()));
  const cv::Rect around(middle.x - kHalf, middle.y - kHalf, 2 * kHalf + 1, 2 * kHalf + 1);
  const cv::Rect within(middle.x - kHalf - kSearchRadius, middle.y - kHalf - kSearchRadius,
                        2 * (kHalf + kSearchRadius) + 1, 2 * (kHalf + kSearchRadius) + 1);
  const cv::Rect searched = within & cv::Rect({0, 0}, next.size());
  if ((around & cv::Rect({0, 0}, first.size())) != around || searched.width < around.width ||
      searched.height < around.height) {
    return std::nullopt;
  }
  cv::Mat ncc_scores;
  cv::matchTemplate(next(searched), first(around), ncc_scores, cv::TM_CCOEFF_NORMED);
  double best = 0;
  cv::Point peak;
  cv::minMaxLoc(ncc_scores, nullptr, &best, nullptr, &peak);
  if (best < kMinNcc || peak.x == 0 || peak.y == 0 || peak.x == ncc_scores.cols - 1 || peak.y == ncc_scores.rows - 1) {
    return std::nullopt;
  }
  const auto between = [](double before, double here, double after) {  // peak of the parabola through three values
    return (before - after) / (2 * (before - 2 * here + after));
  };
  const auto ncc_score = [&](int x, int y) { return static_cast<double>(ncc_scores.at<float>(y, x)); };
  return at + Vector2d(searched.x + peak.x - around.x, searched.y + peak.y - around.y) +
         Vector2d(between(ncc_score(peak.x - 1, peak.y), best, ncc_score(peak.x + 1, peak.y)),
                  between(ncc_score(peak.x, peak.y - 1), best, ncc_score(peak.x, peak.y + 1)));
}

// Reads the available images of the frames, grey, with their frame numbers from 0. Error: kNotFound without the first.
Expected<std::vector<std::pair<std::size_t, cv::Mat>>> ReadGreyFrames(const fs::path& folder, std::size_t frames) {
  std::vector<std::pair<std::size_t, cv::Mat>> images;
  for (std::size_t i = 0; i < frames; ++i) {
    const fs::path path = folder / fmt::format("narrabeenFrames{:04}.jpg", i + 1);
    std::error_code error;
    if (!fs::exists(path, error)) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(const Image image, ReadImage(path));
    images.emplace_back(i, GreyFromBgr(image.bgr));
  }
  if (!images.empty() && images.front().first == 0) return images;
  return Fail(ErrorCode::kNotFound, fmt::format("{}: expected narrabeenFrames0001.jpg", folder.string()));
}

struct River {
  Survey survey;
  PinholeCamera pinhole;
  LensDistortion lens = {};
  std::vector<Vector2d> seen;  // pixel of each point
};

River ParseRiver(const nlohmann::json& json) {
  River river{.survey = {.plane = TangentPlane({RadiansFromDegrees(50.8), RadiansFromDegrees(5.9), 0}),
                         .names = {},
                         .points = {}},
              .pinhole = {},
              .seen = {}};
  const nlohmann::json& matrix = json.at("camera_matrix");
  river.pinhole = {matrix.at(0).at(0), matrix.at(1).at(1), matrix.at(0).at(2),
                   matrix.at(1).at(2), json.at("width"),   json.at("height")};
  const nlohmann::json& lens = json.at("dist_coeffs");
  for (std::size_t i = 0; i < lens.size() && i < river.lens.size(); ++i) river.lens[i] = lens.at(i).at(0);
  const nlohmann::json& points = json.at("gcps").at("dst");
  const auto corner = ParseVector<Vector3d>(points.at(0));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto point = ParseVector<Vector3d>(points.at(i));
    river.survey.names.push_back(fmt::format("cross {}", i + 1));
    river.survey.points.emplace_back(point.x() - corner.x(), point.y() - corner.y(), point.z());
    river.seen.push_back(ParseVector<Vector2d>(json.at("gcps").at("src").at(i)));
  }
  return river;
}

}  // namespace

LineOfSight LineOfSightThrough(const Vector2d& pixel, const GeoreferencedCamera& camera, double time_s) {
  const Vector2d shown = camera.pinhole.Unproject(pixel).head<2>();
  const Vector3d direction =
      CameraFromEnu(camera.attitude).conjugate() * Undistort(shown, camera.lens).homogeneous().normalized();
  return {.time_s = time_s,
          .camera = camera.place,
          .azimuth_rad = std::atan2(direction.x(), direction.y()),
          .elevation_rad = std::asin(std::clamp(direction.z(), -1.0, 1.0)),
          .range_m = std::nullopt,
          .sigma_rad = 1 / camera.pinhole.fx,  // one pixel
          .sigma_range_m = std::nullopt};
}

Expected<std::vector<PlaceSeries>> LoadNarrabeen(const ExperimentSettings& settings) {
  const fs::path folder = settings.data / "real/geo_gcp/narrabeen_uav";
  VICTORIOUS_ASSIGN_OR_RETURN(const nlohmann::json json, ReadJson(folder / "truth.json"));
  Beach beach;
  try {
    beach = ParseBeach(json);
  } catch (const nlohmann::json::exception& error) {
    return std::unexpected(Damaged(folder / "truth.json", error));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto images, ReadGreyFrames(folder / "frames", beach.frames.size()));
  PlaceSeries solved{.name = "beach, solved poses", .trials = {}};
  PlaceSeries recorded{.name = "beach, telemetry", .trials = {}};
  for (std::size_t i = 0; i < beach.survey.points.size(); ++i) {
    solved.trials.push_back(MakePlaceTrial(beach.survey, i));
    recorded.trials.push_back(solved.trials.back());
    solved.trials.back().locate_options = SolvedErrors();
    recorded.trials.back().lines = {LineOfSightThrough(beach.clicked[i], CameraAt(beach, beach.telemetry), 0)};
    for (const auto& [frame, grey] : images) {
      const auto at = frame == 0 ? beach.clicked[i] : TrackPatch(images.front().second, beach.clicked[i], grey);
      if (!at) continue;
      solved.trials.back().lines.push_back(
          LineOfSightThrough(*at, CameraAt(beach, beach.frames[frame]), static_cast<double>(frame) * beach.frame_s));
    }
  }
  PlaceSeries with_stated_error = recorded;
  with_stated_error.name += ", stated 3 deg";
  for (PlaceTrial& trial : with_stated_error.trials) {
    trial.locate_options.common.heading_deg = trial.locate_options.common.boresight_rise_deg = 3;
  }
  return std::vector<PlaceSeries>{std::move(solved), std::move(recorded), std::move(with_stated_error)};
}

Expected<PlaceSeries> LoadGeul(const ExperimentSettings& settings) {
  const fs::path path = settings.data / "real/geo_gcp/geul_river/dk_cam_config.json";
  VICTORIOUS_ASSIGN_OR_RETURN(const nlohmann::json json, ReadJson(path));
  River river;
  try {
    river = ParseRiver(json);
  } catch (const nlohmann::json::exception& error) {
    return std::unexpected(Damaged(path, error));
  }
  PlaceSeries series{.name = "river, pose from the other crosses", .trials = {}};
  for (std::size_t i = 0; i < river.survey.points.size(); ++i) {
    std::vector<PointObservation> others;
    Vector3d middle = Vector3d::Zero();
    for (std::size_t k = 0; k < river.survey.points.size(); ++k) {
      if (k == i) continue;
      const Vector2d shown = river.pinhole.Unproject(river.seen[k]).head<2>();
      others.push_back({river.survey.points[k], Undistort(shown, river.lens)});
      middle += river.survey.points[k];
    }
    middle /= static_cast<double>(others.size());
    for (PointObservation& other : others) other.point -= middle;
    const auto pose = FitPoseToPoints(others, 2 / river.pinhole.fx);
    if (!pose) return Fail(ErrorCode::kDataLoss, fmt::format("{}: no camera pose fits the crosses", path.string()));
    const Rigid3 site_from_camera = pose->camera_from_object.Inverse();
    const Vector3d at = middle + site_from_camera.translation;
    const GeoreferencedCamera camera{.pinhole = river.pinhole,
                                     .lens = river.lens,
                                     .place = river.survey.plane.GeodeticFromEnu(at),
                                     .attitude = AttitudeFromRotation(pose->camera_from_object.rotation)};
    PlaceTrial& trial = series.trials.emplace_back(MakePlaceTrial(river.survey, i));
    const double shift_m = std::hypot(pose->sigma_range_m, site_from_camera.translation.norm() * pose->sigma_view_rad);
    const double turn_deg = DegreesFromRadians(std::hypot(pose->sigma_view_rad, pose->sigma_angle_rad));
    trial.locate_options.line.position_m = 0.01;  // a fixed camera
    trial.locate_options.common = {.position_m = shift_m,
                                   .height_m = shift_m,
                                   .heading_deg = turn_deg,
                                   .boresight_side_deg = 0,
                                   .boresight_rise_deg = turn_deg,
                                   .range_fraction = 0};
    constexpr int kImages = 30;
    for (int image = 0; image < kImages; ++image) {
      trial.lines.push_back(LineOfSightThrough(river.seen[i], camera, image));
    }
  }
  return series;
}

}  // namespace victorious
