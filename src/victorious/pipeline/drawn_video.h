// A copy of a video with the sightings drawn into it, to judge results by eye: outlines, names, scores and places. Input:
// the video, and sightings of an index or of user boxes. Every frame keeps its presentation time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/geometry/polygon.h"
#include "victorious/pipeline/box_sighting.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// One object in one frame, as it is drawn.
struct DrawnSighting {
  std::int64_t frame = 0;
  Polygon outline;                 ///< px
  std::vector<std::string> lines;  ///< written beside the outline
  std::uint64_t identity = 0;      ///< sightings of one identity have one colour
};

/// Writes a copy of a video with the sightings drawn into it, and the frame number and time in a corner. Frames of odd
/// width or height get a further column or row.
/// @param video       a file or a folder of frames
/// @param sightings   in any order
/// @param frame_rate  of a folder of frames, frames/s
/// @param path        .mp4 or .mkv; created or replaced only when it is complete
/// Errors: those of VideoReader and VideoWriter; kInvalidArgument for a live source; kCancelled. Cost: that of decoding
/// and encoding the video.
[[nodiscard]] Status DrawVideo(const std::string& video, std::span<const DrawnSighting> sightings, double frame_rate,
                               const std::filesystem::path& path, const CancelToken& cancel);

/// The sightings of an index that match the filter, all of one video.
struct IndexedDrawing {
  std::string video;  ///< path
  std::vector<DrawnSighting> sightings;
};

/// Errors: kNotFound for a name that is not in the index; kInvalidArgument if videos that match are more or fewer than
/// one.
[[nodiscard]] Expected<IndexedDrawing> ListIndexedDrawing(const SightingFilter& filter, IndexStore& store);

/// The sightings of user boxes in the first video.
[[nodiscard]] std::vector<DrawnSighting> ListBoxDrawing(std::span<const BoxSighting> sightings,
                                                        std::span<const UserBox> boxes);

}  // namespace victorious
