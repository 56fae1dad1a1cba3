#include "victorious/pipeline/track_job.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/progress.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/pipeline/track_pass.h"
#include "victorious/pipeline/video_telemetry.h"
#include "victorious/telemetry/camera_track.h"
#include "victorious/track/box_tracker.h"
#include "victorious/video/video_reader.h"

namespace victorious {
namespace {

using Sightings = std::vector<BoxSighting>;

/// True if objects of the type need not be on the ground. @param type  or null
bool CanFly(const ObjectType* type) { return type != nullptr && type->can_fly; }

Status CheckCancelled(const CancelToken& cancel) {
  if (cancel.IsCancelled()) return Fail(ErrorCode::kCancelled, "interrupted: nothing was written");
  return {};
}

Expected<std::unique_ptr<VideoReader>> OpenRereadable(const std::string& video) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::unique_ptr<VideoReader> reader,
                              VideoReader::Open(video, {.color = FrameColor::kBgr}));
  if (reader->info().live) {
    return Fail(ErrorCode::kInvalidArgument, video + ": a live source cannot be read twice: give a file or a folder");
  }
  return reader;
}

/// State of one call of TrackBoxes.
class BoxTrackingRun {
 public:
  BoxTrackingRun(std::span<const std::string> videos, std::span<const UserBox> boxes, const TrackBoxesOptions& options,
                 const CancelToken& cancel, const WarningSink& warn)
      : videos_(videos),
        boxes_(boxes),
        options_(options),
        cancel_(cancel),
        warn_(warn),
        sizes_(videos.size()),
        ground_points_(boxes.size()) {}

