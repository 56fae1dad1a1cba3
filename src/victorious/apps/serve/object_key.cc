#include "victorious/apps/serve/object_key.h"

#include <array>
#include <charconv>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "victorious/base/file.h"

namespace victorious {
namespace {

constexpr double kMinOverlap = 0.5;  // as for reviews

std::uint64_t ContentChecksum(const std::string& text) { return Checksum(std::as_bytes(std::span(text))); }

std::int64_t KeyTime_us(double time_s) { return std::llround(1e6 * time_s); }

}  // namespace

bool KeyedSighting::IsAt(const SightingRecord& sighting) const {
  return KeyTime_us(sighting.time_s) == time_us && IntersectionOverUnion(sighting.box, box) >= kMinOverlap;
}

bool KeyedSighting::IsIn(const VideoRecord& video) const { return ContentChecksum(video.content_id) == content; }

std::string FormatObjectKey(const VideoRecord& video, const SightingRecord& first, std::string_view model) {
  return fmt::format("{:016x}.{}.{:.0f}.{:.0f}.{:.0f}.{:.0f}.{}", ContentChecksum(video.content_id),
                     KeyTime_us(first.time_s), first.box.x, first.box.y, first.box.width, first.box.height, model);
}

std::optional<KeyedSighting> ParseObjectKey(std::string_view key) {
  KeyedSighting sighting;
  const auto next = [&](auto& value, int base) {
    const std::string_view part = key.substr(0, key.find('.'));
    if (part.size() == key.size()) return false;
    key.remove_prefix(part.size() + 1);
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value, base);
    return error == std::errc() && end == part.data() + part.size();
  };
  std::array<std::int32_t, 4> box{};
  if (!next(sighting.content, 16) || !next(sighting.time_us, 10)) return std::nullopt;
  for (std::int32_t& one : box) {
    if (!next(one, 10)) return std::nullopt;
  }
  if (sighting.time_us < 0 || key.empty()) return std::nullopt;
  sighting.box = {static_cast<double>(box[0]), static_cast<double>(box[1]), static_cast<double>(box[2]),
                  static_cast<double>(box[3])};
  sighting.model = key;
  return sighting;
}

}  // namespace victorious
