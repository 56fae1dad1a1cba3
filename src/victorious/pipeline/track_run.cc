#include "victorious/pipeline/track_run.h"

#include <algorithm>
#include <memory>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/progress.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/store/export_json.h"
#include "victorious/track/box_tracker.h"
#include "victorious/video/image_file.h"
#include "victorious/video/video_reader.h"

namespace victorious {
namespace {

using Sightings = std::vector<BoxSighting>;

/// A box, the frame it was drawn in, and the model that was made of it, if it has keypoints enough.
struct Drawn {
  std::size_t index = 0;
  Box box;
  std::int64_t frame = 0;
  std::shared_ptr<const Recognizer> recognizer;
};

/// A cut of the frame as the drawn box's object, searched for by its keypoints.
Expected<std::shared_ptr<const Recognizer>> LearnModel(const Frame& frame, const Box& box, const std::string& name,
                                                       const TrackRunOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Photo photo, PreparePhoto(name, frame.image, {}, box));
  const Photo photos[] = {photo};
  VICTORIOUS_ASSIGN_OR_RETURN(ObjectModel model, MakePhotoModel(name, photos, std::nullopt, options.model));
  VICTORIOUS_ASSIGN_OR_RETURN(Recognizer recognizer,
                              Recognizer::Create({std::move(model)}, options.model.features.engine, options.recognize));
  return std::make_shared<const Recognizer>(std::move(recognizer));
}

std::string ModelName(std::size_t drawn) { return fmt::format("box-{}", drawn + 1); }

/// One way through frames: forward, backward, or through another video.
class Pass {
 public:
  Pass(BoxTracker tracker, const FeatureExtractor& extractor, int recognize_every)
      : tracker_(std::move(tracker)), extractor_(&extractor), recognize_every_(recognize_every) {}

  /// Begins in the frame last seen. @return the box, clipped to the frame
  Expected<Box> Start(const Drawn& drawn) {
    VICTORIOUS_ASSIGN_OR_RETURN(const BoxStep step, tracker_.Start(drawn.box));
    drawn_.push_back(drawn);
    return step.box;
  }

  /// Gives the target that was started last its model.
  void Equip(std::shared_ptr<const Recognizer> recognizer) { drawn_.back().recognizer = std::move(recognizer); }

  void ChangeVideo() { tracker_.ChangeVideo(); }

  /// The next frame: where each object is in it.
  Status See(const Frame& frame, std::size_t video, Sightings& sightings) {
    std::vector<std::size_t> lost;
    for (const BoxStep& step : tracker_.Step(frame)) {
      if (step.seen()) {
        sightings.push_back(Describe(step, frame, video));
      } else if (drawn_[step.target].recognizer) {
        lost.push_back(step.target);
      }
    }
    ++seen_frames_;
    if (lost.empty() || seen_frames_ % recognize_every_ != 0) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet scene, extractor_->Extract(GreyFromBgr(frame.image)));
    for (const std::size_t target : lost) Recognise(target, scene, frame, video, sightings);
    return {};
  }

 private:
  [[nodiscard]] BoxSighting Describe(const BoxStep& step, const Frame& frame, std::size_t video) const {
    return {.drawn = drawn_[step.target].index,
            .video = video,
            .frame = frame.index,
            .time_s = frame.time_s,
            .box = step.box,
            .score = step.trust};
  }

  void Recognise(std::size_t target, const FeatureSet& scene, const Frame& frame, std::size_t video,
                 Sightings& sightings) {
    const Drawn& drawn = drawn_[target];
    const std::vector<Detection> detections = drawn.recognizer->Recognize(scene);
    if (detections.empty()) return;
    const Detection& best = detections.front();
    // The drawn box's shape, whatever the turn: a box around a turned outline would be too large.
    const Box around = BoundingBox(best.outline);
    const double scale = best.pose.scene_from_template.scale;
    const double width = drawn.box.width * scale;
    const double height = drawn.box.height * scale;
    const Box box{around.x + (around.width - width) / 2, around.y + (around.height - height) / 2, width, height};
    const BoxStep step = tracker_.Resume(target, box, best.pose.scene_from_template.rotation_rad);
    if (!step.seen()) return;
    BoxSighting sighting = Describe(step, frame, video);
    sighting.score = best.score;
    sighting.matches = best.pose.inliers.size();
    sightings.push_back(sighting);
  }

  BoxTracker tracker_;
  const FeatureExtractor* extractor_;
  int recognize_every_;
  std::vector<Drawn> drawn_;  // in the order of the tracker's targets
  std::int64_t seen_frames_ = 0;
};

