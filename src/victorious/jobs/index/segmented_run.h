// One video on its way into an index with help of other processes: one prepares it (telemetry, clock, the sun's
// direction) and cuts it into segments (video_cut.h), any search these, one joins their results.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "victorious/base/error.h"
#include "victorious/jobs/index/index_job.h"
#include "victorious/jobs/index/index_run.h"
#include "victorious/jobs/index/video_cut.h"
#include "victorious/store/segment_store.h"

namespace victorious {

class SegmentedRun {
 public:
  /// The references outlive it. The run has not begun.
  SegmentedRun(IndexRun& run, SegmentStore& segments) : run_(run), segments_(segments) {}

  /// Goes as far as it can: prepares and cuts the video, or joins what was searched. @param segment_s  of a segment, s
  /// Errors: as IndexRun::Search.
  [[nodiscard]] Expected<SegmentedReport> Search(double segment_s);

  /// Searches one open segment, and stores its results at its end. Does nothing if the segment is finished, or if the
  /// video has since been cut with other models or parameters.
  /// Errors: as IndexRun::Search.
  [[nodiscard]] Expected<IndexReport> SearchSegment(FrameInterval frames);

 private:
  // A pass that is cut into segments.
  struct PlannedCut {
    VideoRecord video;
    VideoCut cut;
    PlannedPass pass;
    SearchIntervals intervals;
    PreparedVideo prepared;
  };

  // The text that identifies a pass: VideoCut::plan.
  [[nodiscard]] Expected<std::string> CutPlan(const PlannedPass& pass, const SearchIntervals& intervals) const;
  // The searches of a plan that this run, or one like it, made; std::nullopt for another plan.
  [[nodiscard]] Expected<std::optional<PlannedCut>> ReadCutPlan(const VideoRecord& video, const VideoCut& cut) const;
  // The cut of the job's video by this run, or one like it.
  // @param frames  of a segment: reads only what that needs; std::nullopt: all that was prepared
  [[nodiscard]] Expected<std::optional<PlannedCut>> FindCut(std::optional<FrameInterval> frames) const;
  // Between two frames that are searched as a whole for any target.
  [[nodiscard]] int MinInterval(const PlannedPass& pass, const SearchIntervals& intervals) const;
  [[nodiscard]] Expected<bool> IsFinished(const VideoRecord& video) const;
  // The video of a cut as it was prepared, whose cameras it takes; the report has its sun.
  [[nodiscard]] OpenedVideo VideoOf(PlannedCut& found);
  // Returns the id of the cut; std::nullopt if the pass is not to be cut.
  [[nodiscard]] Expected<std::optional<std::int64_t>> CutPass(const PlannedPass& plan, const std::string& text,
                                                              double segment_s);
  // Joins the segments up to the first open one; after the last one, the cut is finished.
  // Returns false if the video has another content than the cut: nothing is joined.
  [[nodiscard]] Expected<bool> JoinSegments(PlannedCut& found);

  IndexRun& run_;
  SegmentStore& segments_;
};

}  // namespace victorious
