#include "victorious/input/telemetry/geoid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/klv.h"

namespace victorious {
namespace {

constexpr std::size_t kHeaderSize = 40;
constexpr std::size_t kMaxBytes = std::size_t{1} << 30;  // a grid of one arc minute has 933 MB

double DoubleAt(Bytes bytes, std::size_t at) { return std::bit_cast<double>(ReadUnsigned(bytes.subspan(at, 8))); }

}  // namespace

Expected<Geoid> Geoid::Read(const std::filesystem::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, kMaxBytes));
  auto geoid = Parse(bytes);
  if (!geoid) return std::unexpected(std::move(geoid).error().WithContext(path.string()));
  return geoid;
}

Expected<Geoid> Geoid::Parse(std::string_view text) {
  const Bytes bytes = AsBytes(text);
  if (bytes.size() < kHeaderSize) return Fail(ErrorCode::kDataLoss, "not a geoid grid: must be a .gtx file");
  Geoid geoid;
  geoid.south_deg_ = DoubleAt(bytes, 0);
  geoid.west_deg_ = DoubleAt(bytes, 8);
  geoid.latitude_step_deg_ = DoubleAt(bytes, 16);
  geoid.longitude_step_deg_ = DoubleAt(bytes, 24);
  const std::uint64_t rows = ReadUnsigned(bytes.subspan(32, 4));
  const std::uint64_t columns = ReadUnsigned(bytes.subspan(36, 4));
  const bool plausible = std::abs(geoid.south_deg_) <= 90 && std::abs(geoid.west_deg_) <= 360 &&
                         geoid.latitude_step_deg_ > 0 && geoid.latitude_step_deg_ <= 90 &&
                         geoid.longitude_step_deg_ > 0 && geoid.longitude_step_deg_ <= 90 && rows >= 2 && columns >= 2;
  if (!plausible || rows > kMaxBytes || columns > kMaxBytes ||
      bytes.size() != kHeaderSize + sizeof(float) * rows * columns) {
    return Fail(ErrorCode::kDataLoss, fmt::format("not a geoid grid, or truncated: must be a .gtx file"));
  }
  geoid.rows_ = static_cast<int>(rows);
  geoid.columns_ = static_cast<int>(columns);
  geoid.heights_m_.reserve(rows * columns);
  for (std::size_t at = kHeaderSize; at < bytes.size(); at += sizeof(float)) {
    geoid.heights_m_.push_back(
        std::bit_cast<float>(static_cast<std::uint32_t>(ReadUnsigned(bytes.subspan(at, sizeof(float))))));
  }
  return geoid;
}

std::optional<double> Geoid::UndulationAt(double latitude_rad, double longitude_rad) const {
  constexpr double kFullCircle_deg = 360;
  const double y = (DegreesFromRadians(latitude_rad) - south_deg_) / latitude_step_deg_;
  const double east_deg = DegreesFromRadians(longitude_rad) - west_deg_;
  const double x = (east_deg - kFullCircle_deg * std::floor(east_deg / kFullCircle_deg)) / longitude_step_deg_;
  const bool is_periodic =
      columns_ * longitude_step_deg_ >= kFullCircle_deg - 1e-6;  // the grid is periodic in longitude
  if (!(y >= 0 && y <= rows_ - 1 && x >= 0 && x <= (is_periodic ? columns_ : columns_ - 1))) return std::nullopt;
  const int row = std::min(static_cast<int>(y), rows_ - 2);
  const int column = std::min(static_cast<int>(x), is_periodic ? columns_ - 1 : columns_ - 2);
  const auto at = [&](int r, int c) {
    return static_cast<double>(heights_m_[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) +
                                          static_cast<std::size_t>(c % columns_)]);
  };
  const double up = y - row;
  const double right = x - column;
  const double height = (1 - up) * ((1 - right) * at(row, column) + right * at(row, column + 1)) +
                        up * ((1 - right) * at(row + 1, column) + right * at(row + 1, column + 1));
  constexpr double kMaxUndulation_m = 200;  // undulations are within 107 m; larger values mean "no data"
  return std::abs(height) <= kMaxUndulation_m ? std::optional(height) : std::nullopt;
}

std::optional<std::filesystem::path> FindEgm96Grid() {
  for (const char* folder : {static_cast<const char*>(std::getenv("PROJ_DATA")),
                             static_cast<const char*>(std::getenv("PROJ_LIB")), "/usr/share/proj"}) {
    if (folder == nullptr) continue;
    std::filesystem::path path = std::filesystem::path(folder) / "egm96_15.gtx";
    std::error_code error;
    if (std::filesystem::is_regular_file(path, error)) return path;
  }
  return std::nullopt;
}

}  // namespace victorious
