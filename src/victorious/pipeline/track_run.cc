#include "victorious/pipeline/track_run.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/progress.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/features/impulse_noise.h"
#include "victorious/pipeline/video_telemetry.h"
#include "victorious/telemetry/camera_track.h"
#include "victorious/track/box_tracker.h"
#include "victorious/track/ground_spot.h"
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
  Sightings doubtful;                // since it was found again; they count once it is sure
  std::optional<GroundSpot> ground;  // where it was drawn
  std::optional<Box> last_box;       // in the frame before
};

/// Where the ground is to be seen that the object of a drawn box stood on.
struct DrawnSpot {
  std::size_t drawn = 0;
  SpotSighting seen;
};
using Spots = std::vector<DrawnSpot>;

std::optional<CameraState> CameraAt(const std::optional<CameraTrack>& cameras, double time_s) {
  return cameras ? cameras->At(time_s) : std::nullopt;
}

/// What stands at a known place, and how it was seen where it was drawn.
struct Standing {
  Place place;
  Box box;
  CameraState camera;
};

/// What places tell of the drawn boxes' objects in one more video.
class Guide {
 public:
  Guide(const std::vector<std::optional<Standing>>& standing, const std::optional<CameraTrack>& cameras,
        const BoxPlaceOptions& options)
      : standing_(standing), cameras_(cameras), options_(options) {}

  /// What is seen there stands elsewhere.
  [[nodiscard]] bool Contradicts(std::size_t drawn, const Box& box, const Frame& frame) const {
    const auto camera = CameraAt(cameras_, frame.time_s);
    if (!standing_[drawn] || !camera) return false;
    const auto sight = SightOfBox(box, frame.image.size(), *camera, nullptr, 0, options_);
    return sight && !GoesBy(*sight, standing_[drawn]->place, options_);
  }

  [[nodiscard]] std::optional<SeenBox> Expect(std::size_t drawn, const Frame& frame) const {
    const auto camera = CameraAt(cameras_, frame.time_s);
    if (!standing_[drawn] || !camera) return std::nullopt;
    const Standing& standing = *standing_[drawn];
    return ExpectBox(standing.place.point, standing.box, standing.camera, *camera, frame.image.size());
  }

 private:
  const std::vector<std::optional<Standing>>& standing_;
  const std::optional<CameraTrack>& cameras_;
  const BoxPlaceOptions& options_;
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

/// One way through frames: forward, backward, or through another video.
class Pass {
 public:
  /// @param impulse_share  of the frames (WithoutImpulses), where the ground is watched, too; else nothing
  Pass(BoxTracker tracker, const FeatureExtractor& extractor, int recognize_every, std::optional<double> impulse_share)
      : tracker_(std::move(tracker)),
        extractor_(&extractor),
        recognize_every_(recognize_every),
        impulse_share_(impulse_share) {}

  /// Begins in the frame last seen. @return the box, clipped to the frame
  Expected<Box> Start(const Drawn& drawn) {
    VICTORIOUS_ASSIGN_OR_RETURN(const BoxStep step, tracker_.Start(drawn.box));
    drawn_.push_back(drawn);
    drawn_.back().last_box = step.box;
    if (impulse_share_) drawn_.back().ground.emplace(FlowPyramid(Clean(last_image_), {}), step.box);
    return step.box;
  }

  /// Gives the target that was started last its model.
  void Equip(std::shared_ptr<const Recognizer> recognizer) { drawn_.back().recognizer = std::move(recognizer); }

  void ChangeVideo() {
    tracker_.ChangeVideo();
    impulse_share_.reset();
    for (Drawn& drawn : drawn_) {
      drawn.doubtful.clear();
      drawn.ground.reset();
    }
  }

  /// Where the ground that each object was drawn on was seen since the last call.
  [[nodiscard]] Spots TakeSpots() { return std::exchange(spots_, {}); }

