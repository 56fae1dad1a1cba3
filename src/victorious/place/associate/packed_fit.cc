#include "victorious/place/associate/packed_fit.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

static_assert(std::endian::native == std::endian::little);

// Limits of what is read. A fit stays far below them; what is computed from numbers within them does not overflow.
constexpr double kMaxNumber = 1e30;
constexpr double kMaxAltitude_m = 1e9;
constexpr double kMaxRangeFactor = 2;  // either way; EstimateRangeFactor gives at most 1.28
constexpr double kMaxSigmaRatio = 100;
constexpr double kMaxErrorRatio = 100;
constexpr double kMaxLogFocalFactor = 1;  // EstimateFocalError gives at most 0.5
constexpr std::int64_t kMaxOverlapFrames = std::numeric_limits<std::int32_t>::max();
constexpr double kMinPositive = std::numeric_limits<double>::min();

// The smallest packed items, bytes.
constexpr std::size_t kFrameBytes = 1;
constexpr std::size_t kLengthErrorBytes = sizeof(std::int64_t) + sizeof(double) + sizeof(int);
constexpr std::size_t kOverlapBytes = 3 * sizeof(std::int64_t);
constexpr std::size_t kGeolocationBytes = (6 + 9) * sizeof(double) + 2;  // without a velocity

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
    PutFlag(value.has_value());
    return value.has_value();
  }
  void PutFlag(bool value) { Put(std::uint8_t{value}); }

  std::vector<std::byte> Take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

// Reads 0 beyond the end, and remembers that and every other fault of the bytes.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  /// A whole number in [low, high].
  template <typename T>
  T GetWhole(T low, T high) {
    static_assert(std::is_integral_v<T>);
    const T value = Get<T>();
    if (value < low || value > high) Fail();
    return value;
  }
  /// A number in [low, high]: never NaN or infinite.
  double GetNumber(double low = -kMaxNumber, double high = kMaxNumber) {
    const auto value = Get<double>();
    if (!(value >= low && value <= high)) Fail();
    return value;
  }
  template <typename Matrix>
  Matrix GetMatrix() {
    Matrix matrix;
    for (double& value : matrix.reshaped()) value = GetNumber();
    return matrix;
  }
  Eigen::Matrix3d GetCovariance() {
    auto covariance = GetMatrix<Eigen::Matrix3d>();
    if (!(covariance.diagonal().minCoeff() >= 0)) Fail();
    return covariance;
  }
  /// A number of at most `most`, in the bytes of Writer::PutCount: no more than are needed, of at most 64 bits.
  std::uint64_t GetCount(std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const auto byte = Get<std::uint8_t>();
      const std::uint64_t bits = byte & 0x7F;
      value |= bits << shift;
      if (byte >= 0x80) continue;
      if (value >> shift != bits || (bits == 0 && shift > 0) || value > most) Fail();
      return value;
    }
    Fail();
    return 0;
  }
  /// A number of items that the rest of the bytes can hold.
  /// @param item_bytes  of the smallest item
  std::size_t GetSize(std::size_t item_bytes) {
    const std::uint64_t size = GetCount();
    if (size > bytes_.size() / item_bytes) Fail();
    return failed_ ? 0 : static_cast<std::size_t>(size);
  }
  bool GetHas() { return GetWhole<std::uint8_t>(0, 1) != 0; }

  void Fail() { failed_ = true; }
  [[nodiscard]] bool HasFailed() const { return failed_; }

  /// True if all bytes were read, and no more, without a fault.
  [[nodiscard]] bool IsAtEnd() const { return !failed_ && bytes_.empty(); }

 private:
  template <typename T>
  T Get() {
    T value{};
    if (failed_ || sizeof(T) > bytes_.size()) {
      Fail();
      return value;
    }
    std::memcpy(&value, bytes_.data(), sizeof(T));
    bytes_ = bytes_.subspan(sizeof(T));
    return value;
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
  place.point.latitude_rad = reader.GetNumber(-kPi / 2, kPi / 2);
  place.point.longitude_rad = reader.GetNumber(-2 * kPi, 2 * kPi);
  place.point.altitude_m = reader.GetNumber(-kMaxAltitude_m, kMaxAltitude_m);
  place.time_s = reader.GetNumber();
  place.ce90_m = reader.GetNumber(0);
  place.le90_m = reader.GetNumber(0);
  place.covariance_enu_m2 = reader.GetCovariance();
  if (reader.GetHas()) place.velocity_enu = reader.GetMatrix<Eigen::Vector3d>();
  if (reader.GetHas()) place.velocity_covariance_enu = reader.GetCovariance();
  return place;
}

