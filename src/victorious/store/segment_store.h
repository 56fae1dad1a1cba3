// The segments of videos that several workers search at once. A video is prepared once and cut into segments of frames;
// each is searched by itself, in any order; then their results are joined in the order of frames
// (jobs/index/segmented_run.h). Searches for other models cut the same video by themselves.
//
//   Put ---> open --Complete--> done ---> VisitResults, Discard ---> Finish
//             |                                                        ^
//             '--GiveUp--> two halves, or quarantined, a gap ----------'
//
// What a worker prepares and finds is stored here as bytes of its build (base/packed_bytes.h), and deleted by Finish.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"

namespace victorious {

/// The frames [from, to) of a video.
struct FrameInterval {
  std::int64_t from = 0;
  std::int64_t to = 0;

  [[nodiscard]] std::int64_t size() const { return to - from; }
  [[nodiscard]] bool Contains(std::int64_t frame) const { return frame >= from && frame < to; }
  auto operator<=>(const FrameInterval&) const = default;
};

enum class SegmentState {
  kOpen,         ///< to be searched
  kDone,         ///< its results are stored
  kQuarantined,  ///< kills who searches it: left out
};

struct Segment {
  FrameInterval frames;
  SegmentState state = SegmentState::kOpen;
  std::string reason;  ///< of the quarantine; else empty

  bool operator==(const Segment&) const = default;
};

/// A video that is cut for the search for some models.
struct VideoCut {
  std::int64_t id = 0;  ///< assigned by the store, never given again
  std::int64_t video = 0;
  std::string plan;       ///< what is searched for and how, and by which build: one text for each
  std::int64_t step = 1;  ///< frames between the places where a segment may be cut
  bool is_whole = false;  ///< its frames are not those that its container lists: one process must search it
  std::vector<Segment> segments = {};  ///< by frame, without a gap

  bool operator==(const VideoCut&) const = default;
};

/// No segment is cut shorter, frames.
inline constexpr std::int64_t kMinSegmentFrames = 60;

/// Frames of a video that were left out of the search for a model.
struct CoverageGap {
  std::int64_t video = 0;
  FrameInterval frames;
  double from_s = 0;  ///< time of the first frame
  double to_s = 0;    ///< of the last one
  std::string reason;

  bool operator==(const CoverageGap&) const = default;
};

/// A segment that is left out of a search that has not ended yet: it will be a gap.
struct QuarantinedSegment {
  std::int64_t video = 0;
  FrameInterval frames;
  std::string reason;

  bool operator==(const QuarantinedSegment&) const = default;
};

/// Not thread-safe: use from one thread at a time. Other processes may write at the same time.
class SegmentStore {
 public:
  virtual ~SegmentStore() = default;

  /// Stores a cut, in place of those of other plans that search the video for one of these models: their tasks are out
  /// of date. Without effect if there is one of the same plan. Returns the id.
  /// @param models       that are searched for
  /// @param prepared     what is known of the video, for joining
  /// @param of_segments  what each segment needs of it; one for each of `cut`, or none
  [[nodiscard]] virtual Expected<std::int64_t> Put(const VideoCut& cut, std::span<const std::int64_t> models,
                                                   std::span<const std::byte> prepared,
                                                   std::span<const std::vector<std::byte>> of_segments = {}) = 0;

  /// std::nullopt: it is finished, or was replaced.
  [[nodiscard]] virtual Expected<std::optional<VideoCut>> Find(std::int64_t cut) = 0;

  /// The cuts of a video, by id.
  [[nodiscard]] virtual Expected<std::vector<VideoCut>> CutsOf(std::int64_t video) = 0;

  /// What was prepared for joining. Error: kNotFound without the cut.
  [[nodiscard]] virtual Expected<std::vector<std::byte>> Prepared(std::int64_t cut) = 0;
  /// What was prepared for an open segment, or for the one whose part it is. Error: kNotFound without the cut or such a
  /// segment.
  [[nodiscard]] virtual Expected<std::vector<std::byte>> PreparedOf(std::int64_t cut, FrameInterval frames) = 0;

  /// Stores the results of a segment: it is done. Without effect if it is done already, or left out. Error: kNotFound
  /// without the cut or the segment.
  [[nodiscard]] virtual Status Complete(std::int64_t cut, FrameInterval frames, std::span<const std::byte> results) = 0;

  /// Visits the results of the segments that are done, by frame, but for those that were discarded. Error: kNotFound
  /// without the cut, at the end, too.
  [[nodiscard]] virtual Status VisitResults(
      std::int64_t cut, const std::function<Status(FrameInterval, std::span<const std::byte>)>& visit) = 0;

  /// Deletes the results of the segments that are done and end at `frame` or before it: they are joined.
  [[nodiscard]] virtual Status Discard(std::int64_t cut, std::int64_t frame) = 0;

  /// Says that one process must search the video as a whole. In the index of the same database, what was joined of it
  /// is deleted in the same transaction: it begins anew.
  [[nodiscard]] virtual Status SetWhole(std::int64_t cut) = 0;

  /// Gives up an open segment that kills who searches it: cuts it in halves, at a multiple of the cut's step; one of
  /// less than two steps, or of kMinSegmentFrames or less, is quarantined. Without effect on any other segment.
  [[nodiscard]] virtual Status GiveUp(std::int64_t cut, FrameInterval frames, const std::string& reason) = 0;

  /// Deletes the cut, and stores the gaps of the searches for its models, in place of their former ones, in one
  /// transaction. A gap is deleted with its search. Without effect if the cut is not there any more.
  [[nodiscard]] virtual Status Finish(std::int64_t cut, std::span<const CoverageGap> gaps) = 0;

  /// The stored gaps of all videos, by video and frame; a gap of several models once.
  [[nodiscard]] virtual Expected<std::vector<CoverageGap>> Gaps() = 0;

  /// The quarantined segments of all cuts, by video and frame; one of several cuts once.
  [[nodiscard]] virtual Expected<std::vector<QuarantinedSegment>> Quarantined() = 0;
};

/// Where GiveUp cuts a segment; std::nullopt: not at all.
[[nodiscard]] std::optional<std::int64_t> MiddleOf(FrameInterval frames, std::int64_t step);

}  // namespace victorious
