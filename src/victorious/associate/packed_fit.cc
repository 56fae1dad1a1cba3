#include "victorious/associate/packed_fit.h"

#include <bit>
#include <cstring>
#include <type_traits>

namespace victorious {
namespace {

static_assert(std::endian::native == std::endian::little);

class Writer {
 public:
  template <typename T>
  void Put(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    const auto bytes = std::as_bytes(std::span(&value, 1));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  template <typename Matrix>
  void PutMatrix(const Matrix& matrix) {
    const auto bytes = std::as_bytes(std::span(matrix.data(), static_cast<std::size_t>(matrix.size())));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  /// A number of at least 0, small ones in few bytes (7 bits each, the last with the high bit clear).
  void PutCount(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<std::byte>(value | 0x80));
    bytes_.push_back(static_cast<std::byte>(value));
  }
  /// Whether there is a value.
  template <typename T>
  bool PutHas(const std::optional<T>& value) {
    Put(std::uint8_t{value.has_value()});
    return value.has_value();
  }

  std::vector<std::byte> Take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

// Reads 0 beyond the end, and remembers that.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename T>
  T Get() {
    T value{};
    GetInto(&value, sizeof(T));
    return value;
  }
  template <typename Matrix>
  Matrix GetMatrix() {
    Matrix matrix = Matrix::Zero();
    GetInto(matrix.data(), sizeof(double) * static_cast<std::size_t>(matrix.size()));
    return matrix;
  }
  std::uint64_t GetCount() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const auto byte = Get<std::uint8_t>();
      value |= static_cast<std::uint64_t>(byte & 0x7F) << shift;
      if (byte < 0x80) break;
    }
    return value;
  }
  /// A number of items, of at least one byte each.
  std::size_t GetSize() {
    const std::uint64_t size = GetCount();
    if (size > bytes_.size()) failed_ = true;
    return failed_ ? 0 : static_cast<std::size_t>(size);
  }
  bool GetHas() { return Get<std::uint8_t>() != 0; }

  /// True if all bytes were read, and no more.
  [[nodiscard]] bool IsAtEnd() const { return !failed_ && bytes_.empty(); }