void PutPlace(const ObjectPlace& place, Writer& writer) {
  writer.PutCount(place.path_size);
  writer.Put(place.inlier_fraction);
  writer.Put(place.consistent_fraction);
  writer.PutCount(static_cast<std::uint64_t>(place.headings));
  writer.PutCount(static_cast<std::uint64_t>(place.contradicting_headings));
  if (writer.PutHas(place.heading_rad)) writer.Put(*place.heading_rad);
  if (writer.PutHas(place.size_ratio)) {
    writer.Put(*place.size_ratio);
    writer.Put(place.size_sigma);
  }
  if (writer.PutHas(place.place)) PutGeolocation(*place.place, writer);
}

ObjectPlace GetPlace(Reader& reader) {
  ObjectPlace place;
  place.path_size = static_cast<std::size_t>(reader.GetCount());
  place.inlier_fraction = reader.GetNumber(0, 1);
  place.consistent_fraction = reader.GetNumber(0, 1);
  constexpr std::uint64_t kMaxCount = std::numeric_limits<std::int32_t>::max();
  place.headings = static_cast<std::int64_t>(reader.GetCount(kMaxCount));
  place.contradicting_headings = static_cast<std::int64_t>(reader.GetCount(static_cast<std::uint64_t>(place.headings)));
  if (reader.GetHas()) place.heading_rad = reader.GetNumber(0, 2 * kPi);
  if (reader.GetHas()) {
    place.size_ratio = reader.GetNumber(kMinPositive);
    place.size_sigma = reader.GetNumber(0);
  }
  if (reader.GetHas()) place.place = GetGeolocation(reader);
  if (place.HasPath() && !place.place) reader.Fail();
  return place;
}

std::vector<std::int64_t> GetFrames(Reader& reader) {
  std::vector<std::int64_t> frames(reader.GetSize(kFrameBytes));
  std::int64_t before = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::int64_t most = std::numeric_limits<std::int64_t>::max() - before;
    const std::uint64_t step = reader.GetCount(static_cast<std::uint64_t>(most));
    if (step == 0 && i > 0) reader.Fail();  // two sightings in one frame
    if (reader.HasFailed()) return {};
    frames[i] = before += static_cast<std::int64_t>(step);
  }
  return frames;
}

}  // namespace

