// A copy of a video, or a clip of it, with the sightings drawn into it, to judge results by eye: outlines, names,
// scores, places and tracks. Input: the video, and sightings of an index or of user boxes. Every frame of a copy keeps
// its presentation time; a clip begins at 0.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/geometry/polygon.h"
#include "victorious/jobs/track/box_sighting.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// One object in one frame, as it is drawn.
struct DrawnSighting {
  std::int64_t frame = 0;
  double time_s = 0;
  Polygon outline;                 ///< px
  std::vector<std::string> lines;  ///< written beside the outline
  std::uint64_t identity = 0;      ///< sightings of one identity have one colour
};

/// A part of a video by presentation times, both inclusive.
struct VideoSpan {
  double from_s = 0;
  double to_s = 0;
};

struct DrawOptions {
  double folder_frame_rate = 10;  ///< of a folder of frames, frames/s
  std::optional<VideoSpan> clip;  ///< only this part; std::nullopt: all
  int track_frames = 0;           ///< the way of an object's middle through so many frames before is drawn, too
};

/// Writes a copy of a video with the sightings drawn into it, and in a corner the frame number and time, in a clip the
/// time of the video. Frames of odd width or height get a further column or row. Returns the times in the video of the
/// first and the last frame that were written.
/// @param video      a file or a folder of frames
/// @param sightings  in any order
/// @param path       .mp4 or .mkv; created or replaced only when it is complete
/// Errors: those of VideoReader and VideoWriter; kInvalidArgument for a live source, or a clip without a frame;
/// kCancelled. Cost: that of decoding and encoding the part.
[[nodiscard]] Expected<VideoSpan> DrawVideo(const std::string& video, std::span<const DrawnSighting> sightings,
                                            const DrawOptions& options, const std::filesystem::path& path,
                                            const CancelToken& cancel);

/// The file of a clip's telemetry, beside the clip: it is found with it (FindTelemetryFile).
[[nodiscard]] std::filesystem::path ClipTelemetryPath(const std::filesystem::path& clip);

/// Writes the telemetry of a clip: the camera's states in its span and the ones next to it, with times from the clip's
/// first frame. Returns the number of states; writes nothing if there is none.
/// @param file  telemetry of the video; std::nullopt: found by itself
/// @param warn  receives warnings about telemetry that cannot be read
/// Errors: those of ReadTelemetry for a given file, and of writing.
[[nodiscard]] Expected<std::size_t> WriteClipTelemetry(const std::string& video, const std::optional<std::string>& file,
                                                       const VideoSpan& span, const std::filesystem::path& clip,
                                                       const std::function<void(const std::string&)>& warn);

/// The sightings of an index that match the filter, all of one video.
struct IndexedDrawing {
  std::string video;      ///< path
  std::string telemetry;  ///< the file that was given when it was indexed; empty: none
  std::vector<DrawnSighting> sightings;
};

/// Errors: kNotFound for a name that is not in the index; kInvalidArgument if videos that match are more or fewer than
/// one.
[[nodiscard]] Expected<IndexedDrawing> ListIndexedDrawing(const SightingFilter& filter, IndexStore& store);

/// The sightings of user boxes in the first video.
[[nodiscard]] std::vector<DrawnSighting> ListBoxDrawing(std::span<const BoxSighting> sightings,
                                                        std::span<const UserBox> boxes);

}  // namespace victorious