  /// The next frame: where each object is in it.
  /// @param guide  where places are known
  Status See(const Frame& frame, std::size_t video, const Guide* guide, Sightings& sightings) {
    SeeGround(frame);
    std::vector<std::size_t> lost;
    for (const BoxStep& step : tracker_.Step(frame)) {
      if (!Take(step, frame, video, guide, nullptr, sightings)) lost.push_back(step.target);
    }
    ++seen_frames_;
    if (seen_frames_ % recognize_every_ != 0) return {};
    if (guide != nullptr) {
      std::erase_if(lost,
                    [&](std::size_t target) { return LookWhereItStands(target, frame, video, *guide, sightings); });
    }
    std::erase_if(lost, [&](std::size_t target) { return drawn_[target].recognizer == nullptr; });
    if (lost.empty()) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet scene, extractor_->Extract(GreyFromBgr(frame.image)));
    for (const std::size_t target : lost) Recognise(target, scene, frame, video, guide, sightings);
    return {};
  }

 private:
  /// @param recognised  by the recogniser, with its score and matches
  /// @return whether it is seen, and what is seen may be it
  bool Take(const BoxStep& step, const Frame& frame, std::size_t video, const Guide* guide, const Detection* recognised,
            Sightings& sightings) {
    Drawn& drawn = drawn_[step.target];
    const bool elsewhere = step.seen() && guide != nullptr && guide->Contradicts(drawn.index, step.extent, frame);
    if (elsewhere) tracker_.Lose(step.target);
    drawn.last_box.reset();
    if (elsewhere || !step.seen()) {
      drawn.doubtful.clear();
      return false;
    }
    drawn.last_box = step.box;
    BoxSighting sighting{.drawn = drawn.index,
                         .video = video,
                         .frame = frame.index,
                         .time_s = frame.time_s,
                         .box = step.box,
                         .extent = step.extent,
                         .score = step.trust};
    if (recognised != nullptr) {
      sighting.score = recognised->score;
      sighting.matches = recognised->pose.inliers.size();
    }
    drawn.doubtful.push_back(sighting);
    if (!step.doubtful) {
      std::ranges::move(drawn.doubtful, std::back_inserter(sightings));
      drawn.doubtful.clear();
    }
    return true;
  }

  [[nodiscard]] cv::Mat Clean(const cv::Mat& image) const {
    return WithoutImpulses(GreyFromBgr(image), *impulse_share_);
  }

  void SeeGround(const Frame& frame) {
    if (!impulse_share_) return;
    last_image_ = frame.image;
    if (std::ranges::none_of(drawn_, [](const Drawn& drawn) { return drawn.ground.has_value(); })) return;
    const FlowPyramid clean(Clean(frame.image), {});
    for (Drawn& drawn : drawn_) {
      if (!drawn.ground) continue;
      if (const auto place = drawn.ground->Step(clean, drawn.last_box)) {
        spots_.push_back({drawn.index, {frame.index, frame.time_s, *place}});
      } else {
        drawn.ground.reset();
      }
    }
  }

  bool LookWhereItStands(std::size_t target, const Frame& frame, std::size_t video, const Guide& guide,
                         Sightings& sightings) {
    const auto expected = guide.Expect(drawn_[target].index, frame);
    if (!expected) return false;
    const Box inside = Intersection(
        expected->box, {0, 0, static_cast<double>(frame.image.cols), static_cast<double>(frame.image.rows)});
    constexpr double kLeastInView = 0.5;
    if (!(inside.Area() > kLeastInView * expected->box.Area())) return false;
    const BoxStep step = tracker_.Resume(target, expected->box, expected->turn_rad, BoxTracker::Evidence::kPlace);
    return Take(step, frame, video, &guide, nullptr, sightings);
  }

  void Recognise(std::size_t target, const FeatureSet& scene, const Frame& frame, std::size_t video, const Guide* guide,
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
    const BoxStep step =
        tracker_.Resume(target, box, best.pose.scene_from_template.rotation_rad, BoxTracker::Evidence::kLook);
    Take(step, frame, video, guide, &best, sightings);
  }