std::vector<std::byte> Pack(const HypothesisFits& fits) {
  Writer writer;
  if (writer.PutHas(fits.relative)) PutPlace(*fits.relative, writer);
  if (writer.PutHas(fits.absolute)) PutPlace(*fits.absolute, writer);
  if (writer.PutHas(fits.on_level)) {
    writer.Put(fits.on_level->level.altitude_m);
    writer.Put(fits.on_level->level.sigma_m);
    PutPlace(fits.on_level->place.relative, writer);
    if (writer.PutHas(fits.on_level->place.absolute)) PutGeolocation(*fits.on_level->place.absolute, writer);
  }
  if (writer.PutHas(fits.tracklet)) {
    const TrackletSummary& summary = fits.tracklet->summary;
    writer.Put(summary.log_odds);
    writer.PutCount(static_cast<std::uint64_t>(summary.recognitions));
    writer.PutCount(static_cast<std::uint64_t>(summary.by_shape));
    writer.PutCount(static_cast<std::uint64_t>(summary.missed));
    writer.Put(summary.size_px);
    writer.PutCount(static_cast<std::uint64_t>(summary.observations));
    writer.PutCount(static_cast<std::uint64_t>(summary.view_steps));
    writer.PutCount(static_cast<std::uint64_t>(summary.view_jumps));
    writer.PutCount(static_cast<std::uint64_t>(summary.views));
    writer.PutMatrix(summary.view_sum);
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
    fit.level.altitude_m = reader.GetNumber(-kMaxAltitude_m, kMaxAltitude_m);
    fit.level.sigma_m = reader.GetNumber(kMinPositive);
    fit.place.relative = GetPlace(reader);
    if (reader.GetHas()) fit.place.absolute = GetGeolocation(reader);
    if (fit.place.absolute && !fit.place.relative.HasPath()) reader.Fail();
  }
  if (reader.GetHas()) {
    HypothesisFits::Tracklet& tracklet = fits.tracklet.emplace();
    tracklet.summary.log_odds = reader.GetNumber();
    const std::uint64_t recognitions = reader.GetCount();
    const std::uint64_t by_shape = reader.GetCount(recognitions);
    const std::uint64_t missed = reader.GetCount();
    tracklet.summary.size_px = reader.GetNumber(0);
    const std::uint64_t observations = reader.GetCount();
    const std::uint64_t view_steps = reader.GetCount();
    const std::uint64_t view_jumps = reader.GetCount(view_steps);
    const std::uint64_t views = reader.GetCount();
    tracklet.summary.view_sum = reader.GetMatrix<Eigen::Vector3d>();
    tracklet.frames = GetFrames(reader);
    // A frame has one sighting.
    if (std::max({recognitions, missed, observations, view_steps, views}) > tracklet.frames.size()) reader.Fail();
    tracklet.summary.recognitions = static_cast<std::int64_t>(recognitions);
    tracklet.summary.by_shape = static_cast<std::int64_t>(by_shape);
    tracklet.summary.missed = static_cast<std::int64_t>(missed);
    tracklet.summary.observations = static_cast<std::int64_t>(observations);
    tracklet.summary.view_steps = static_cast<std::int64_t>(view_steps);
    tracklet.summary.view_jumps = static_cast<std::int64_t>(view_jumps);
    tracklet.summary.views = static_cast<std::int64_t>(views);
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
  if (writer.PutHas(fits.errors.focal)) {
    writer.Put(fits.errors.focal->log_factor);
    writer.Put(fits.errors.focal->sigma_ratio);
    writer.Put(fits.errors.focal->objects);
  }
  if (writer.PutHas(fits.errors.range)) {
    writer.Put(fits.errors.range->factor);
    writer.Put(fits.errors.range->objects);
  }
  writer.PutCount(fits.errors.lengths.size());
  for (const LengthError& length : fits.errors.lengths) {
    writer.Put(length.model);
    writer.Put(length.factor);
    writer.Put(length.objects);
  }
  if (writer.PutHas(fits.errors.telemetry)) {
    const TelemetryErrors& errors = *fits.errors.telemetry;
    for (const ErrorScale& scale : {errors.position, errors.attitude}) {
      writer.Put(scale.ratio);
      writer.PutFlag(scale.is_measured);
    }
    writer.PutFlag(errors.is_receiver_known);
    writer.Put(errors.clock_ratio);
    writer.Put(errors.focal_ratio);
    writer.Put(errors.objects);
    writer.Put(errors.frames);
  }
  writer.PutCount(fits.overlaps.size());
  for (const TrackletOverlap& overlap : fits.overlaps) {
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
    error.error_rad = reader.GetNumber(-kPi, kPi);
    error.objects = reader.GetWhole<int>(1, std::numeric_limits<int>::max());
  }
  if (reader.GetHas()) {
    FocalError& error = fits.errors.focal.emplace();
    error.log_factor = reader.GetNumber(-kMaxLogFocalFactor, kMaxLogFocalFactor);
    error.sigma_ratio = reader.GetNumber(kMinPositive, kMaxSigmaRatio);
    error.objects = reader.GetWhole<int>(1, std::numeric_limits<int>::max());
  }
  if (reader.GetHas()) {
    RangeFactor& factor = fits.errors.range.emplace();
    factor.factor = reader.GetNumber(1 / kMaxRangeFactor, kMaxRangeFactor);
    factor.objects = reader.GetWhole<int>(1, std::numeric_limits<int>::max());
  }
  fits.errors.lengths.resize(reader.GetSize(kLengthErrorBytes));
  for (LengthError& length : fits.errors.lengths) {
    length.model = reader.GetWhole<std::int64_t>(0, std::numeric_limits<std::int64_t>::max());
    length.factor = reader.GetNumber(1 / kMaxLengthFactor, kMaxLengthFactor);
    length.objects = reader.GetWhole<int>(1, std::numeric_limits<int>::max());
  }
  if (reader.GetHas()) {
    TelemetryErrors& errors = fits.errors.telemetry.emplace();
    for (ErrorScale* scale : {&errors.position, &errors.attitude}) {
      scale->ratio = reader.GetNumber(kMinPositive, kMaxErrorRatio);
      scale->is_measured = reader.GetHas();
    }
    errors.is_receiver_known = reader.GetHas();
    for (double* ratio : {&errors.clock_ratio, &errors.focal_ratio})
      *ratio = reader.GetNumber(kMinPositive, kMaxErrorRatio);
    errors.objects = reader.GetWhole<int>(1, std::numeric_limits<int>::max());
    errors.frames = reader.GetWhole<int>(1, std::numeric_limits<int>::max());
  }
  fits.overlaps.resize(reader.GetSize(kOverlapBytes));
  for (TrackletOverlap& overlap : fits.overlaps) {
    constexpr std::int64_t kMaxId = std::numeric_limits<std::int64_t>::max();
    overlap.first = reader.GetWhole<std::int64_t>(0, kMaxId);
    overlap.second = reader.GetWhole<std::int64_t>(0, kMaxId);
    overlap.frames = reader.GetWhole<std::int64_t>(1, kMaxOverlapFrames);
    if (overlap.first >= overlap.second) reader.Fail();
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
  std::vector<Geolocation> path(reader.GetSize(kGeolocationBytes));
  for (Geolocation& place : path) place = GetGeolocation(reader);
  if (!reader.IsAtEnd()) return std::nullopt;
  return path;
}

}  // namespace victorious