Status CancelledIf(const CancelToken& cancel) {
  if (cancel.IsCancelled()) return Fail(ErrorCode::kCancelled, "interrupted: nothing was written");
  return {};
}

Expected<std::unique_ptr<VideoReader>> OpenTwiceReadable(const std::string& video) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::unique_ptr<VideoReader> reader,
                              VideoReader::Open(video, {.color = FrameColor::kBgr}));
  if (reader->info().live) {
    return Fail(ErrorCode::kInvalidArgument, video + ": a live source cannot be read twice: give a file or a folder");
  }
  return reader;
}

/// Everything of one call of TrackBoxes.
class TrackRun {
 public:
  TrackRun(std::span<const std::string> videos, std::span<const DrawnBox> boxes, const TrackRunOptions& options,
           const CancelToken& cancel, const TrackWarning& warn)
      : videos_(videos), boxes_(boxes), options_(options), cancel_(cancel), warn_(warn) {}

  Expected<Sightings> Run() {
    for (const std::string& video : videos_) VICTORIOUS_RETURN_IF_ERROR(OpenTwiceReadable(video));
    VICTORIOUS_ASSIGN_OR_RETURN(extractor_, MakeFeatureExtractor(options_.model.features));
    VICTORIOUS_ASSIGN_OR_RETURN(Pass forward, NewPass());
    VICTORIOUS_RETURN_IF_ERROR(GoForward(forward));
    VICTORIOUS_RETURN_IF_ERROR(GoBackward());
    for (std::size_t video = 1; video < videos_.size(); ++video) {
      Pass search = forward;
      VICTORIOUS_RETURN_IF_ERROR(GoThrough(video, search));
    }
    std::ranges::sort(sightings_, {},
                      [](const BoxSighting& one) { return std::tuple(one.video, one.frame, one.drawn); });
    return std::move(sightings_);
  }

 private:
  Expected<Pass> NewPass() const {
    VICTORIOUS_ASSIGN_OR_RETURN(BoxTracker tracker, BoxTracker::Create(options_.box));
    return Pass(std::move(tracker), *extractor_, options_.recognize_every);
  }