  /// @param telemetry  telemetry file of the first video
  Expected<TrackedBoxes> Run(const std::optional<std::string>& telemetry) {
    VICTORIOUS_ASSIGN_OR_RETURN(given_ground_, MakeGround(options_.ground, warn_));
    std::vector<VideoInfo> infos;  // of all videos, before any is read to its end
    for (const std::string& video : videos_) {
      VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, OpenRereadable(video));
      infos.push_back(reader->info());
    }
    for (std::size_t video = 0; video < videos_.size(); ++video) {
      VICTORIOUS_ASSIGN_OR_RETURN(std::optional<CameraTrajectory> cameras,
                                  ReadCameras(videos_[video], infos[video], video == 0 ? telemetry : std::nullopt));
      cameras_.push_back(std::move(cameras));
    }
    VICTORIOUS_ASSIGN_OR_RETURN(extractor_, MakeFeatureExtractor(options_.model.features));
    VICTORIOUS_ASSIGN_OR_RETURN(TrackPass forward, NewPass());
    VICTORIOUS_RETURN_IF_ERROR(TrackForward(forward));
    VICTORIOUS_RETURN_IF_ERROR(TrackBackward());
    LocateAll();
    const std::vector<std::optional<StaticBox>> standing = FindStaticBoxes();
    for (std::size_t video = 1; video < videos_.size(); ++video) {
      TrackPass search = forward;
      VICTORIOUS_RETURN_IF_ERROR(SearchVideo(video, standing, search));
    }
    if (videos_.size() > 1) LocateAll();
    TrackedBoxes tracked{.sightings = std::move(sightings_)};
    WarnOfGround(tracked.sightings);
    for (std::size_t drawn = 0; drawn < boxes_.size(); ++drawn) {
      tracked.place_failures.push_back(PlaceFailure(drawn, tracked.sightings));
    }
    return tracked;
  }

 private:
  Expected<TrackPass> NewPass() const {
    VICTORIOUS_ASSIGN_OR_RETURN(BoxTracker tracker, BoxTracker::Create(options_.box));
    const auto impulse_fraction = cameras_[0] ? std::optional(options_.model.features.impulse_fraction) : std::nullopt;
    return TrackPass(std::move(tracker), *extractor_, options_.recognize_every, impulse_fraction);
  }

  Status TrackForward(TrackPass& pass) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, OpenRereadable(videos_[0]));
    std::vector<bool> started(boxes_.size(), false);
    double last_time_s = 0;
    const auto visit = [&](const Frame& frame) -> Status {
      sizes_[0] = frame.image.size();
      times_s_.push_back(frame.time_s);
      VICTORIOUS_RETURN_IF_ERROR(pass.ProcessFrame(frame, 0, nullptr, sightings_));
      last_time_s = frame.time_s;
      for (std::size_t i = 0; i < boxes_.size(); ++i) {
        constexpr double kSameTime_s = 1e-6;
        if (started[i] || frame.time_s < boxes_[i].at_s - kSameTime_s) continue;
        VICTORIOUS_RETURN_IF_ERROR(StartBox(i, frame, pass));
        started[i] = true;
      }
      return {};
    };
    VICTORIOUS_RETURN_IF_ERROR(ReadAll(*reader, videos_[0], visit));
    StoreGroundPoints(pass);
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      if (started[i]) continue;
      const std::string why = reader->warnings().empty() ? "" : fmt::format(" ({})", reader->warnings().back());
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: ends at {:.3f} s{}, before {} at {:g} s: give a time in it", videos_[0], last_time_s,
                              why, BoxName(i), boxes_[i].at_s));
    }
    return {};
  }

  Status StartBox(std::size_t index, const Frame& frame, TrackPass& pass) {
    UserBoxTarget target{.drawn = index, .box = boxes_[index].box, .frame = frame.index};
    Expected<Box> box = pass.Start(target);
    if (!box) return std::unexpected(std::move(box).error().WithContext(BoxName(index)));
    target.box = *box;
    Expected<std::shared_ptr<const Recognizer>> recognizer =
        MakeBoxRecognizer(frame, target.box, BoxName(index), options_.model, options_.recognize);
    if (recognizer) {
      target.recognizer = *recognizer;
      pass.SetRecognizer(target.recognizer);
    } else {
      warn_(fmt::format("{}: re-detected by its template only: {}", BoxName(index), recognizer.error().message));
    }
    sightings_.push_back({.drawn = index,
                          .frame = frame.index,
                          .time_s = frame.time_s,
                          .box = target.box,
                          .extent = target.box,
                          .score = 1});
    targets_.push_back(std::move(target));
    return {};
  }

  Status TrackBackward() {
    VICTORIOUS_ASSIGN_OR_RETURN(TrackPass pass, NewPass());
    std::int64_t end = 0;
    for (const UserBoxTarget& target : targets_) end = std::max(end, target.frame + 1);
    if (end <= 1) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(const auto first, OpenRereadable(videos_[0]));
    const std::int64_t frame_bytes = std::int64_t{3} * first->info().width * first->info().height;
    const std::int64_t stretch = std::max<std::int64_t>(8, (std::int64_t{options_.memory_mb} << 20) / frame_bytes);
    Progress progress(videos_[0] + ", backward", end, "frames");
    std::int64_t done = 0;
    for (; end > 0; end = std::max<std::int64_t>(0, end - stretch)) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Frame> frames,
                                  ReadStretch(std::max<std::int64_t>(0, end - stretch), end));
      for (auto frame = frames.rbegin(); frame != frames.rend(); ++frame) {
        VICTORIOUS_RETURN_IF_ERROR(CheckCancelled(cancel_));
        VICTORIOUS_RETURN_IF_ERROR(pass.ProcessFrame(*frame, 0, nullptr, sightings_));
        for (const UserBoxTarget& target : targets_) {
          if (target.frame == frame->index) VICTORIOUS_RETURN_IF_ERROR(pass.Start(target));
        }
        progress.Update(++done);
      }
    }
    StoreGroundPoints(pass);
    return {};
  }

  void StoreGroundPoints(TrackPass& pass) {
    for (UserBoxGroundPoint& spot : pass.TakeGroundPoints()) ground_points_[spot.drawn][spot.seen.frame] = spot.seen;
  }

  /// Reads the first video's frames [first, end), as the forward pass saw them.
  Expected<std::vector<Frame>> ReadStretch(std::int64_t first, std::int64_t end) const {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto entered, OpenRereadable(videos_[0]));
    if (entered->SeekTo(times_s_[static_cast<std::size_t>(first)])) {
      VICTORIOUS_ASSIGN_OR_RETURN(std::vector<Frame> frames, ReadBetween(*entered, first, end));
      if (std::ssize(frames) == end - first && entered->warnings().empty()) return frames;
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const auto whole, OpenRereadable(videos_[0]));
    return ReadBetween(*whole, first, end);
  }

  /// Reads on and returns the frames whose time stamps are those of [first, end).
  Expected<std::vector<Frame>> ReadBetween(VideoReader& reader, std::int64_t first, std::int64_t end) const {
    constexpr double kSameTime_s = 1e-6;
    std::vector<Frame> frames;
    std::int64_t wanted = first;
    while (wanted < end) {
      VICTORIOUS_RETURN_IF_ERROR(CheckCancelled(cancel_));
      VICTORIOUS_ASSIGN_OR_RETURN(std::optional<Frame> frame, reader.NextFrame());
      if (!frame) break;
      while (wanted < end && times_s_[static_cast<std::size_t>(wanted)] < frame->time_s - kSameTime_s) ++wanted;
      if (wanted == end || times_s_[static_cast<std::size_t>(wanted)] > frame->time_s + kSameTime_s) continue;
      frame->index = wanted++;
      frames.push_back(*std::move(frame));
    }
    return frames;
  }

  Status SearchVideo(std::size_t video, const std::vector<std::optional<StaticBox>>& standing, TrackPass& pass) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, OpenRereadable(videos_[video]));
    pass.ChangeVideo();
    const BoxPlacePrior place_prior(standing, cameras_[video], options_.place);
    return ReadAll(*reader, videos_[video], [&](const Frame& frame) {
      sizes_[video] = frame.image.size();
      return pass.ProcessFrame(frame, video, &place_prior, sightings_);
    });
  }

  Expected<std::optional<CameraTrajectory>> ReadCameras(const std::string& video, const VideoInfo& info,
                                                        const std::optional<std::string>& file) const {
    VICTORIOUS_ASSIGN_OR_RETURN(
        std::optional<Telemetry> telemetry,
        LoadTelemetry(video, info, file, options_.telemetry, "nothing will get a place",
                      [&](const std::string& warning) { warn_(fmt::format("{}: {}", video, warning)); }));
    if (!telemetry || telemetry->states.empty()) return std::nullopt;
    return std::optional(CameraTrajectory(std::move(telemetry->states), options_.telemetry.max_gap_s));
  }

  /// Sorts the sightings and sets their bearing observation and place.
  void LocateAll() {
    std::ranges::sort(sightings_, {},
                      [](const BoxSighting& one) { return std::tuple(one.video, one.frame, one.drawn); });
    for (std::size_t drawn = 0; drawn < boxes_.size(); ++drawn) {
      const ObjectType* type = FindObjectType(boxes_[drawn].type);
      std::vector<std::vector<BoxSighting*>> seen(videos_.size());
      for (BoxSighting& sighting : sightings_) {
        if (sighting.drawn != drawn) continue;
        const auto camera = CameraAt(sighting);
        if (!camera) continue;
        const auto recognition = static_cast<std::int64_t>(sighting.video * boxes_.size() + drawn + 1);
        sighting.observation =
            MakeBoxBearingObservation(sighting.extent, sizes_[sighting.video], *camera, type, recognition);
        if (sighting.observation) seen[sighting.video].push_back(&sighting);
      }
      const BoxMotion motion = ClassifyMotion(drawn, type, seen[0]);
      // The ground point constrains the place only if the object is on the ground: a type that does not fly, or an
      // untyped object that leaves its ground point.
      const bool can_fly = CanFly(type);
      const std::optional<ObjectGround> given = can_fly ? std::nullopt : GivenGround();
      const bool on_spot = type != nullptr ? !can_fly : motion == BoxMotion::kMoving;
      const std::optional<ObjectGround> ground = given || !on_spot ? given : EstimateGround(drawn);
      SetPlaces(seen[0], motion, ground);
      const bool stands = motion != BoxMotion::kMoving && !seen[0].empty() && seen[0].front()->place &&
                          !seen[0].front()->place->IsMoving();
      std::vector<BoxSighting*> all;
      for (const auto& of_video : seen) all.insert(all.end(), of_video.begin(), of_video.end());
      if (stands && all.size() > seen[0].size()) SetPlaces(all, BoxMotion::kStatic, ground);
      for (std::size_t video = 1; video < seen.size() && !stands; ++video) SetPlaces(seen[video], motion, given);
    }
  }

  /// Classifies the motion by the largest distance of the box from the ground point on which it was drawn, over the
  /// box's longer side. Tall objects and box jitter cause small distances also for static objects.
  [[nodiscard]] BoxMotion ClassifyMotion(std::size_t drawn, const ObjectType* type,
                                         const std::vector<BoxSighting*>& seen) const {
    if (type != nullptr && type->is_static) return BoxMotion::kStatic;
    constexpr double kMoving = 1;
    constexpr double kStaticDistance = 0.5;
    constexpr double kMaxOutlierFraction = 0.05;  // fraction of outlier boxes ignored, at least three
    std::vector<double> away;
    for (const BoxSighting* sighting : seen) {
      const auto spot = ground_points_[drawn].find(sighting->frame);
      if (spot == ground_points_[drawn].end() || TouchesImageBorder(sighting->box, sizes_[0])) continue;
      const Box& box = sighting->extent;
      const Eigen::Vector2d centre(box.x + box.width / 2, box.y + box.height / 2);
      away.push_back((centre - spot->second.place).norm() / std::max(box.width, box.height));
    }
    const std::size_t outliers =
        std::max<std::size_t>(3, static_cast<std::size_t>(kMaxOutlierFraction * std::ssize(away)));
    if (away.size() <= outliers) return BoxMotion::kUnknown;
    std::ranges::nth_element(away, away.end() - 1 - static_cast<std::ptrdiff_t>(outliers));
    const double farthest = *(away.end() - 1 - static_cast<std::ptrdiff_t>(outliers));
    if (farthest > kMoving) return BoxMotion::kMoving;
    return farthest < kStaticDistance && 2 * away.size() > seen.size() ? BoxMotion::kStatic : BoxMotion::kUnknown;
  }

  [[nodiscard]] std::optional<CameraState> CameraAt(const BoxSighting& sighting) const {
    const std::optional<CameraTrajectory>& cameras = cameras_[sighting.video];
    return cameras ? cameras->At(sighting.time_s) : std::nullopt;
  }

  [[nodiscard]] std::optional<ObjectGround> GivenGround() const {
    if (!given_ground_) return std::nullopt;
    return ObjectGround{given_ground_, options_.place.locate.ground_sigma_m};
  }

  /// Ground at the ground point on which the box was drawn.
  [[nodiscard]] std::optional<ObjectGround> EstimateGround(std::size_t drawn) const {
    if (!cameras_[0]) return std::nullopt;
    std::vector<GroundPointObservation> spots;
    for (const auto& [frame, spot] : ground_points_[drawn]) spots.push_back(spot);
    const std::optional<Geolocation> place = LocateGroundPoint(spots, *cameras_[0], sizes_[0], options_.place);
    return place ? std::optional(ObjectGround::AtPlace(*place)) : std::nullopt;
  }

  /// Warns if the place is far from the given ground: the lines of sight override the ground.
  void WarnOfGround(const Sightings& sightings) const {
    if (!given_ground_) return;
    constexpr double kFarSigmas = 3;
    for (std::size_t drawn = 0; drawn < boxes_.size(); ++drawn) {
      if (CanFly(FindObjectType(boxes_[drawn].type))) continue;
      const auto seen = std::ranges::find_if(
          sightings, [&](const BoxSighting& one) { return one.drawn == drawn && one.place.has_value(); });
      if (seen == sightings.end()) continue;
      const GeodeticPoint& point = seen->place->point;
      const std::optional<double> ground_m = given_ground_->HeightAt(point);
      const double sigma_m = std::sqrt(seen->place->covariance_enu_m2(2, 2)) + options_.place.locate.ground_sigma_m;
      if (!ground_m || std::abs(point.altitude_m - *ground_m) <= kFarSigmas * sigma_m) continue;
      warn_(
          fmt::format("{}: its lines of sight intersect at {:.1f} m, but the given ground is at {:.1f} m there: the "
                      "ground is ignored",
                      BoxName(drawn), point.altitude_m, *ground_m));
    }
  }

  /// Reason why an object has no place; empty if it has one.
  [[nodiscard]] std::string PlaceFailure(std::size_t drawn, const Sightings& sightings) const {
    const auto of_it = [&](const BoxSighting& one) { return one.drawn == drawn; };
    const auto any = [&](const auto& what) {
      return std::ranges::any_of(sightings, [&](const BoxSighting& one) { return of_it(one) && what(one); });
    };
    if (any([](const BoxSighting& one) { return one.place.has_value(); })) return "";
    if (any([](const BoxSighting& one) { return one.observation.has_value(); })) {
      return given_ground_
                 ? "its lines of sight do not determine its distance, and do not meet the given ground"
                 : "its lines of sight do not determine its distance: give --ground METRES, --terrain FILE or "
                   "--type WORD";
    }
    if (std::ranges::none_of(cameras_, [](const auto& one) { return one.has_value(); })) {
      return "no telemetry with camera position, attitude and field of view: give --telemetry FILE; `victorious doctor "
             "VIDEO` reports what is missing";
    }
    if (any([&](const BoxSighting& one) { return CameraAt(one).has_value(); })) {
      return "telemetry lacks camera position, attitude or field of view while the object is visible; `victorious "
             "doctor VIDEO` reports what is missing";
    }
    const auto first = std::ranges::find_if(sightings, of_it);
    const auto last = std::ranges::find_if(sightings.rbegin(), sightings.rend(), of_it);
    return fmt::format("telemetry has no state from {:.2f} to {:.2f} s, while the object is visible", first->time_s,
                       last->time_s);
  }

  void SetPlaces(const std::vector<BoxSighting*>& seen, BoxMotion motion,
                 const std::optional<ObjectGround>& ground) const {
    std::vector<BearingObservation> observations;
    for (const BoxSighting* sighting : seen) observations.push_back(*sighting->observation);
    const auto places = EstimateBoxPlaces(observations, motion, ground, options_.place);
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i]->place = places[i];
  }

  /// Static objects, from their sightings in the first video.
  [[nodiscard]] std::vector<std::optional<StaticBox>> FindStaticBoxes() const {
    std::vector<std::optional<StaticBox>> standing(boxes_.size());
    for (const UserBoxTarget& target : targets_) {
      const auto seen = std::ranges::find_if(sightings_, [&](const BoxSighting& one) {
        return one.video == 0 && one.drawn == target.drawn && one.frame == target.frame;
      });
      if (seen == sightings_.end() || !seen->place || seen->place->IsMoving()) continue;
      standing[target.drawn] = {*seen->place, target.box, *CameraAt(*seen)};
    }
    return standing;
  }

  template <typename Visit>
  Status ReadAll(VideoReader& reader, const std::string& name, const Visit& visit) const {
    Progress progress(name, reader.info().frame_count, "frames");
    while (true) {
      VICTORIOUS_RETURN_IF_ERROR(CheckCancelled(cancel_));
      VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Frame> frame, reader.NextFrame());
      if (!frame) break;
      VICTORIOUS_RETURN_IF_ERROR(visit(*frame));
      progress.Update(frame->index + 1);
    }
    for (const std::string& warning : reader.warnings()) warn_(name + ": " + warning);
    return {};
  }

  std::span<const std::string> videos_;
  std::span<const UserBox> boxes_;
  const TrackBoxesOptions& options_;
  const CancelToken& cancel_;
  const WarningSink& warn_;
  std::shared_ptr<const Ground> given_ground_;  // or null
  std::unique_ptr<const FeatureExtractor> extractor_;
  std::vector<std::optional<CameraTrajectory>> cameras_;  // by video
  std::vector<cv::Size> sizes_;                           // frame sizes, by video
  std::vector<double> times_s_;                           // time stamps of the first video's frames
  std::vector<UserBoxTarget> targets_;
  Sightings sightings_;
  std::vector<std::map<std::int64_t, GroundPointObservation>>
      ground_points_;  // of the first video, by user box and frame
};

}  // namespace

void TrackBoxesOptions::ListFields(FieldList& fields) {
  fields.AddGroup("box", box);
  fields.AddGroup("telemetry", telemetry);
  fields.AddGroup("place", place);
  fields.AddGroup("ground", ground);
  fields.Add("recognize_every", recognize_every,
             {.min = 1,
              .max = 100'000,
              .unit = "frames",
              .reason = "interval at which a lost object is searched for by its keypoints: costs as much as tracking "
                        "some ten frames"});
  fields.Add("memory_mb", memory_mb,
             {.min = 1,
              .max = 1'000'000,
              .unit = "MiB",
              .reason = "memory for the frames of the backward pass: less reads the video more often"});
  fields.AddGroup("model", model);
  fields.AddGroup("recognize", recognize);
}

Expected<TrackedBoxes> TrackBoxes(std::span<const std::string> videos, std::span<const UserBox> boxes,
                                  const std::optional<std::string>& telemetry, const TrackBoxesOptions& options,
                                  const CancelToken& cancel, const WarningSink& warn) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (videos.empty() || boxes.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "nothing to track: give a video and a box in it");
  }
  return BoxTrackingRun(videos, boxes, options, cancel, warn).Run(telemetry);
}

}  // namespace victorious
