#include "victorious/jobs/index/segmented_run.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <ranges>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/base/program_id.h"
#include "victorious/base/version.h"
#include "victorious/input/video/frame_times.h"
#include "victorious/jobs/index/index_pass.h"
#include "victorious/jobs/index/segment_reader.h"
#include "victorious/jobs/index/stored_parameters.h"

namespace victorious {
namespace {

// Frames whose features a segment keeps at most, 0.6 MB each: it stores them together, at its end.
constexpr double kMaxKeptFrames = 256;

// Of a file; 0 of anything else.
std::int64_t FileBytes(const std::string& video) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(video, error)) return 0;
  const auto bytes = std::filesystem::file_size(video, error);
  return error ? 0 : static_cast<std::int64_t>(bytes);
}

// The last frame before `frame` that is searched as a whole; `frame` if there is none. The selection of kept frames
// and, without tracking, the camera motion refer to it.
std::int64_t WholeFrameBefore(std::int64_t frame, int every, const FollowOptions& follow) {
  const auto last_multiple = [&](std::int64_t step) { return (frame - 1) / step * step; };
  if (frame == 0) return 0;
  std::int64_t before = last_multiple(every);
  if (follow.enabled) before = std::max(before, last_multiple(follow.restart_interval_frames));
  return before;
}

double SegmentSeconds(double wanted_s, int every, const IndexOptions& options, double frame_rate) {
  if (options.keep.interval_s < 0) return wanted_s;
  const double whole_frames_s = frame_rate > 0 ? every / frame_rate : 0;
  const double kept_s = kMaxKeptFrames * std::max(options.keep.interval_s, whole_frames_s);
  return kept_s > 0 ? std::min(wanted_s, kept_s) : wanted_s;
}

// Error: kDataLoss for segments of frames that the video does not have.
Status CheckFrames(const VideoCut& cut, const PreparedVideo& prepared) {
  const std::int64_t frames = std::ssize(prepared.times_s);
  const bool are_there = frames > 0 && std::ranges::all_of(cut.segments, [&](const Segment& segment) {
                           return segment.frames.from >= 0 && segment.frames.size() > 0 && segment.frames.to <= frames;
                         });
  if (are_there) return {};
  return Fail(ErrorCode::kDataLoss, "the stored segments of a video are damaged: submit the video again");
}

std::vector<CoverageGap> GapsOf(const VideoCut& cut, const std::vector<double>& times_s) {
  std::vector<CoverageGap> gaps;
  for (const Segment& segment : cut.segments) {
    if (segment.state != SegmentState::kQuarantined) continue;
    gaps.push_back({.video = cut.video,
                    .frames = segment.frames,
                    .from_s = times_s.at(static_cast<std::size_t>(segment.frames.from)),
                    .to_s = times_s.at(static_cast<std::size_t>(segment.frames.to - 1)),
                    .reason = segment.reason});
  }
  return gaps;
}

// The intervals that CutPlan wrote; std::nullopt if there are none.
std::optional<SearchIntervals> IntervalsOf(const nlohmann::json& plan) {
  const auto found = plan.find("intervals");
  if (found == plan.end() || !found->is_array() || found->size() != 3) return std::nullopt;
  for (const nlohmann::json& one : *found) {
    if (!one.is_number_integer() || one.get<std::int64_t>() < 1 || one.get<std::int64_t>() > 1'000'000) {
      return std::nullopt;
    }
  }
  return SearchIntervals{
      .models = (*found)[0].get<int>(), .categories = (*found)[1].get<int>(), .tracked = (*found)[2].get<int>()};
}

// The first frame of the first open segment; std::nullopt: none is open.
std::optional<std::int64_t> FirstOpenFrame(const VideoCut& cut) {
  const auto open = std::ranges::find(cut.segments, SegmentState::kOpen, &Segment::state);
  return open == cut.segments.end() ? std::nullopt : std::optional(open->frames.from);
}

std::vector<std::int64_t> ModelsOf(const std::vector<SearchRecord>& searches) {
  std::vector<std::int64_t> models;
  for (const SearchRecord& search : searches) models.push_back(search.model);
  return models;
}

}  // namespace

