// For tests: simulated flights past landmarks, with telemetry and sightings of known error distribution.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/rotation_vector.h"
#include "victorious/place/navigate/navigate.h"

namespace victorious::testing {

struct LandmarkFlightOptions {
  std::uint64_t seed = 1;
  int frames = 120;
  double frame_rate = 10;
  int landmarks = 4;
  bool telemetry = true;
  double offset_position_m = 10;  // sigma of the telemetry offset along each axis
  double offset_attitude_deg = 3;
  double drift_position_m = 0.5;  // sigma of the random walk after one second
  double drift_attitude_deg = 0.15;
  double noise_position_m = 0;  // sigma of each row
  double noise_attitude_deg = 0;
  double jump_m = 0;            // step of the telemetry offset, east, in the middle of the flight
  double common_m = 0;          // sigma of the error common to all landmarks' places
  double landmark_m = 0;        // sigma of the given places of landmarks
  double outlier_fraction = 0;  // fraction of sightings that are outliers
};

/// A camera flies straight at a height of about 90 m, looking ahead and down at landmarks on the ground, and observes
/// those within 8 degrees of its optical axis.
class LandmarkFlight {
 public:
  explicit LandmarkFlight(const LandmarkFlightOptions& options)
      : random_(options.seed), options_(options), plane_({RadiansFromDegrees(52), RadiansFromDegrees(13), 80}) {
    PlaceLandmarks();
    for (int k = 0; k < options.frames; ++k) AddFrame(k);
    for (const NavigationFrame& frame : frames) {
      if (frame.measured) rows.push_back(*frame.measured);
    }
  }

  [[nodiscard]] NavigationInput input() const {
    return {frames,    rows,
            landmarks, landmarks_by_model,
            sightings, options_.common_m * options_.common_m * Eigen::Matrix3d::Identity()};
  }

  std::vector<NavigationFrame> frames;
  std::vector<CameraState> rows;
  std::vector<Landmark> landmarks;                           // with their given places
  std::vector<std::vector<std::size_t>> landmarks_by_model;  // each landmark has its own model
  std::vector<LandmarkSighting> sightings;
  std::vector<CameraState> truth;
  std::vector<bool> is_wrong;  // one per sighting

  /// (place, rotation): estimate minus truth, as in NavigatedFrame::covariance.
  [[nodiscard]] Vector6 ErrorOf(const NavigatedFrame& estimate, std::size_t frame) const {
    const TangentPlane plane(truth[frame].place);
    Vector6 error;
    error << plane.EnuFromGeodetic(estimate.camera.place),
        VectorFromRotation(CameraFromEnu(*estimate.camera.attitude) *
                           CameraFromEnu(*truth[frame].attitude).conjugate());
    return error;
  }

 private:
  static constexpr double kRangeM = 120;

  void PlaceLandmarks() {
    const Eigen::Vector3d common = options_.common_m * RandomStep(1, 1).head<3>();
    const double length_m = 6.0 * options_.frames / options_.frame_rate;
    for (int i = 0; i < options_.landmarks; ++i) {
      const double share = options_.landmarks > 1 ? static_cast<double>(i) / (options_.landmarks - 1) : 0.5;
      Landmark landmark{.model = "any", .place = {}, .heading_rad = random_.Uniform(0, 2 * kPi)};
      const Eigen::Vector3d place(share * length_m - length_m / 2, random_.Uniform(-9, 9), random_.Uniform(0, 2));
      true_places_.push_back(place);
      Eigen::Vector3d measured = place + common;
      for (double& axis : measured) axis += options_.landmark_m * random_.Normal();
      landmark.place = plane_.GeodeticFromEnu(measured);
      landmark.covariance_enu_m2 = options_.landmark_m * options_.landmark_m * Eigen::Matrix3d::Identity();
      landmarks_by_model.push_back({landmarks.size()});
      landmarks.push_back(landmark);
    }
  }

