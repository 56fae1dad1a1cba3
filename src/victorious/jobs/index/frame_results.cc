#include "victorious/jobs/index/frame_results.h"

#include <limits>
#include <utility>

#include "victorious/base/packed_bytes.h"

namespace victorious {
namespace {

// The least bytes of a frame, and of a sighting without outline and observation: bounds on damaged counts.
constexpr std::size_t kFrameBytes = sizeof(std::int64_t) + 2 + sizeof(std::uint64_t);
constexpr std::size_t kSightingBytes =
    3 * sizeof(std::int64_t) + 4 * sizeof(double) + sizeof(std::uint64_t) + 2 * sizeof(double) + 3 * sizeof(int) + 6;

void PutMotion(const Similarity2& motion, ByteWriter& writer) {
  for (const double value : {motion.scale, motion.rotation_rad, motion.translation.x(), motion.translation.y()})
    writer.Put(value);
}

Similarity2 GetMotion(ByteReader& reader) {
  Similarity2 motion;
  motion.scale = reader.Get<double>();
  motion.rotation_rad = reader.Get<double>();
  motion.translation.x() = reader.Get<double>();
  motion.translation.y() = reader.Get<double>();
  return motion;
}

void PutObservation(const BearingObservation& observation, ByteWriter& writer) {
  const LineOfSight& line = observation.line;
  for (const double value : {line.time_s, line.camera.latitude_rad, line.camera.longitude_rad, line.camera.altitude_m,
                             line.azimuth_rad, line.elevation_rad}) {
    writer.Put(value);
  }
  for (const std::optional<double>& value : {line.range_m, line.sigma_rad, line.sigma_range_m, observation.heading_rad,
                                             observation.sigma_position_m, observation.sigma_attitude_rad}) {
    writer.PutOptional(value);
  }
  writer.Put(observation.recognition_id);
  if (writer.PutHas(line.clock_shift)) {
    for (const double value : line.clock_shift->camera_enu_m) writer.Put(value);
    writer.Put(line.clock_shift->azimuth_rad);
    writer.Put(line.clock_shift->elevation_rad);
  }
  if (writer.PutHas(line.focal_shift)) {
    writer.Put(line.focal_shift->sigma);
    writer.Put(line.focal_shift->azimuth_rad);
    writer.Put(line.focal_shift->elevation_rad);
  }
}

BearingObservation GetObservation(ByteReader& reader) {
  BearingObservation observation;
  LineOfSight& line = observation.line;
  for (double* value : {&line.time_s, &line.camera.latitude_rad, &line.camera.longitude_rad, &line.camera.altitude_m,
                        &line.azimuth_rad, &line.elevation_rad}) {
    *value = reader.Get<double>();
  }
  for (std::optional<double>* value : {&line.range_m, &line.sigma_rad, &line.sigma_range_m, &observation.heading_rad,
                                       &observation.sigma_position_m, &observation.sigma_attitude_rad}) {
    *value = reader.GetOptional<double>();
  }
  observation.recognition_id = reader.Get<std::int64_t>();
  if (reader.Get<bool>()) {
    ClockShift& shift = line.clock_shift.emplace();
    for (double& value : shift.camera_enu_m) value = reader.Get<double>();
    shift.azimuth_rad = reader.Get<double>();
    shift.elevation_rad = reader.Get<double>();
  }
  if (reader.Get<bool>()) {
    FocalShift& shift = line.focal_shift.emplace();
    for (double* value : {&shift.sigma, &shift.azimuth_rad, &shift.elevation_rad}) *value = reader.Get<double>();
  }
  return observation;
}

void PutSighting(const SightingRecord& sighting, ByteWriter& writer) {
  writer.Put(sighting.video);
  writer.Put(sighting.model);
  writer.Put(sighting.time_s);
  for (const double value : {sighting.box.x, sighting.box.y, sighting.box.width, sighting.box.height})
    writer.Put(value);
  writer.Put(std::uint64_t{sighting.outline.size()});
  for (const Eigen::Vector2d& corner : sighting.outline) {
    writer.Put(corner.x());
    writer.Put(corner.y());
  }
  writer.Put(sighting.score);
  writer.Put(sighting.source);
  writer.Put(sighting.is_missed);
  writer.Put(sighting.matches);
  writer.Put(sighting.view_index);
  if (writer.PutHas(sighting.view)) {
    writer.Put(sighting.view->azimuth_rad);
    writer.Put(sighting.view->off_nadir_rad);
  }
  writer.Put(sighting.in_plane_rad);
  writer.PutOptional(sighting.sigma_view_rad);
  writer.PutOptional(sighting.distance_m);
  writer.PutOptional(sighting.sigma_distance_m);
  writer.PutOptional(sighting.track);
  if (writer.PutHas(sighting.observation)) PutObservation(*sighting.observation, writer);
}

SightingRecord GetSighting(std::int64_t frame, ByteReader& reader) {
  SightingRecord sighting{.frame = frame};
  sighting.video = reader.Get<std::int64_t>();
  sighting.model = reader.Get<std::int64_t>();
  sighting.time_s = reader.Get<double>();
  for (double* value : {&sighting.box.x, &sighting.box.y, &sighting.box.width, &sighting.box.height})
    *value = reader.Get<double>();
  sighting.outline.resize(reader.GetCount(2 * sizeof(double)));
  for (Eigen::Vector2d& corner : sighting.outline) {
    corner.x() = reader.Get<double>();
    corner.y() = reader.Get<double>();
  }
  sighting.score = reader.Get<double>();
  sighting.source = reader.GetEnum(SightingSource::kTracked);
  sighting.is_missed = reader.Get<bool>();
  sighting.matches = reader.Get<int>();
  sighting.view_index = reader.Get<int>();
  if (reader.Get<bool>()) {
    ViewDirection& view = sighting.view.emplace();
    view.azimuth_rad = reader.Get<double>();
    view.off_nadir_rad = reader.Get<double>();
  }
  sighting.in_plane_rad = reader.Get<double>();
  sighting.sigma_view_rad = reader.GetOptional<double>();
  sighting.distance_m = reader.GetOptional<double>();
  sighting.sigma_distance_m = reader.GetOptional<double>();
  sighting.track = reader.GetOptional<std::int64_t>();
  if (reader.Get<bool>()) sighting.observation = GetObservation(reader);
  return sighting;
}

}  // namespace

std::vector<std::byte> PackFrameResults(std::span<const FrameResult> results) {
  ByteWriter writer;
  writer.Put(std::uint64_t{results.size()});
  for (const FrameResult& result : results) {
    writer.Put(result.frame);
    writer.Put(result.is_whole);
    if (writer.PutHas(result.now_from_before)) PutMotion(*result.now_from_before, writer);
    writer.Put(std::uint64_t{result.sightings.size()});
    for (const SightingRecord& sighting : result.sightings) PutSighting(sighting, writer);
  }
  return writer.Take();
}

Expected<std::vector<FrameResult>> UnpackFrameResults(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  std::vector<FrameResult> results(reader.GetCount(kFrameBytes));
  for (FrameResult& result : results) {
    result.frame = reader.Get<std::int64_t>();
    result.is_whole = reader.Get<bool>();
    if (reader.Get<bool>()) result.now_from_before = GetMotion(reader);
    const std::size_t sightings = reader.GetCount(kSightingBytes);
    for (std::size_t i = 0; i < sightings && !reader.HasFailed(); ++i)
      result.sightings.push_back(GetSighting(result.frame, reader));
    if (reader.HasFailed()) break;
  }
  if (!reader.IsAtEnd()) {
    return Fail(ErrorCode::kDataLoss, "the stored results of a segment are damaged: submit the video again");
  }
  return results;
}

}  // namespace victorious