Expected<SegmentedReport> SegmentedRun::Search(double segment_s) {
  SegmentedReport result;
  const auto finish = [&] {
    result.index = run_.report();
    return result;
  };
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<PlannedCut> found, FindCut(std::nullopt));
  std::string whole_plan;
  if (found && found->cut.is_whole) {
    whole_plan = found->cut.plan;
  } else if (found) {
    const bool is_open = FirstOpenFrame(found->cut).has_value();
    VICTORIOUS_ASSIGN_OR_RETURN(const bool is_joined, JoinSegments(*found));
    if (is_joined && is_open) {
      result.waits_for = found->cut.id;
      return finish();
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const bool is_finished, IsFinished(found->video));
    if (is_joined && is_finished) return finish();
  }
  VICTORIOUS_RETURN_IF_ERROR(run_.Open());
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<PlannedPass> plans, run_.Plan());
  VICTORIOUS_RETURN_IF_ERROR(run_.Begin(plans));
  const OpenedVideo& video = run_.video();
  for (const PlannedPass& plan : plans) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, CutPlan(plan, video.intervals));
    if (text != whole_plan) {
      VICTORIOUS_ASSIGN_OR_RETURN(result.waits_for, CutPass(plan, text, segment_s));
      if (result.waits_for) return finish();
    } else if (plan.searches.front().next_frame == 0) {
      // Segments that were searched before may have kept frames under other numbers.
      VICTORIOUS_RETURN_IF_ERROR(run_.store().DeleteKeptFrames(video.record.id));
    }
    VICTORIOUS_RETURN_IF_ERROR(run_.SearchPass(plan));
    if (text == whole_plan) VICTORIOUS_RETURN_IF_ERROR(segments_.Finish(found->cut.id, {}));
  }
  return finish();
}

// Between two frames that are searched as a whole for any target.
int SegmentedRun::MinInterval(const PlannedPass& pass, const SearchIntervals& intervals) const {
  int every = intervals.models;
  for (const std::size_t target : pass.targets) every = std::min(every, intervals.Of(run_.setup().targets[target]));
  return every;
}

Expected<std::string> SegmentedRun::CutPlan(const PlannedPass& pass, const SearchIntervals& intervals) const {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string program, ProgramId());
  const IndexOptions& options = run_.setup().options;
  const nlohmann::ordered_json plan = {
      {"models", ModelsOf(pass.searches)},
      {"options", SearchOptionsText(options, options.every, intervals.tracked, run_.job())},
      {"intervals", {intervals.models, intervals.categories, intervals.tracked}},
      {"program", program}};
  return DumpJson(plan);
}

Expected<bool> SegmentedRun::IsFinished(const VideoRecord& video) const {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, run_.store().Models());
  for (const ModelRecord& target : run_.setup().targets) {
    const ModelRecord* const stored = FindSame(models, target);
    if (stored == nullptr) return false;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SearchRecord> search,
                                run_.store().FindSearch(video.id, stored->id));
    if (!search || !search->finished) return false;
  }
  return true;
}

// The searches of a plan that this indexer made, or one like it; std::nullopt for another plan.
Expected<std::optional<SegmentedRun::PlannedCut>> SegmentedRun::ReadCutPlan(const VideoRecord& video,
                                                                            const VideoCut& cut) const {
  const Expected<nlohmann::json> plan = ParseStrictJson(cut.plan);
  if (!plan || !plan->is_object() || !plan->contains("models") || !(*plan)["models"].is_array()) return std::nullopt;
  const nlohmann::json& of_plan = (*plan)["models"];
  const std::optional<SearchIntervals> intervals = IntervalsOf(*plan);
  if (!intervals) return std::nullopt;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, run_.store().Models());
  const std::vector<ModelRecord>& targets = run_.setup().targets;
  PlannedPass pass;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    const ModelRecord* const model = FindSame(models, targets[t]);
    if (model == nullptr || std::ranges::find(of_plan, nlohmann::json(model->id)) == of_plan.end()) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SearchRecord> before,
                                run_.store().FindSearch(cut.video, model->id));
    pass.targets.push_back(t);
    pass.searches.push_back({.video = cut.video,
                             .model = model->id,
                             .next_frame = before ? before->next_frame : 0,
                             .finished = before && before->finished,
                             .options_json = SearchOptionsText(run_.setup().options, intervals->Of(targets[t]),
                                                               intervals->tracked, run_.job()),
                             .program_version = kVersion});
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string own, CutPlan(pass, *intervals));
  if (own != cut.plan) return std::nullopt;
  return PlannedCut{video, cut, std::move(pass), *intervals, {}};
}

Expected<std::optional<SegmentedRun::PlannedCut>> SegmentedRun::FindCut(std::optional<FrameInterval> frames) const {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, run_.store().VideosNamed(run_.job().StoredName()));
  for (const VideoRecord& video : videos) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoCut> cuts, segments_.CutsOf(video.id));
    for (const VideoCut& cut : cuts) {
      VICTORIOUS_ASSIGN_OR_RETURN(std::optional<PlannedCut> planned, ReadCutPlan(video, cut));
      if (!planned) continue;
      if (frames) {
        const auto segment = std::ranges::find(cut.segments, *frames, &Segment::frames);
        if (segment == cut.segments.end()) continue;
        if (segment->state != SegmentState::kOpen) return planned;
      }
      VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes,
                                  frames ? segments_.PreparedOf(cut.id, *frames) : segments_.Prepared(cut.id));
      VICTORIOUS_ASSIGN_OR_RETURN(planned->prepared, UnpackPreparedVideo(bytes));
      if (planned->prepared.file_bytes != FileBytes(run_.job().video)) continue;  // another file of this name
      VICTORIOUS_RETURN_IF_ERROR(CheckFrames(cut, planned->prepared));
      return planned;
    }
  }
  return std::nullopt;
}

