#include "victorious/jobs/index/video_cut.h"

#include <algorithm>

#include "victorious/base/packed_bytes.h"
#include "victorious/types/frame.h"

namespace victorious {
namespace {

// True if the decoder need not start long before a time.
bool IsNearKeyFrame(const std::vector<double>& key_times_s, double time_s) {
  const auto after = std::ranges::upper_bound(key_times_s, time_s - kMinLeadIn_s);
  return after != key_times_s.begin() && time_s - *std::prev(after) <= kMaxLeadIn_s;
}

}  // namespace

std::vector<FrameInterval> CutVideo(const FrameTable& table, const CutOptions& options) {
  const auto frames = std::ssize(table.times_s);
  const auto time_s = [&](std::int64_t frame) { return table.times_s[static_cast<std::size_t>(frame)]; };
  std::vector<FrameInterval> segments;
  std::int64_t from = options.first_frame - options.first_frame % options.step;
  if (from >= frames) return segments;
  for (std::int64_t cut = from + options.step; cut < frames; cut += options.step) {
    if (time_s(cut) - time_s(from) < options.segment_s - kSameTime_s) continue;
    if (time_s(frames - 1) - time_s(cut) < options.segment_s / 2) break;  // no short rest
    if (!IsNearKeyFrame(table.key_times_s, time_s(cut))) continue;
    segments.push_back({from, cut});
    from = cut;
  }
  segments.push_back({from, frames});
  return segments;
}

std::vector<std::byte> PackPreparedVideo(const PreparedVideo& prepared) {
  ByteWriter writer;
  writer.PutItems(std::span(prepared.times_s));
  prepared.cameras.Pack(writer);
  if (writer.PutHas(prepared.sun)) {
    writer.Put(prepared.sun->azimuth_rad);
    writer.Put(prepared.sun->elevation_rad);
  }
  writer.Put(prepared.is_sun_by_clock);
  writer.Put(prepared.file_bytes);
  return writer.Take();
}

Expected<PreparedVideo> UnpackPreparedVideo(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  PreparedVideo prepared;
  prepared.times_s = reader.GetItems<double>();
  prepared.cameras = CameraStates::Unpack(reader);
  if (reader.Get<bool>()) {
    Sun& sun = prepared.sun.emplace();
    sun.azimuth_rad = reader.Get<double>();
    sun.elevation_rad = reader.Get<double>();
  }
  prepared.is_sun_by_clock = reader.Get<bool>();
  prepared.file_bytes = reader.Get<std::int64_t>();
  if (!reader.IsAtEnd()) {
    return Fail(ErrorCode::kDataLoss, "what was prepared for the video is damaged: submit the video again");
  }
  return prepared;
}

}  // namespace victorious