 private:
  void GetInto(void* value, std::size_t size) {
    if (failed_ || size > bytes_.size()) {
      failed_ = true;
      return;
    }
    std::memcpy(value, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }

  std::span<const std::byte> bytes_;
  bool failed_ = false;
};

void PutGeolocation(const Geolocation& place, Writer& writer) {
  for (const double value : {place.point.latitude_rad, place.point.longitude_rad, place.point.altitude_m, place.time_s,
                             place.ce90_m, place.le90_m}) {
    writer.Put(value);
  }
  writer.PutMatrix(place.covariance_enu_m2);
  if (writer.PutHas(place.velocity_enu)) writer.PutMatrix(*place.velocity_enu);
  if (writer.PutHas(place.velocity_covariance_enu)) writer.PutMatrix(*place.velocity_covariance_enu);
}

Geolocation GetGeolocation(Reader& reader) {
  Geolocation place;
  for (double* value : {&place.point.latitude_rad, &place.point.longitude_rad, &place.point.altitude_m, &place.time_s,
                        &place.ce90_m, &place.le90_m}) {
    *value = reader.Get<double>();
  }
  place.covariance_enu_m2 = reader.GetMatrix<Eigen::Matrix3d>();
  if (reader.GetHas()) place.velocity_enu = reader.GetMatrix<Eigen::Vector3d>();
  if (reader.GetHas()) place.velocity_covariance_enu = reader.GetMatrix<Eigen::Matrix3d>();
  return place;
}

void PutPlace(const ObjectPlace& place, Writer& writer) {
  writer.PutCount(place.path_size);
  writer.Put(place.inlier_fraction);
  writer.Put(place.consistent_fraction);
  if (writer.PutHas(place.heading_rad)) writer.Put(*place.heading_rad);
  if (writer.PutHas(place.size_ratio)) writer.Put(*place.size_ratio);
  if (writer.PutHas(place.place)) PutGeolocation(*place.place, writer);
}

ObjectPlace GetPlace(Reader& reader) {
  ObjectPlace place;
  place.path_size = static_cast<std::size_t>(reader.GetCount());
  place.inlier_fraction = reader.Get<double>();
  place.consistent_fraction = reader.Get<double>();
  if (reader.GetHas()) place.heading_rad = reader.Get<double>();
  if (reader.GetHas()) place.size_ratio = reader.Get<double>();
  if (reader.GetHas()) place.place = GetGeolocation(reader);
  return place;
}

}  // namespace

std::vector<std::byte> Pack(const HypothesisFits& fits) {
  Writer writer;
  if (writer.PutHas(fits.relative)) PutPlace(*fits.relative, writer);
  if (writer.PutHas(fits.absolute)) PutPlace(*fits.absolute, writer);
  if (writer.PutHas(fits.on_level)) {
    writer.Put(fits.on_level->level.altitude_m);
    writer.Put(fits.on_level->level.sigma_m);
    PutPlace(fits.on_level->place, writer);
  }
  if (writer.PutHas(fits.tracklet)) {
    const TrackletSummary& summary = fits.tracklet->summary;
    writer.Put(summary.log_odds);
    writer.PutCount(static_cast<std::uint64_t>(summary.recognitions));
    writer.PutCount(static_cast<std::uint64_t>(summary.observations));
    writer.PutCount(fits.tracklet->frames.size());
    std::int64_t before = 0;
    for (const std::int64_t frame : fits.tracklet->frames) {
      writer.PutCount(static_cast<std::uint64_t>(frame - before));
      before = frame;
    }
  }
  return writer.Take();
}

std::optional<HypothesisFits> UnpackHypothesisFits(std::span<const std::byte> bytes) {
  Reader reader(bytes);
  HypothesisFits fits;
  if (reader.GetHas()) fits.relative = GetPlace(reader);
  if (reader.GetHas()) fits.absolute = GetPlace(reader);
  if (reader.GetHas()) {
    HypothesisFits::LevelFit& fit = fits.on_level.emplace();
    fit.level.altitude_m = reader.Get<double>();
    fit.level.sigma_m = reader.Get<double>();
    fit.place = GetPlace(reader);
  }
  if (reader.GetHas()) {
    HypothesisFits::Tracklet& tracklet = fits.tracklet.emplace();
    tracklet.summary.log_odds = reader.Get<double>();
    tracklet.summary.recognitions = static_cast<std::int64_t>(reader.GetCount());
    tracklet.summary.observations = static_cast<std::int64_t>(reader.GetCount());
    tracklet.frames.resize(reader.GetSize());
    std::int64_t frame = 0;
    for (std::int64_t& one : tracklet.frames) one = frame += static_cast<std::int64_t>(reader.GetCount());
  }
  if (!reader.IsAtEnd()) return std::nullopt;
  return fits;
}

std::vector<std::byte> Pack(const FlightFits& fits) {
  Writer writer;
  if (writer.PutHas(fits.errors.heading)) {
    writer.Put(fits.errors.heading->error_rad);
    writer.Put(fits.errors.heading->objects);
  }
  if (writer.PutHas(fits.errors.range)) {
    writer.Put(fits.errors.range->factor);
    writer.Put(fits.errors.range->objects);
  }
  writer.PutCount(fits.overlaps.size());
  for (const PixelOverlap& overlap : fits.overlaps) {
    writer.Put(overlap.first);
    writer.Put(overlap.second);
    writer.Put(overlap.frames);
  }
  return writer.Take();
}

std::optional<FlightFits> UnpackFlightFits(std::span<const std::byte> bytes) {
  Reader reader(bytes);
  FlightFits fits;
  if (reader.GetHas()) {
    HeadingError& error = fits.errors.heading.emplace();
    error.error_rad = reader.Get<double>();
    error.objects = reader.Get<int>();
  }
  if (reader.GetHas()) {
    RangeFactor& factor = fits.errors.range.emplace();
    factor.factor = reader.Get<double>();
    factor.objects = reader.Get<int>();
  }
  fits.overlaps.resize(reader.GetSize());
  for (PixelOverlap& overlap : fits.overlaps) {
    overlap.first = reader.Get<std::int64_t>();
    overlap.second = reader.Get<std::int64_t>();
    overlap.frames = reader.Get<std::int64_t>();
  }
  if (!reader.IsAtEnd()) return std::nullopt;
  return fits;
}

std::vector<std::byte> Pack(std::span<const Geolocation> path) {
  Writer writer;
  writer.PutCount(path.size());
  for (const Geolocation& place : path) PutGeolocation(place, writer);
  return writer.Take();
}

std::optional<std::vector<Geolocation>> UnpackPath(std::span<const std::byte> bytes) {
  Reader reader(bytes);
  std::vector<Geolocation> path(reader.GetSize());
  for (Geolocation& place : path) place = GetGeolocation(reader);
  if (!reader.IsAtEnd()) return std::nullopt;
  return path;
}

}  // namespace victorious