OpenedVideo SegmentedRun::VideoOf(PlannedCut& found) {
  IndexReport& report = run_.report();
  report.sun = found.prepared.sun;
  report.sun_by_clock = found.prepared.is_sun_by_clock;
  report.sun_from_camera = found.prepared.cameras.has_assumed_attitudes();
  return {.reader = nullptr,
          .cameras = std::move(found.prepared.cameras),
          .record = found.video,
          .intervals = found.intervals,
          .follow = run_.FollowOptionsFor(found.intervals.tracked, false)};
}

Expected<std::optional<std::int64_t>> SegmentedRun::CutPass(const PlannedPass& plan, const std::string& text,
                                                            double segment_s) {
  VICTORIOUS_RETURN_IF_ERROR(run_.Reopen());
  OpenedVideo& video = run_.video();
  const VideoInfo info = video.reader->info();
  if (info.live || video.cameras.is_of_photos() || run_.job().from_s || run_.job().to_s) return std::nullopt;
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<FrameTable> table, ReadFrameTable(run_.job().video, run_.cancel()));
  if (!table) return std::nullopt;
  VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer, run_.MakeRecognizer(plan));
  const IndexPass pass = run_.MakePass(plan, recognizer, {}, video);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t first_frame, FirstLinkedFrame(pass, info, run_.store()));
  const std::int64_t step = pass.follow.restart_interval_frames;
  const std::vector<FrameInterval> cuts =
      CutVideo(*table, {.first_frame = first_frame,
                        .step = step,
                        .segment_s = SegmentSeconds(segment_s, MinInterval(plan, video.intervals), run_.setup().options,
                                                    info.frame_rate)});
  if (cuts.size() < 2) return std::nullopt;
  VICTORIOUS_RETURN_IF_ERROR(run_.EstimateSun(recognizer));
  VideoCut cut{.video = video.record.id, .plan = text, .step = step};
  PreparedVideo prepared{.times_s = std::move(table->times_s),
                         .cameras = std::move(video.cameras),
                         .sun = run_.report().sun,
                         .is_sun_by_clock = run_.report().sun_by_clock,
                         .file_bytes = FileBytes(run_.job().video)};
  const std::vector<std::byte> all = PackPreparedVideo(prepared);
  const CameraStates cameras = std::move(prepared.cameras);
  const auto time_s = [&](std::int64_t frame) { return prepared.times_s[static_cast<std::size_t>(frame)]; };
  std::vector<std::vector<std::byte>> of_segments;
  for (const FrameInterval& frames : cuts) {
    cut.segments.push_back({.frames = frames, .state = {}, .reason = {}});
    const std::int64_t first_read = WholeFrameBefore(frames.from, MinInterval(plan, video.intervals), video.follow);
    prepared.cameras = cameras.Between(time_s(first_read), time_s(frames.to - 1));
    of_segments.push_back(PackPreparedVideo(prepared));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t id, segments_.Put(cut, ModelsOf(plan.searches), all, of_segments));
  return id;
}