  Vector6 RandomStep(double position, double attitude) {
    Vector6 step;
    for (int i = 0; i < 6; ++i) step[i] = random_.Normal() * (i < 3 ? position : RadiansFromDegrees(attitude));
    return step;
  }

  void AddFrame(int k) {
    const double time_s = k / options_.frame_rate;
    const double at_m = 6 * (time_s - options_.frames / options_.frame_rate / 2);
    const double wave = std::sin(0.5 * time_s);
    CameraState state;
    state.time_s = time_s;
    state.attitude =
        Attitude{RadiansFromDegrees(10 + 2 * wave), RadiansFromDegrees(-55 + wave), RadiansFromDegrees(2 * wave)};
    const Eigen::Quaterniond camera_from_enu = CameraFromEnu(*state.attitude);
    const Eigen::Vector3d place =
        Eigen::Vector3d(at_m, 0, 0) - kRangeM * (camera_from_enu.conjugate() * Eigen::Vector3d::UnitZ());
    state.place = plane_.GeodeticFromEnu(place);
    truth.push_back(state);

    if (k == 0) offset_ = RandomStep(options_.offset_position_m, options_.offset_attitude_deg);
    const double root_s = std::sqrt(1 / options_.frame_rate);
    if (k > 0) offset_ += root_s * RandomStep(options_.drift_position_m, options_.drift_attitude_deg);
    if (k == options_.frames / 2) offset_[0] += options_.jump_m;
    NavigationFrame frame{time_s, std::nullopt};
    if (options_.telemetry) {
      const Vector6 off = offset_ + RandomStep(options_.noise_position_m, options_.noise_attitude_deg);
      frame.measured = state;
      frame.measured->place = plane_.GeodeticFromEnu(place + off.head<3>());
      frame.measured->attitude->yaw_rad += off[3];
      frame.measured->attitude->pitch_rad += off[4];
      frame.measured->attitude->roll_rad += off[5];
    }
    offsets.push_back(offset_);
    frames.push_back(frame);
    // The tangent plane's axes rotate by less than 1e-5 over the flight, so they serve as the local axes.
    for (std::size_t i = 0; i < landmarks.size(); ++i) Observe(i, camera_from_enu, place);
  }

  void Observe(std::size_t landmark, const Eigen::Quaterniond& camera_from_enu, const Eigen::Vector3d& place) {
    const Eigen::Vector3d in_camera = camera_from_enu * (true_places_[landmark] - place);
    if (in_camera.head<2>().norm() > std::tan(RadiansFromDegrees(8)) * in_camera.z()) return;
    const Eigen::Quaterniond upright(
        Eigen::AngleAxisd(kPi / 2 - *landmarks[landmark].heading_rad, Eigen::Vector3d::UnitZ()));
    Vector6 sigma;  // rotation 1.5 degrees; 0.3 px across at a focal length of 2300 px; 2 % of the range
    sigma << Eigen::Vector3d::Constant(RadiansFromDegrees(1.5)), 0.016, 0.016, 2.4;
    LandmarkSighting sighting;
    sighting.frame = frames.size() - 1;
    sighting.model = landmark;
    Vector6 error;
    for (int i = 0; i < 6; ++i) error[i] = -sigma[i] * random_.Normal();
    is_wrong.push_back(random_.Uniform() < options_.outlier_fraction);
    if (is_wrong.back()) error.tail<3>() += Eigen::Vector3d(random_.Uniform(-20, 20), random_.Uniform(-20, 20), -30);
    sighting.camera_from_landmark.rotation = RotationFromVector(error.head<3>()) * camera_from_enu * upright;
    sighting.camera_from_landmark.translation = in_camera + error.tail<3>();
    sighting.information = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
    sightings.push_back(sighting);
  }

  Random random_;
  LandmarkFlightOptions options_;
  TangentPlane plane_;
  std::vector<Eigen::Vector3d> true_places_;
  Vector6 offset_ = Vector6::Zero();

 public:
  std::vector<Vector6> offsets;  // of telemetry, (place, yaw, pitch, roll), without noise
};

}  // namespace victorious::testing
