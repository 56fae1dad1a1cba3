// Where a video is cut into segments that are searched apart from each other, and what each of them needs to know of
// the video.
//
// All tracks restart at multiples of `follow.restart_interval_frames` (follower.h), so that what is found in a frame
// depends on no frame before the last such multiple. A cut lies there, and near a key frame: the decoder of the segment
// starts at that. A stream with no key frame for long is not cut.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/sun.h"
#include "victorious/input/video/frame_times.h"
#include "victorious/place/cameras/camera_states.h"
#include "victorious/store/segment_store.h"

namespace victorious {

/// How much video a segment decodes before its first frame at most, s. Encoders set key frames every 10 s or oftener.
inline constexpr double kMaxLeadIn_s = 12;
/// A seek goes to a key frame at least this long before, s: so far frames are reordered (VideoReader::SeekTo).
inline constexpr double kMinLeadIn_s = 1;

/// The frames from which a pass starts, and how it may be cut.
struct CutOptions {
  std::int64_t first_frame = 0;  ///< frames before it need no search
  std::int64_t step = 60;        ///< frames between the places where all tracks restart
  double segment_s = 60;         ///< of a segment, at least but for the last one
};

/// Returns the segments in order: the first contains `first_frame`, the last ends with the video; each begins at a
/// multiple of the step. One segment, or none, if the video is not to be cut.
[[nodiscard]] std::vector<FrameInterval> CutVideo(const FrameTable& table, const CutOptions& options);

/// What is computed once for all segments of a video.
struct PreparedVideo {
  std::vector<double> times_s;  ///< of all frames
  CameraStates cameras;         ///< with the corrected clock
  std::optional<Sun> sun;
  bool is_sun_by_clock = false;
  std::int64_t file_bytes = 0;  ///< 0: not a file
};

/// As bytes (base/packed_bytes.h). Numbers keep every bit.
[[nodiscard]] std::vector<std::byte> PackPreparedVideo(const PreparedVideo& prepared);

/// Safe for any bytes. Error: kDataLoss for bytes that PackPreparedVideo did not make.
[[nodiscard]] Expected<PreparedVideo> UnpackPreparedVideo(std::span<const std::byte> bytes);

}  // namespace victorious