Expected<IndexReport> SegmentedRun::SearchSegment(FrameInterval frames) {
  const IndexReport& report = run_.report();
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<PlannedCut> found, FindCut(frames));
  const auto segment =
      found ? std::ranges::find(found->cut.segments, frames, &Segment::frames) : std::vector<Segment>::iterator();
  const auto leave = [&] {
    if (run_.job().inform) {
      run_.job().inform(fmt::format("frames {} to {} are no segment of it any more: it was cut anew, or has changed",
                                    frames.from, frames.to - 1));
    }
    return report;
  };
  if (!found || segment == found->cut.segments.end()) return leave();
  if (segment->state != SegmentState::kOpen || found->cut.is_whole) return report;
  OpenedVideo video = VideoOf(*found);
  const PreparedVideo& prepared = found->prepared;
  const std::int64_t first_read =
      WholeFrameBefore(frames.from, MinInterval(found->pass, video.intervals), video.follow);
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::unique_ptr<SegmentReader> reader,
      SegmentReader::Open(run_.job().video, run_.ReaderOptions(), prepared.times_s, {first_read, frames.to}));
  std::vector<FrameResult> results;
  IndexBatch kept;
  const SegmentOutput output{
      .first_read = first_read, .frames = frames, .add = [&](FrameResult result, std::optional<KeptFrame> kept_frame) {
        results.push_back(std::move(result));
        if (kept_frame) kept.kept_frames.push_back(*std::move(kept_frame));
      }};
  for (SearchRecord& search : found->pass.searches) search.next_frame = frames.from;
  VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer, run_.MakeRecognizer(found->pass));
  const std::vector<std::optional<std::int64_t>> category_ids = run_.CategoryIds(found->pass);
  IndexPass pass = run_.MakePass(found->pass, recognizer, category_ids, video);
  pass.sun = prepared.sun;
  pass.segment = &output;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<const ShapeSearch> shapes,
                              run_.MakeShapeSearch(recognizer, video.cameras, reader->info()));
  pass.shapes = shapes.get();
  VICTORIOUS_RETURN_IF_ERROR(RunIndexPass(pass, *reader, run_.cancel(), run_.store(), run_.warn(), run_.report()));
  if (!reader->IsExact()) {
    if (run_.job().inform)
      run_.job().inform("its frames are not those that its container lists: it is indexed by one process");
    VICTORIOUS_RETURN_IF_ERROR(segments_.SetWhole(found->cut.id));
    // It begins anew: segments that were joined before may have kept frames that a resumed pass would keep, too. Where
    // both stores are one database, SetWhole has deleted the searches.
    for (const SearchRecord& search : found->pass.searches) {
      VICTORIOUS_RETURN_IF_ERROR(run_.store().DeleteSearch(search.video, search.model));
    }
    return report;
  }
  if (!kept.kept_frames.empty()) VICTORIOUS_RETURN_IF_ERROR(run_.store().Commit(kept));
  const Status completed = segments_.Complete(found->cut.id, frames, PackFrameResults(results));
  if (!completed && completed.error().code == ErrorCode::kNotFound) return leave();
  VICTORIOUS_RETURN_IF_ERROR(completed);
  return report;
}

Expected<bool> SegmentedRun::JoinSegments(PlannedCut& found) {
  OpenedVideo video = VideoOf(found);
  const PreparedVideo& prepared = found.prepared;
  const std::optional<std::int64_t> first_open = FirstOpenFrame(found.cut);
  const std::int64_t end = first_open.value_or(std::ssize(prepared.times_s));
  const SearchRecord& search = found.pass.searches.front();
  if (first_open && search.next_frame >= end) return true;  // joined before
  if (!search.finished) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(run_.job().video, run_.ReaderOptions()));
    // The segments may have been searched in another file of this name and size.
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string content_id, ContentIdOf(*reader, run_.job().video, run_.cancel()));
    if (content_id != found.video.content_id) return false;
    VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer, Recognizer::Create(run_.SearchedModels(found.pass),
                                                                                run_.setup().options.features.engine,
                                                                                run_.setup().options.recognize));
    const auto visit = [&](const std::function<Status(std::vector<FrameResult>)>& add) {
      return segments_.VisitResults(
          found.cut.id, [&](FrameInterval frames, std::span<const std::byte> packed) -> Status {
            if (frames.from >= end) return {};
            VICTORIOUS_ASSIGN_OR_RETURN(std::vector<FrameResult> results, UnpackFrameResults(packed));
            return add(std::move(results));
          });
    };
    IndexPass pass = run_.MakePass(found.pass, recognizer, {}, video);
    pass.times_s = prepared.times_s;
    VICTORIOUS_RETURN_IF_ERROR(
        JoinFrames(pass, reader->info(), visit, !first_open, run_.cancel(), run_.store(), run_.report()));
    if (first_open) {
      // What the next join needs stays: it goes on as after an interruption.
      PlannedPass rest = found.pass;
      VICTORIOUS_ASSIGN_OR_RETURN(const auto joined, run_.store().FindSearch(search.video, search.model));
      for (SearchRecord& one : rest.searches) one.next_frame = joined ? joined->next_frame : 0;
      const IndexPass next = run_.MakePass(rest, recognizer, {}, video);
      VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t first_frame, FirstLinkedFrame(next, reader->info(), run_.store()));
      VICTORIOUS_RETURN_IF_ERROR(segments_.Discard(found.cut.id, first_frame));
      return true;
    }
  }
  VICTORIOUS_RETURN_IF_ERROR(
      run_.store().SetVideoLength(found.video.id, std::ssize(prepared.times_s), prepared.times_s.back()));
  VICTORIOUS_RETURN_IF_ERROR(segments_.Finish(found.cut.id, GapsOf(found.cut, prepared.times_s)));
  return true;
}

}  // namespace victorious
