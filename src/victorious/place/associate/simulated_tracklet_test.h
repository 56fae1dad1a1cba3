// Tracklets of a simulated flight, for the tests of data association.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/place/associate/observed_tracklet.h"

namespace victorious {

inline const GeodeticPoint kOrigin{RadiansFromDegrees(48), RadiansFromDegrees(11), 500};
inline constexpr double kFrameS = 0.1;

// Observations of an object from a camera that flies past.
struct SimulatedTracklet {
  std::int64_t id = 0;  // of the tracklet
  std::int64_t video = 1;
  std::int64_t model = 1;
  Eigen::Vector3d place_enu{0, 0, 1};
  Eigen::Vector3d velocity_enu{0, 0, 0};
  int first_frame = 0;
  int frames = 30;
  double score = 0.99;
  std::optional<double> first_score;  // score of the first frame, if different
  bool is_category = false;           // then there is no range
  double noise_rad = 1e-4;
  std::optional<double> heading_rad;  // std::nullopt: its course if it moves, else 1
  double heading_noise_rad = 0.05;
  std::optional<Eigen::Vector3d> body_m;  // length, width, height of a CAD model; then its sightings have boxes
  double too_large = 1;                   // ratio by which the ranges are wrong
  double camera_from_m = -60;             // east coordinate at frame 0
  double camera_speed_m_s = 12;
  Eigen::Vector3d camera_bias_enu{0, 0, 0};  // error of telemetry
};

// The box of a body in the image of a camera that looks at the origin. Offsets from the origin, m; heading clockwise
// from north.
inline Box BoxOfBody(const Eigen::Vector3d& camera, const Eigen::Vector3d& centre, const Eigen::Vector3d& body_m,
                     double heading_rad) {
  constexpr double kFocal_px = 2000;
  const Eigen::Vector3d forward = -camera.normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d down = forward.cross(right);
  const Eigen::Vector3d front(std::sin(heading_rad), std::cos(heading_rad), 0);
  const Eigen::Vector3d left(-front.y(), front.x(), 0);
  Eigen::AlignedBox2d box;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                               (corner & 4) != 0 ? 0.5 : -0.5);
    const Eigen::Vector3d extent = sign.cwiseProduct(body_m);
    const Eigen::Vector3d line =
        centre + extent.x() * front + extent.y() * left + extent.z() * Eigen::Vector3d::UnitZ() - camera;
    box.extend(Eigen::Vector2d(kFocal_px / line.dot(forward) * Eigen::Vector2d(line.dot(right), line.dot(down))));
  }
  return {box.min().x(), box.min().y(), box.sizes().x(), box.sizes().y()};
}

inline ObservedTracklet SimulateTracklet(const SimulatedTracklet& seen) {
  Random random(static_cast<std::uint64_t>(seen.id));
  const TangentPlane plane(kOrigin);
  const bool moves = seen.velocity_enu.norm() > 0;
  const double heading_rad =
      seen.heading_rad.value_or(moves ? std::atan2(seen.velocity_enu.x(), seen.velocity_enu.y()) : 1.0);
  ObservedTracklet tracklet{.record = {.id = seen.id, .object = seen.id, .video = seen.video, .model = seen.model}};
  tracklet.is_category = seen.is_category;
  tracklet.is_cad_model = seen.body_m.has_value();
  tracklet.record.frames = seen.frames;
  tracklet.record.score = seen.score;
  tracklet.record.first_time_s = kFrameS * seen.first_frame;
  tracklet.record.last_time_s = kFrameS * (seen.first_frame + seen.frames - 1);
  for (int frame = seen.first_frame; frame < seen.first_frame + seen.frames; ++frame) {
    const double time_s = kFrameS * frame;
    const Eigen::Vector3d camera(seen.camera_from_m + seen.camera_speed_m_s * time_s, -70, 100);
    const Eigen::Vector3d place = seen.place_enu + time_s * seen.velocity_enu;
    const Eigen::Vector3d line = place - camera;
    tracklet.frames.push_back(frame);
    if (seen.body_m) tracklet.boxes.push_back(BoxOfBody(camera, place, *seen.body_m, heading_rad));
    tracklet.scores.push_back(frame == seen.first_frame ? seen.first_score.value_or(seen.score) : seen.score);
    BearingObservation observation;
    observation.line = {.time_s = time_s,
                        .camera = plane.GeodeticFromEnu(camera + seen.camera_bias_enu),
                        .azimuth_rad = std::atan2(line.x(), line.y()) + seen.noise_rad * random.Normal(),
                        .elevation_rad = std::asin(line.z() / line.norm()) + seen.noise_rad * random.Normal(),
                        .range_m = line.norm() / seen.too_large * (1 + 0.02 * random.Normal()),
                        .sigma_rad = 1e-4};
    observation.line.sigma_range_m = 0.02 * *observation.line.range_m;
    if (seen.is_category) {
      observation.line.range_m.reset();
      observation.line.sigma_rad = seen.noise_rad;
    }
    observation.heading_rad =
        WrapAngle(heading_rad + seen.heading_noise_rad * random.Normal() + (frame % 4 == 0 ? kPi : 0));
    tracklet.observations.push_back(observation);
    tracklet.observation_frames.push_back(frame);
  }
  return tracklet;
}

}  // namespace victorious
