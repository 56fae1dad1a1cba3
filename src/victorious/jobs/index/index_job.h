// Input and output of indexing one video (indexer.h).
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/file_roots.h"
#include "victorious/base/warning_sink.h"
#include "victorious/geometry/sun.h"
#include "victorious/kernels/nearest_device.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/object/model/relit_template_folder.h"

namespace victorious {

/// What becomes of results that the index has already, of the same models in the same video.
enum class Redo {
  kNever,        ///< they stay, and are completed; if they were made with other parameters, that is an error
  kIfDifferent,  ///< if they were made with other parameters, or have failed parts (SearchPartKind::kFailed), they are
                 ///< deleted, and the video is searched again
  kAlways,       ///< they are deleted, and the video is searched again
};

/// One video to index, and how.
struct IndexJob {
  std::string video;            ///< path or URL
  std::string name = {};        ///< under which it is stored; empty: `video`
  std::string content_id = {};  ///< that it must have (VideoReader::ContentId); empty: any
  /// The live source of which the file is a recording, named by its time (RecordingStart): what is searched of it is
  /// entered as covered (CoveredTime). Each `from_s` makes a video of its own. Empty: of none.
  std::string covers = {};
  std::optional<std::string> telemetry;  ///< telemetry file; if not given, the video's own, or a file beside it
  FileRoots roots = {};                  ///< that the telemetry file must lie below which the index names for the video
  Redo redo = Redo::kNever;
  int threads = 0;                    ///< 0: one per hardware thread
  std::optional<double> from_s = {};  ///< only frames at this time or later are searched
  std::optional<double> to_s = {};    ///< only frames up to this time
  /// Time that the search may take a frame of the video, on average: searches are left out to hold it. What is found
  /// then depends on the machine. std::nullopt: any.
  std::optional<std::chrono::duration<double, std::milli>> frame_budget = {};
  /// Receives what is no warning: the expected size of the kept features, the errors of telemetry that places rest on.
  WarningSink inform = {};
  /// Relit templates (MakeRelitViews), one entry per model. The caller keeps them, to share them between jobs with the
  /// same models. If empty, they are made for this video and released after it.
  std::vector<std::shared_ptr<const RelitTemplateSource>> relit_templates = {};
  const RelitTemplateFolder* relit_folder = nullptr;    ///< of those that are made for this video; null: none
  std::shared_ptr<kernels::NearestDevice> device = {};  ///< computes distances of descriptors; null: the processor

  [[nodiscard]] const std::string& StoredName() const { return name.empty() ? video : name; }
};

/// What one call of Indexer::Index did.
struct IndexReport {
  bool has_telemetry = true;         ///< or may have it, as a live source: else nothing gets a place
  std::int64_t frames_searched = 0;  ///< number of frames searched as a whole by this call
  std::int64_t frames_left_out = 0;  ///< number that were due for it, but tracked only: to keep a budget, or live
  std::int64_t sightings = 0;        ///< number found by this call
  bool stopped_live = false;         ///< true if a cancelled live source ends here
  std::optional<Sun> sun;            ///< sun direction, azimuth from north, if relit templates were used
  bool sun_by_clock = false;         ///< by the ephemeris for the telemetry's clock; else estimated from the image
  bool sun_from_camera = false;      ///< the azimuth is from the camera's first direction: its attitude is unknown
};

/// What one call of Indexer::IndexBySegments did.
struct SegmentedReport {
  IndexReport index;
  /// The cut whose segments are open: IndexSegment searches them, then IndexBySegments is called again. std::nullopt:
  /// the video is indexed.
  std::optional<std::int64_t> waits_for;
};

}  // namespace victorious
