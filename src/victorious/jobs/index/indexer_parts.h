// Private to jobs/: what the sources of Indexer share.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/indexer.h"
#include "victorious/jobs/index/video_cut.h"
#include "victorious/place/cameras/camera_states.h"
#include "victorious/store/segment_store.h"

namespace victorious {

// A video that was opened for indexing.
struct Indexer::OpenedVideo {
  std::unique_ptr<VideoReader> reader;  // null after a pass that read it
  CameraStates cameras;
  VideoRecord record;
  SearchIntervals intervals;
  bool is_redone = false;  // Indexer::IsRedone
};

// The searches of one pass over the video.
struct Indexer::PlannedPass {
  std::vector<std::size_t> targets;    // indices into targets_, ascending: models, then categories
  std::vector<SearchRecord> searches;  // one per target, all with the same next_frame
};

// A pass that is cut into segments.
struct Indexer::PlannedCut {
  VideoRecord video;
  VideoCut cut;
  PlannedPass pass;
  SearchIntervals intervals;
  PreparedVideo prepared;
};

// The search options as the store keeps them, as JSON.
// @param every    the interval that was chosen
// @param tracked  that of SearchIntervals
// @param job      its interval of time belongs to what was searched
std::string SearchOptionsText(IndexOptions options, int every, int tracked, const IndexJob& job);

// True if the camera's attitude is known at some time. @param trajectory  null: there is no telemetry
[[nodiscard]] bool HasAttitudes(const CameraTrajectory* trajectory);

// The reader's content id; shows a progress bar for large files.
[[nodiscard]] Expected<std::string> ContentIdOf(const VideoReader& reader, const std::string& video,
                                                const CancelToken& cancel);

}  // namespace victorious