  Status GoForward(Pass& pass) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, OpenTwiceReadable(videos_[0]));
    std::vector<bool> started(boxes_.size(), false);
    double last_time_s = 0;
    const auto visit = [&](const Frame& frame) -> Status {
      VICTORIOUS_RETURN_IF_ERROR(pass.See(frame, 0, sightings_));
      last_time_s = frame.time_s;
      for (std::size_t i = 0; i < boxes_.size(); ++i) {
        constexpr double kSameTime_s = 1e-6;
        if (started[i] || frame.time_s < boxes_[i].at_s - kSameTime_s) continue;
        VICTORIOUS_RETURN_IF_ERROR(Draw(i, frame, pass));
        started[i] = true;
      }
      return {};
    };
    VICTORIOUS_RETURN_IF_ERROR(ReadAll(*reader, videos_[0], visit));
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      if (started[i]) continue;
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: ends at {:.3f} s, before {} at {:g} s: give a time in it", videos_[0], last_time_s,
                              ModelName(i), boxes_[i].at_s));
    }
    return {};
  }

  Status Draw(std::size_t index, const Frame& frame, Pass& pass) {
    Drawn drawn{.index = index, .box = boxes_[index].box, .frame = frame.index, .recognizer = nullptr};
    Expected<Box> box = pass.Start(drawn);
    if (!box) return std::unexpected(std::move(box).error().WithContext(ModelName(index)));
    drawn.box = *box;
    Expected<std::shared_ptr<const Recognizer>> recognizer = LearnModel(frame, drawn.box, ModelName(index), options_);
    if (recognizer) {
      drawn.recognizer = *recognizer;
      pass.Equip(drawn.recognizer);
    } else {
      warn_(fmt::format("{}: found again by its look alone: {}", ModelName(index), recognizer.error().message));
    }
    sightings_.push_back({.drawn = index, .frame = frame.index, .time_s = frame.time_s, .box = drawn.box, .score = 1});
    drawn_.push_back(std::move(drawn));
    return {};
  }

  Status GoBackward() {
    VICTORIOUS_ASSIGN_OR_RETURN(Pass pass, NewPass());
    std::int64_t end = 0;
    for (const Drawn& drawn : drawn_) end = std::max(end, drawn.frame + 1);
    if (end <= 1) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(const auto first, OpenTwiceReadable(videos_[0]));
    const std::int64_t frame_bytes = std::int64_t{3} * first->info().width * first->info().height;
    const std::int64_t stretch = std::max<std::int64_t>(8, (std::int64_t{options_.memory_mb} << 20) / frame_bytes);
    Progress progress(videos_[0] + ", backward", end, "frames");
    std::int64_t done = 0;
    for (; end > 0; end = std::max<std::int64_t>(0, end - stretch)) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Frame> frames,
                                  ReadStretch(std::max<std::int64_t>(0, end - stretch), end));
      for (auto frame = frames.rbegin(); frame != frames.rend(); ++frame) {
        VICTORIOUS_RETURN_IF_ERROR(CancelledIf(cancel_));
        VICTORIOUS_RETURN_IF_ERROR(pass.See(*frame, 0, sightings_));
        for (const Drawn& drawn : drawn_) {
          if (drawn.frame == frame->index) VICTORIOUS_RETURN_IF_ERROR(pass.Start(drawn));
        }
        progress.Update(++done);
      }
    }
    return {};
  }

  Expected<std::vector<Frame>> ReadStretch(std::int64_t first, std::int64_t end) const {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, OpenTwiceReadable(videos_[0]));
    std::vector<Frame> frames;
    while (true) {
      VICTORIOUS_RETURN_IF_ERROR(CancelledIf(cancel_));
      VICTORIOUS_ASSIGN_OR_RETURN(std::optional<Frame> frame, reader->NextFrame());
      if (!frame || frame->index >= end) return frames;
      if (frame->index >= first) frames.push_back(*std::move(frame));
    }
  }

  Status GoThrough(std::size_t video, Pass& pass) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, OpenTwiceReadable(videos_[video]));
    pass.ChangeVideo();
    return ReadAll(*reader, videos_[video], [&](const Frame& frame) { return pass.See(frame, video, sightings_); });
  }

  template <typename Visit>
  Status ReadAll(VideoReader& reader, const std::string& name, const Visit& visit) const {
    Progress progress(name, reader.info().frame_count, "frames");
    while (true) {
      VICTORIOUS_RETURN_IF_ERROR(CancelledIf(cancel_));
      VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Frame> frame, reader.NextFrame());
      if (!frame) break;
      VICTORIOUS_RETURN_IF_ERROR(visit(*frame));
      progress.Update(frame->index + 1);
    }
    for (const std::string& warning : reader.warnings()) warn_(name + ": " + warning);
    return {};
  }

  std::span<const std::string> videos_;
  std::span<const DrawnBox> boxes_;
  const TrackRunOptions& options_;
  const CancelToken& cancel_;
  const TrackWarning& warn_;
  std::unique_ptr<const FeatureExtractor> extractor_;
  std::vector<Drawn> drawn_;
  Sightings sightings_;
};

}  // namespace

void TrackRunOptions::ListFields(FieldList& fields) {
  fields.AddGroup("box", box);
  fields.Add("recognize_every", recognize_every,
             {.min = 1,
              .max = 100'000,
              .unit = "frames",
              .reason = "a lost object of enough keypoints is sought by them in every so many-th frame: as costly as "
                        "some ten frames of following"});
  fields.Add("memory_mb", memory_mb,
             {.min = 1,
              .max = 1'000'000,
              .unit = "MiB",
              .reason = "of frames held at once on the way backward: less reads the video more often"});
  fields.AddGroup("model", model);
  fields.AddGroup("recognize", recognize);
}

Expected<std::vector<BoxSighting>> TrackBoxes(std::span<const std::string> videos, std::span<const DrawnBox> boxes,
                                              const TrackRunOptions& options, const CancelToken& cancel,
                                              const TrackWarning& warn) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (videos.empty() || boxes.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "nothing to follow: give a video and a box in it");
  }
  return TrackRun(videos, boxes, options, cancel, warn).Run();
}

std::string ToJsonLines(std::span<const BoxSighting> sightings, std::span<const std::string> videos) {
  std::string text;
  for (const BoxSighting& sighting : sightings) {
    text += Dump({{"object_id", sighting.drawn + 1},
                  {"model", ModelName(sighting.drawn)},
                  {"category", nullptr},
                  {"video", videos[sighting.video]},
                  {"frame", sighting.frame},
                  {"time_s", TimeJson(sighting.time_s)},
                  {"box", BoxJson(sighting.box)},
                  {"score", ScoreJson(sighting.score)},
                  {"source", sighting.matches ? "recognised" : "tracked"},
                  {"matches", sighting.matches ? Json(*sighting.matches) : Json()},
                  {"view", nullptr}}) +
            "\n";
  }
  return text;
}

}  // namespace victorious
