#include "victorious/show/export/vmti_packet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/st0601.h"

namespace victorious {
namespace {

using KlvBytes = std::vector<std::byte>;

constexpr auto kSt0601Label = std::to_array<std::uint8_t>(
    {0x06, 0x0E, 0x2B, 0x34, 0x02, 0x0B, 0x01, 0x01, 0x0E, 0x01, 0x03, 0x01, 0x01, 0, 0, 0});
constexpr std::uint64_t kSt0601Version = 19;
constexpr std::uint64_t kSt0903Version = 5;

void Append(KlvBytes& to, std::span<const std::byte> bytes) { to.insert(to.end(), bytes.begin(), bytes.end()); }

// Big-endian, of so many bytes.
KlvBytes Unsigned(std::uint64_t number, int bytes) {
  KlvBytes out(static_cast<std::size_t>(bytes));
  for (auto byte = out.rbegin(); byte != out.rend(); ++byte, number >>= 8U) *byte = static_cast<std::byte>(number);
  return out;
}

// Of as few bytes as hold it, one at least.
KlvBytes ShortUnsigned(std::uint64_t number) {
  int bytes = 1;
  while (bytes < 8 && number >> (8U * static_cast<unsigned>(bytes)) != 0) ++bytes;
  return Unsigned(number, bytes);
}

KlvBytes Text(std::string_view text) {
  const auto bytes = AsBytes(text);
  return {bytes.begin(), bytes.end()};
}

void AppendLength(KlvBytes& to, std::size_t length) {
  constexpr std::size_t kLongForm = 0x80;
  if (length < kLongForm) return to.push_back(static_cast<std::byte>(length));
  const KlvBytes digits = ShortUnsigned(length);
  to.push_back(static_cast<std::byte>(kLongForm + digits.size()));
  Append(to, digits);
}

// Seven bits a byte, highest first; all bytes but the last have their top bit set.
void AppendOid(KlvBytes& to, std::uint64_t number) {
  int groups = 1;
  while (number >> (7U * static_cast<unsigned>(groups)) != 0) ++groups;
  for (int group = groups - 1; group >= 0; --group) {
    const std::uint64_t seven = (number >> (7U * static_cast<unsigned>(group))) & 0x7FU;
    to.push_back(static_cast<std::byte>(seven | (group > 0 ? 0x80U : 0U)));
  }
}

void AppendItem(KlvBytes& to, std::uint64_t number, const KlvBytes& value) {
  AppendOid(to, number);
  AppendLength(to, value.size());
  Append(to, value);
}

// A member of a series: its length and its bytes.
void AppendMember(KlvBytes& to, const KlvBytes& value) {
  AppendLength(to, value.size());
  Append(to, value);
}

// ST 0903 counts the pixels of a frame row by row, from 1.
std::uint64_t PixelNumber(int column, int row, const VmtiFrame& frame) {
  return static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(frame.width) +
         static_cast<std::uint64_t>(column) + 1;
}

// Its pixels within the frame, the last ones included; std::nullopt if there is none.
struct PixelBox {
  int left;
  int top;
  int right;
  int bottom;
};

std::optional<PixelBox> PixelsOf(const Box& box, const VmtiFrame& frame) {
  const Box within = Intersection(box, FrameBox(frame.width, frame.height));
  if (!(within.width > 0 && within.height > 0)) return std::nullopt;
  const auto last = [](double begin, double size) { return static_cast<int>(std::ceil(begin + size)) - 1; };
  return PixelBox{static_cast<int>(within.x), static_cast<int>(within.y), last(within.x, within.width),
                  last(within.y, within.height)};
}

constexpr double kMinHeight_m = -900;
constexpr double kMaxHeight_m = 19000;
constexpr double kMaxSigma_m = 650;

// A truncation pack: what follows the height are standard deviations and correlations, east, north, up.
KlvBytes EncodePlace(const Geolocation& place) {
  KlvBytes out = EncodeImapb(DegreesFromRadians(place.point.latitude_rad), -90, 90, 4);
  Append(out, EncodeImapb(DegreesFromRadians(place.point.longitude_rad), -180, 180, 4));
  Append(out, EncodeImapb(place.point.altitude_m, kMinHeight_m, kMaxHeight_m, 2));
  const Eigen::Matrix3d& covariance = place.covariance_enu_m2;
  const Eigen::Vector3d sigmas = covariance.diagonal().cwiseSqrt();
  if (!covariance.allFinite() || !(sigmas.maxCoeff() <= kMaxSigma_m) || !(sigmas.minCoeff() > 0)) return out;
  for (const double sigma : sigmas) Append(out, EncodeImapb(sigma, 0, kMaxSigma_m, 2));
  constexpr auto kPairs = std::to_array<std::pair<int, int>>({{0, 1}, {0, 2}, {1, 2}});
  for (const auto& [i, j] : kPairs) Append(out, EncodeImapb(covariance(i, j) / (sigmas[i] * sigmas[j]), -1, 1, 2));
  return out;
}

bool HasPlace(const VmtiTarget& target) {
  if (!target.place) return false;
  const GeodeticPoint& point = target.place->point;
  return std::isfinite(point.latitude_rad) && std::isfinite(point.longitude_rad) && point.altitude_m >= kMinHeight_m &&
         point.altitude_m <= kMaxHeight_m;
}

std::uint64_t PercentOf(double probability) {
  return probability > 0 ? static_cast<std::uint64_t>(std::lround(100 * std::min(probability, 1.0))) : 0;
}

KlvBytes EncodeTarget(const VmtiTarget& target, const PixelBox& box, const VmtiFrame& frame) {
  KlvBytes out;
  AppendOid(out, static_cast<std::uint64_t>(target.id));
  AppendItem(out, 1, ShortUnsigned(PixelNumber((box.left + box.right) / 2, (box.top + box.bottom) / 2, frame)));
  AppendItem(out, 2, ShortUnsigned(PixelNumber(box.left, box.top, frame)));
  AppendItem(out, 3, ShortUnsigned(PixelNumber(box.right, box.bottom, frame)));
  AppendItem(out, 5, Unsigned(PercentOf(target.confidence), 1));
  if (HasPlace(target)) AppendItem(out, 17, EncodePlace(*target.place));
  KlvBytes object;
  AppendItem(object, 1, Text(kVmtiOntology));
  AppendItem(object, 2, Text(target.label));
  AppendItem(out, 102, object);
  return out;
}

KlvBytes EncodeVmtiSet(const VmtiFrame& frame) {
  KlvBytes targets;
  std::uint64_t count = 0;
  for (const VmtiTarget& target : frame.targets) {
    const std::optional<PixelBox> box = PixelsOf(target.box, frame);
    if (!box) continue;
    AppendMember(targets, EncodeTarget(target, *box, frame));
    ++count;
  }
  KlvBytes out;
  AppendItem(out, 3, Text(kVmtiSystem));
  AppendItem(out, 4, ShortUnsigned(kSt0903Version));
  AppendItem(out, 5, ShortUnsigned(count));
  AppendItem(out, 6, ShortUnsigned(count));
  AppendItem(out, 7, ShortUnsigned(static_cast<std::uint64_t>(frame.frame)));
  AppendItem(out, 8, ShortUnsigned(static_cast<std::uint64_t>(frame.width)));
  AppendItem(out, 9, ShortUnsigned(static_cast<std::uint64_t>(frame.height)));
  if (count > 0) AppendItem(out, 101, targets);
  return out;
}

}  // namespace

std::vector<std::byte> EncodeImapb(double value, double min, double max, int bytes) {
  constexpr std::uint64_t kQuietNan = 0xD0;  // of its first byte; the others are zero
  if (std::isnan(value)) return Unsigned(kQuietNan << (8U * static_cast<unsigned>(bytes - 1)), bytes);
  const double inside = std::clamp(value, min, max);
  const int range_power = static_cast<int>(std::ceil(std::log2(max - min)));
  const double scale = std::ldexp(1.0, 8 * bytes - 1 - range_power);
  const double shifted = scale * min;  // makes zero map to itself exactly
  const double offset = min < 0 && max > 0 ? shifted - std::floor(shifted) : 0;
  return Unsigned(static_cast<std::uint64_t>(std::floor(scale * (inside - min) + offset)), bytes);
}

std::vector<std::byte> EncodeVmti(const VmtiFrame& frame) {
  constexpr std::size_t kChecksumItem = 4;  // number, length and two bytes
  KlvBytes items;
  AppendItem(items, 2, Unsigned(static_cast<std::uint64_t>(frame.utc_us), 8));
  AppendItem(items, 65, ShortUnsigned(kSt0601Version));
  AppendItem(items, 74, EncodeVmtiSet(frame));
  KlvBytes out;
  Append(out, std::as_bytes(std::span(kSt0601Label)));
  AppendLength(out, items.size() + kChecksumItem);
  Append(out, items);
  AppendOid(out, 1);
  AppendLength(out, 2);
  Append(out, Unsigned(St0601Checksum(out), 2));
  return out;
}

}  // namespace victorious