  BoxTracker tracker_;
  const FeatureExtractor* extractor_;
  int recognize_every_;
  std::vector<Drawn> drawn_;  // in the order of the tracker's targets
  std::int64_t seen_frames_ = 0;
  std::optional<double> impulse_share_;
  cv::Mat last_image_;  // where the ground is watched
  Spots spots_;
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
           const CancelToken& cancel, const WarningSink& warn)
      : videos_(videos),
        boxes_(boxes),
        options_(options),
        cancel_(cancel),
        warn_(warn),
        sizes_(videos.size()),
        spots_(boxes.size()) {}

  /// @param telemetry  a file of the first video's
  Expected<Sightings> Run(const std::optional<std::string>& telemetry) {
    VICTORIOUS_ASSIGN_OR_RETURN(told_ground_, MakeGround(options_.ground, warn_));
    std::vector<std::optional<double>> durations_s;
    for (const std::string& video : videos_) {
      VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, OpenTwiceReadable(video));
      durations_s.push_back(reader->info().duration_s);
    }
    for (std::size_t video = 0; video < videos_.size(); ++video) {
      VICTORIOUS_ASSIGN_OR_RETURN(std::optional<CameraTrack> cameras,
                                  CamerasOf(videos_[video], durations_s[video], video == 0 ? telemetry : std::nullopt));
      cameras_.push_back(std::move(cameras));
    }
    VICTORIOUS_ASSIGN_OR_RETURN(extractor_, MakeFeatureExtractor(options_.model.features));
    VICTORIOUS_ASSIGN_OR_RETURN(Pass forward, NewPass());
    VICTORIOUS_RETURN_IF_ERROR(GoForward(forward));
    VICTORIOUS_RETURN_IF_ERROR(GoBackward());
    PlaceAll();
    const std::vector<std::optional<Standing>> standing = WhatStands();
    for (std::size_t video = 1; video < videos_.size(); ++video) {
      Pass search = forward;
      VICTORIOUS_RETURN_IF_ERROR(GoThrough(video, standing, search));
    }
    if (videos_.size() > 1) PlaceAll();
    return std::move(sightings_);
  }

 private:
  Expected<Pass> NewPass() const {
    VICTORIOUS_ASSIGN_OR_RETURN(BoxTracker tracker, BoxTracker::Create(options_.box));
    const auto impulse_share = cameras_[0] ? std::optional(options_.model.features.impulse_share) : std::nullopt;
    return Pass(std::move(tracker), *extractor_, options_.recognize_every, impulse_share);
  }

  Status GoForward(Pass& pass) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, OpenTwiceReadable(videos_[0]));
    std::vector<bool> started(boxes_.size(), false);
    double last_time_s = 0;
    const auto visit = [&](const Frame& frame) -> Status {
      sizes_[0] = frame.image.size();
      VICTORIOUS_RETURN_IF_ERROR(pass.See(frame, 0, nullptr, sightings_));
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
    KeepSpots(pass);
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      if (started[i]) continue;
      const std::string why = reader->warnings().empty() ? "" : fmt::format(" ({})", reader->warnings().back());
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: ends at {:.3f} s{}, before {} at {:g} s: give a time in it", videos_[0], last_time_s,
                              why, BoxName(i), boxes_[i].at_s));
    }
    return {};
  }

  Status Draw(std::size_t index, const Frame& frame, Pass& pass) {
    Drawn drawn{.index = index, .box = boxes_[index].box, .frame = frame.index, .recognizer = nullptr};
    Expected<Box> box = pass.Start(drawn);
    if (!box) return std::unexpected(std::move(box).error().WithContext(BoxName(index)));
    drawn.box = *box;
    Expected<std::shared_ptr<const Recognizer>> recognizer = LearnModel(frame, drawn.box, BoxName(index), options_);
    if (recognizer) {
      drawn.recognizer = *recognizer;
      pass.Equip(drawn.recognizer);
    } else {
      warn_(fmt::format("{}: found again by its look alone: {}", BoxName(index), recognizer.error().message));
    }
    sightings_.push_back({.drawn = index,
                          .frame = frame.index,
                          .time_s = frame.time_s,
                          .box = drawn.box,
                          .extent = drawn.box,
                          .score = 1});
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
        VICTORIOUS_RETURN_IF_ERROR(pass.See(*frame, 0, nullptr, sightings_));
        for (const Drawn& drawn : drawn_) {
          if (drawn.frame == frame->index) VICTORIOUS_RETURN_IF_ERROR(pass.Start(drawn));
        }
        progress.Update(++done);
      }
    }
    KeepSpots(pass);
    return {};
  }

  void KeepSpots(Pass& pass) {
    for (DrawnSpot& spot : pass.TakeSpots()) spots_[spot.drawn][spot.seen.frame] = spot.seen;
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

  Status GoThrough(std::size_t video, const std::vector<std::optional<Standing>>& standing, Pass& pass) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, OpenTwiceReadable(videos_[video]));
    pass.ChangeVideo();
    const Guide guide(standing, cameras_[video], options_.place);
    return ReadAll(*reader, videos_[video], [&](const Frame& frame) {
      sizes_[video] = frame.image.size();
      return pass.See(frame, video, &guide, sightings_);
    });
  }

  Expected<std::optional<CameraTrack>> CamerasOf(const std::string& video, std::optional<double> duration_s,
                                                 const std::optional<std::string>& file) const {
    std::optional<Telemetry> telemetry;
    if (file) {
      VICTORIOUS_ASSIGN_OR_RETURN(telemetry, ReadTelemetry(*file, options_.telemetry));
    } else {
      VICTORIOUS_ASSIGN_OR_RETURN(telemetry, FindTelemetry(video, options_.telemetry, warn_));
    }
    if (!telemetry || telemetry->states.empty()) return std::nullopt;
    for (const std::string& warning : telemetry->warnings) warn_(fmt::format("{}: {}", file.value_or(video), warning));
    if (const auto why = WhyOfNoUse(telemetry->states, duration_s)) {
      warn_(fmt::format("{}: nothing will get a place: {}", file.value_or(video + ", telemetry"), *why));
    }
    return std::optional(CameraTrack(std::move(telemetry->states), options_.telemetry.max_gap_s));
  }

  /// Gives every sighting its sight and its place, and puts them in order.
  void PlaceAll() {
    std::ranges::sort(sightings_, {},
                      [](const BoxSighting& one) { return std::tuple(one.video, one.frame, one.drawn); });
    for (std::size_t drawn = 0; drawn < boxes_.size(); ++drawn) {
      const ObjectType* type = FindObjectType(boxes_[drawn].type);
      std::vector<std::vector<BoxSighting*>> seen(videos_.size());
      for (BoxSighting& sighting : sightings_) {
        if (sighting.drawn != drawn) continue;
        const auto camera = CameraAt(cameras_[sighting.video], sighting.time_s);
        if (!camera) continue;
        const auto recognition = static_cast<std::int64_t>(sighting.video * boxes_.size() + drawn + 1);
        sighting.sight =
            SightOfBox(sighting.extent, sizes_[sighting.video], *camera, type, recognition, options_.place);
        if (sighting.sight) seen[sighting.video].push_back(&sighting);
      }
      const BoxMotion motion = MotionOf(drawn, type, seen[0]);
      // Of what may fly, and of what nobody says what it is and does not leave its spot, lines of sight alone tell
      // more than the spot.
      const bool flies = type != nullptr && type->flies;
      const std::optional<BoxGround> told = flies ? std::nullopt : ToldGround();
      const bool on_spot = type != nullptr ? !flies : motion == BoxMotion::kMoves;
      const std::optional<BoxGround> ground = told || !on_spot ? told : GroundOf(drawn);
      PutPlaces(seen[0], motion, ground);
      const bool stands =
          motion != BoxMotion::kMoves && !seen[0].empty() && seen[0].front()->place && !seen[0].front()->place->Moves();
      std::vector<BoxSighting*> all;
      for (const auto& of_video : seen) all.insert(all.end(), of_video.begin(), of_video.end());
      if (stands && all.size() > seen[0].size()) PutPlaces(all, BoxMotion::kStands, ground);
      for (std::size_t video = 1; video < seen.size() && !stands; ++video) PutPlaces(seen[video], motion, told);
    }
  }

  /// By how far it leaves the spot of ground that it was drawn on, over its length: what is higher than the ground, and
  /// is boxed a little differently from frame to frame, leaves it a little.
  [[nodiscard]] BoxMotion MotionOf(std::size_t drawn, const ObjectType* type,
                                   const std::vector<BoxSighting*>& seen) const {
    if (type != nullptr && type->stands_still) return BoxMotion::kStands;
    constexpr double kMoves = 1;
    constexpr double kStays = 0.5;
    constexpr double kStray = 0.05;  // a share of boxes, three at least, may lie beside the object
    std::vector<double> away;
    for (const BoxSighting* sighting : seen) {
      const auto spot = spots_[drawn].find(sighting->frame);
      if (spot == spots_[drawn].end() || EndsAtTheEdge(sighting->box, sizes_[0])) continue;
      const Box& box = sighting->extent;
      const Eigen::Vector2d centre(box.x + box.width / 2, box.y + box.height / 2);
      away.push_back((centre - spot->second.place).norm() / std::max(box.width, box.height));
    }
    const std::size_t strays = std::max<std::size_t>(3, static_cast<std::size_t>(kStray * std::ssize(away)));
    if (away.size() <= strays) return BoxMotion::kUnknown;
    std::ranges::nth_element(away, away.end() - 1 - static_cast<std::ptrdiff_t>(strays));
    const double farthest = *(away.end() - 1 - static_cast<std::ptrdiff_t>(strays));
    if (farthest > kMoves) return BoxMotion::kMoves;
    return farthest < kStays && 2 * away.size() > seen.size() ? BoxMotion::kStands : BoxMotion::kUnknown;
  }

  [[nodiscard]] std::optional<BoxGround> ToldGround() const {
    if (!told_ground_) return std::nullopt;
    return BoxGround{told_ground_, options_.place.locate.ground_sigma_m};
  }

  /// By the spot of it that the box was drawn on.
  [[nodiscard]] std::optional<BoxGround> GroundOf(std::size_t drawn) const {
    if (!cameras_[0]) return std::nullopt;
    std::vector<SpotSighting> spots;
    for (const auto& [frame, spot] : spots_[drawn]) spots.push_back(spot);
    const std::optional<Place> place = PlaceOfSpot(spots, *cameras_[0], sizes_[0], options_.place);
    return place ? std::optional(BoxGround::About(*place)) : std::nullopt;
  }

  void PutPlaces(const std::vector<BoxSighting*>& seen, BoxMotion motion,
                 const std::optional<BoxGround>& ground) const {
    std::vector<Sight> sights;
    for (const BoxSighting* sighting : seen) sights.push_back(*sighting->sight);
    const auto places = PlacesOf(sights, motion, ground, options_.place);
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i]->place = places[i];
  }

  /// By the sightings of the video that they were drawn in.
  [[nodiscard]] std::vector<std::optional<Standing>> WhatStands() const {
    std::vector<std::optional<Standing>> standing(boxes_.size());
    for (const Drawn& drawn : drawn_) {
      const auto seen = std::ranges::find_if(sightings_, [&](const BoxSighting& one) {
        return one.video == 0 && one.drawn == drawn.index && one.frame == drawn.frame;
      });
      if (seen == sightings_.end() || !seen->place || seen->place->Moves()) continue;
      standing[drawn.index] = {*seen->place, drawn.box, *CameraAt(cameras_[0], seen->time_s)};
    }
    return standing;
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
  const WarningSink& warn_;
  std::shared_ptr<const Ground> told_ground_;  // or null
  std::unique_ptr<const FeatureExtractor> extractor_;
  std::vector<std::optional<CameraTrack>> cameras_;  // by video
  std::vector<cv::Size> sizes_;                      // of frames, by video
  std::vector<Drawn> drawn_;
  Sightings sightings_;
  std::vector<std::map<std::int64_t, SpotSighting>> spots_;  // of the first video, by drawn box and frame
};

}  // namespace

void TrackRunOptions::ListFields(FieldList& fields) {
  fields.AddGroup("box", box);
  fields.AddGroup("telemetry", telemetry);
  fields.AddGroup("place", place);
  fields.AddGroup("ground", ground);
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
                                              const std::optional<std::string>& telemetry,
                                              const TrackRunOptions& options, const CancelToken& cancel,
                                              const WarningSink& warn) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (videos.empty() || boxes.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "nothing to follow: give a video and a box in it");
  }
  return TrackRun(videos, boxes, options, cancel, warn).Run(telemetry);
}

}  // namespace victorious
