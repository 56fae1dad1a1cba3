#include "victorious/jobs/index/track_growth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/stage_time.h"
#include "victorious/jobs/known_views.h"
#include "victorious/track/surround_tracker.h"

namespace victorious {

void GrowOptions::ListFields(FieldList& fields) {
  fields.Add(
      "enabled", enabled,
      {.reason = "what photos recognised is followed through the video by its surroundings and colours, and views "
                 "from other sides are learnt from it; files only"});
  fields.Add(
      "max_lost_s", max_lost_s,
      {.min = 0,
       .max = 3600,
       .unit = "s",
       .reason = "time without evidence after which its colours alone no longer prove that an object is there; after "
                 "twice that it is followed no further"});
}

namespace {

constexpr double kSearchSpacing_s = 0.3;  // between two searches for known views
constexpr int kSearchSpacing = 4;         // steps, likewise, while there is evidence
constexpr double kStep_s = 0.15;          // between two frames that are looked at; in between, boxes are interpolated
constexpr double kGap_s = 0.3;            // the shortest time without a sighting that is looked at

// What is known of the objects in the frames, stored or grown.
struct KnownBox {
  std::int64_t tracklet = 0;
  Box box;
  bool is_recognised = false;
  bool is_grown = false;
};

// Follows the tracklets of one model. A sweep goes through the video in one direction.
class TrackGrower {
 public:
  TrackGrower(const GrowthVideo& video, const GrowthInput& input) : video_(&video), input_(&input) {
    for (const SightingRecord& sighting : input.sightings) {
      known_[sighting.frame].push_back({.tracklet = sighting.tracklet,
                                        .box = sighting.box,
                                        .is_recognised = sighting.source == SightingSource::kRecognised});
    }
    std::vector<const TrackletRecord*> tracklets;
    for (const TrackletRecord& tracklet : input.tracklets) tracklets.push_back(&tracklet);
    std::ranges::sort(tracklets, {}, [](const TrackletRecord* one) { return std::pair(one->first_time_s, one->id); });
    for (const TrackletRecord* tracklet : tracklets) {
      const SightingRecord* const best = BestRecognition(*tracklet);
      if (best == nullptr) continue;
      followed_.push_back({.anchor = best,
                           .gaps_ends = {EndOfGaps(*best, 1), EndOfGaps(*best, -1)},
                           .chain = ViewChain(input.model, input.recognize),
                           .walk = {}});
    }
  }

  void BeginSweep(std::int64_t direction) {
    direction_ = direction;
    for (Followed& one : followed_) {
      End(one);
      one.is_over = one.is_unfit || one.GapsEnd(direction) == one.anchor->frame;
    }
  }

  // The next frame of the sweep, from `from` on, that is needed; std::nullopt: none is.
  [[nodiscard]] std::optional<std::int64_t> NextFrame(std::int64_t from) const {
    std::optional<std::int64_t> next;
    for (const Followed& one : followed_) {
      const std::int64_t first = one.walk ? one.anchor->frame + direction_ : one.anchor->frame;
      const std::int64_t frame = IsBefore(first, from) ? from : first;
      const bool is_needed = !one.is_over && IsInReach(frame, one);
      if (is_needed && (!next || IsBefore(frame, *next))) next = frame;
    }
    return next;
  }

  // True for a frame in which a tracklet begins to be followed.
  [[nodiscard]] bool BeginsAt(std::int64_t frame) const {
    return std::ranges::any_of(
        followed_, [&](const Followed& one) { return !one.is_over && !one.walk && one.anchor->frame == frame; });
  }

  // The last frame of the sweep that may be needed.
  [[nodiscard]] std::int64_t LastFrame() const {
    std::int64_t last = direction_ > 0 ? 0 : video_->end - 1;
    for (const Followed& one : followed_) {
      if (one.is_over) continue;
      const std::int64_t end = one.GapsEnd(direction_).value_or(direction_ > 0 ? video_->end - 1 : 0);
      if (IsBefore(last, end)) last = end;
    }
    return last;
  }

  // Frames come in the order of the sweep.
  Status Enter(const Frame& frame, const SurroundFrame& image) {
    for (Followed& one : followed_) {
      if (one.is_over) continue;
      if (one.walk) {
        const bool is_next = IsBefore(one.anchor->frame, frame.index) && IsGrowthStep(video_->times_s, frame.index);
        if (is_next && IsInReach(frame.index, one)) VICTORIOUS_RETURN_IF_ERROR(Follow(frame, image, one));
      } else if (frame.index == one.anchor->frame) {
        VICTORIOUS_RETURN_IF_ERROR(Begin(image, one));
      }
      if (one.is_over) End(one);
    }
    return {};
  }

  // Joins what has met, unless two of a group share a frame: those are two objects.
  [[nodiscard]] TrackGrowth TakeResult() {
    std::map<std::int64_t, std::int64_t> group_of;
    std::map<std::int64_t, std::set<std::int64_t>> frames_of;  // with stored sightings
    for (const TrackletRecord& tracklet : input_->tracklets) group_of[tracklet.id] = tracklet.id;
    for (const SightingRecord& sighting : input_->sightings) frames_of[sighting.tracklet].insert(sighting.frame);
    for (const Meeting& meeting : met_) {
      const std::int64_t low = std::min(group_of.at(meeting.tracklet), group_of.at(meeting.other));
      const std::int64_t high = std::max(group_of.at(meeting.tracklet), group_of.at(meeting.other));
      if (low == high) continue;
      const std::set<std::int64_t>& frames = frames_of[low];
      if (std::ranges::any_of(frames_of[high], [&](std::int64_t frame) { return frames.contains(frame); })) continue;
      frames_of[low].insert(frames_of[high].begin(), frames_of[high].end());
      for (auto& [tracklet, group] : group_of) group = group == high ? low : group;
    }
    TrackGrowth growth;
    for (const Followed& one : followed_) {
      const std::size_t first = growth.views.size();
      for (LearntView view : one.chain.views()) {
        if (view.parent) *view.parent += first;
        growth.views.push_back(std::move(view));
      }
    }
    for (const auto& [tracklet, group] : group_of) {
      if (tracklet != group) growth.joined.emplace_back(group, tracklet);
    }
    std::ranges::stable_sort(grown_, {}, &GrownSighting::frame);
    for (GrownSighting& sighting : grown_) {
      sighting.tracklet = group_of.at(sighting.tracklet);
      if (frames_of[sighting.tracklet].insert(sighting.frame).second) growth.sightings.push_back(std::move(sighting));
    }
    return growth;
  }

 private:
  // A tracklet as it is followed in one direction.
  struct Walk {
    SurroundTracker tracker;
    double probability = 1;  // of the chain, at the last recognition
    double evidence_s = 0;   // time of the last frame with evidence
    double searched_s = 0;
    int steps = 0;                          // since the last search
    std::optional<GrownSighting> previous;  // at the last step, if there was evidence; stored or not
    int contradictions = 0;                 // in a row, of the tracklet's own recognitions
    std::vector<std::int64_t> unconfirmed;  // frames that it has added since its last own recognition that agreed
    std::size_t confirmed_views = 0;        // views of the chain until then
    FeatureSet witness;                     // features of the last region in which a view was recognised
    Box witness_box;
    std::optional<std::size_t> parent;  // the view that was recognised or learnt last
    int max_matches = 0;                // of it so far
  };

  // A tracklet that is followed from its best recognition.
  struct Followed {
    const SightingRecord* anchor = nullptr;
    // The frames behind which it lacks nothing, forward and backward; std::nullopt: it ends while it is in view.
    std::array<std::optional<std::int64_t>, 2> gaps_ends;
    ViewChain chain;
    std::optional<Walk> walk;  // from the frame of the anchor on
    bool is_over = false;      // in this sweep
    bool is_unfit = false;     // its colours are those around it

    [[nodiscard]] const std::optional<std::int64_t>& GapsEnd(std::int64_t direction) const {
      return gaps_ends[direction > 0 ? 0 : 1];
    }
  };

  // Two tracklets whose objects stand at one place in a frame.
  struct Meeting {
    std::int64_t tracklet = 0;
    std::int64_t other = 0;
    std::int64_t frame = 0;
    bool is_grown = false;  // the other's sighting
    auto operator<=>(const Meeting&) const = default;
  };

  // In the order of the sweep.
  [[nodiscard]] bool IsBefore(std::int64_t a, std::int64_t b) const { return (b - a) * direction_ > 0; }

  [[nodiscard]] const SightingRecord* BestRecognition(const TrackletRecord& tracklet) const {
    const SightingRecord* best = nullptr;
    int count = 0;
    for (const SightingRecord& one : input_->sightings) {
      if (one.tracklet != tracklet.id || one.source != SightingSource::kRecognised) continue;
      ++count;
      if (best == nullptr || std::pair(one.score, one.matches) > std::pair(best->score, best->matches)) best = &one;
    }
    const bool is_strong =
        best != nullptr && count >= input_->options.min_recognitions && best->score >= input_->options.min_score;
    return is_strong ? best : nullptr;
  }

  // The frame behind which a tracklet lacks nothing, in one direction: it has sightings until the video ends or the
  // object leaves the frame. std::nullopt: it ends while its object is in view.
  [[nodiscard]] std::optional<std::int64_t> EndOfGaps(const SightingRecord& anchor, std::int64_t direction) const {
    std::vector<const SightingRecord*> own;
    for (const SightingRecord& one : input_->sightings) {
      if (one.tracklet == anchor.tracklet && (one.frame - anchor.frame) * direction >= 0) own.push_back(&one);
    }
    if (direction < 0) std::ranges::reverse(own);
    const SightingRecord& last = *own.back();
    const bool leaves = IsAtBorder(last.box, video_->frame);
    const bool is_at_end = last.frame + direction < 0 || last.frame + direction >= video_->end;
    if (!leaves && !is_at_end) return std::nullopt;
    std::int64_t end = anchor.frame;
    for (std::size_t i = 1; i < own.size(); ++i) {
      const bool is_gap =
          std::abs(own[i]->frame - own[i - 1]->frame) > 1 && std::abs(own[i]->time_s - own[i - 1]->time_s) > kGap_s;
      if (is_gap) end = own[i]->frame;
    }
    return end;
  }

  // In the frame of the anchor.
  Status Begin(const SurroundFrame& image, Followed& one) {
    const SightingRecord& anchor = *one.anchor;
    SurroundTracker tracker(image, anchor.outline);
    one.is_unfit = !tracker.first();
    one.is_over = one.is_unfit;
    if (one.is_unfit) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(FeatureSet region, FeaturesAround(image.grey, anchor.box, input_->extractor));
    one.walk.emplace(Walk{.tracker = std::move(tracker),
                          .evidence_s = anchor.time_s,
                          .searched_s = anchor.time_s,
                          .previous = {},
                          .unconfirmed = {},
                          .confirmed_views = one.chain.views().size(),
                          .witness = std::move(region),
                          .witness_box = anchor.box,
                          .parent = {},
                          .max_matches = anchor.matches});
    return {};
  }

  // Frees what only a walk needs: a video may have many tracklets.
  static void End(Followed& one) {
    one.walk.reset();
    one.chain.Rest();
  }

  // True if a frame is looked at: not so far beyond the last evidence that the object is given up before.
  [[nodiscard]] bool IsInReach(std::int64_t frame, const Followed& one) const {
    if (frame < 0 || frame >= video_->end) return false;
    const std::optional<std::int64_t>& gaps_end = one.GapsEnd(direction_);
    if (gaps_end && IsBefore(*gaps_end, frame)) return false;
    const double time_s = video_->times_s[static_cast<std::size_t>(frame)];
    const double evidence_s = one.walk ? one.walk->evidence_s : one.anchor->time_s;
    return std::abs(time_s - evidence_s) <= 2 * input_->options.max_lost_s;
  }

  Status Follow(const Frame& frame, const SurroundFrame& image, Followed& one) {
    Walk& walk = *one.walk;
    const std::int64_t tracklet = one.anchor->tracklet;
    const std::optional<SurroundStep> step = walk.tracker.Step(image);
    if (!step) {
      one.is_over = true;
      return {};
    }
    if (step->moves_over_ground) {
      Drop(one);
      return {};
    }
    const Box box = Intersection(step->box, FrameBox(frame.image.cols, frame.image.rows));
    const std::vector<KnownBox>& known = known_[frame.index];
    const auto own = std::ranges::find(known, tracklet, &KnownBox::tracklet);
    const bool has_own = own != known.end();
    if (has_own && own->is_recognised) Compare(own->box, box, one);
    if (one.is_over) return {};
    const bool is_contrasting =
        step->contrast >= kMinContrast && std::abs(frame.time_s - walk.evidence_s) <= input_->options.max_lost_s;
    VICTORIOUS_ASSIGN_OR_RETURN(const int matches, Search(frame, image.grey, *step, box, is_contrasting, one));
    const bool is_plausible = has_own || !input_->is_plausible || input_->is_plausible(tracklet, frame.index, box);
    if (is_plausible && (is_contrasting || matches > 0)) {
      walk.evidence_s = frame.time_s;
      const auto other = std::ranges::find_if(known, [&](const KnownBox& there) {
        return there.tracklet != tracklet && IntersectionOverUnion(there.box, box) >= kMinViewOverlap;
      });
      if (other != known.end()) {
        met_.insert({tracklet, other->tracklet, frame.index, other->is_grown});
        one.is_over = true;
        return {};
      }
      const double support = matches > 0 ? 1.0 : std::min(1.0, step->contrast);
      GrownSighting now{.tracklet = tracklet,
                        .frame = frame.index,
                        .box = box,
                        .outline = step->outline,
                        .score = one.anchor->score * walk.probability * support,
                        .matches = matches};
      if (walk.previous) AddBetween(*walk.previous, now, walk);
      Add(now, walk);
      walk.previous = std::move(now);
    } else {
      walk.previous.reset();
    }
    return {};
  }

  // The tracklet's own recognition in a frame agrees, or contradicts. Several in a row, not one, end the walk: a single
  // recognition may have a wrong outline. What the walk has added since they agreed goes: the object moves by itself.
  void Compare(const Box& recognised, const Box& box, Followed& one) {
    constexpr int kMaxContradictions = 2;
    Walk& walk = *one.walk;
    if (IntersectionOverUnion(recognised, box) >= kMinViewOverlap) {
      walk.contradictions = 0;
      walk.unconfirmed.clear();
      walk.confirmed_views = one.chain.views().size();
      return;
    }
    if (++walk.contradictions > kMaxContradictions) Drop(one);
  }

  // Ends a walk, and removes what it has added since the last recognition that agreed.
  void Drop(Followed& one) {
    one.is_over = true;
    const std::int64_t tracklet = one.anchor->tracklet;
    const std::vector<std::int64_t>& frames = one.walk->unconfirmed;
    std::erase_if(grown_, [&](const GrownSighting& grown) {
      return grown.tracklet == tracklet && std::ranges::find(frames, grown.frame) != frames.end();
    });
    std::erase_if(met_, [&](const Meeting& meeting) {
      return meeting.is_grown && meeting.other == tracklet && std::ranges::find(frames, meeting.frame) != frames.end();
    });
    one.chain.Forget(one.walk->confirmed_views);
    for (const std::int64_t frame : frames) {
      std::erase_if(known_[frame], [&](const KnownBox& known) { return known.is_grown && known.tracklet == tracklet; });
    }
  }

  // Adds a sighting where the tracklet has none.
  void Add(const GrownSighting& sighting, Walk& walk) {
    std::vector<KnownBox>& known = known_[sighting.frame];
    if (std::ranges::find(known, sighting.tracklet, &KnownBox::tracklet) != known.end()) return;
    grown_.push_back(sighting);
    known.push_back({.tracklet = sighting.tracklet, .box = sighting.box, .is_grown = true});
    walk.unconfirmed.push_back(sighting.frame);
  }

  // The same in the frames between two steps.
  void AddBetween(const GrownSighting& from, const GrownSighting& to, Walk& walk) {
    const std::int64_t direction = to.frame > from.frame ? 1 : -1;
    for (std::int64_t frame = from.frame + direction; frame != to.frame; frame += direction) {
      const double part = static_cast<double>(frame - from.frame) / static_cast<double>(to.frame - from.frame);
      const auto between = [&](double a, double b) { return a + part * (b - a); };
      GrownSighting sighting{.tracklet = to.tracklet,
                             .frame = frame,
                             .box = {between(from.box.x, to.box.x), between(from.box.y, to.box.y),
                                     between(from.box.width, to.box.width), between(from.box.height, to.box.height)},
                             .outline = {},
                             .score = std::min(from.score, to.score),
                             .matches = 0};
      for (const Eigen::Vector2d& point : from.outline) {
        const Box& box = sighting.box;
        sighting.outline.emplace_back(box.x + (point.x() - from.box.x) * box.width / from.box.width,
                                      box.y + (point.y() - from.box.y) * box.height / from.box.height);
      }
      Add(sighting, walk);
    }
  }

  // Looks for the views of the chain, and learns one where they are found no more or hardly. Returns the matches of
  // what is found.
  Expected<int> Search(const Frame& frame, const cv::Mat& grey, const SurroundStep& step, const Box& box,
                       bool is_contrasting, Followed& one) {
    Walk& walk = *one.walk;
    ViewChain& chain = one.chain;
    ++walk.steps;
    if (is_contrasting && walk.steps < kSearchSpacing) return 0;
    if (std::abs(frame.time_s - walk.searched_s) < kSearchSpacing_s) return 0;
    walk.steps = 0;
    walk.searched_s = frame.time_s;
    VICTORIOUS_ASSIGN_OR_RETURN(FeatureSet region, FeaturesAround(grey, box, input_->extractor));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<ViewChain::Found> found, chain.Find(region, box));
    if (found && found->view != walk.parent) walk.max_matches = 0;
    if (found) {
      walk.parent = found->view;
      walk.probability = found->view ? chain.views()[*found->view].probability : 1;
      walk.max_matches = std::max(walk.max_matches, found->matches);
    }
    const bool is_well_found = found && found->matches >= kWeakMatches * walk.max_matches;
    bool is_learnt = false;
    if (is_contrasting && !is_well_found) {
      LearntView view{.frame = frame.index, .box = box, .outline = step.outline, .parent = walk.parent};
      double score = found ? found->score : 0;
      if (!found) {
        VICTORIOUS_ASSIGN_OR_RETURN(score, chain.ScoreIn(walk.witness, walk.witness_box, view, region));
      }
      view.probability = walk.probability * score;
      is_learnt = chain.Learn(view, region);
      if (is_learnt) {
        walk.parent = chain.views().size() - 1;
        walk.probability = view.probability;
        walk.max_matches = 0;
      }
    }
    if (found || is_learnt) {
      walk.witness = std::move(region);
      walk.witness_box = box;
    }
    return found ? found->matches : 0;
  }

  const GrowthVideo* video_;
  const GrowthInput* input_;
  std::map<std::int64_t, std::vector<KnownBox>> known_;  // by frame
  std::vector<Followed> followed_;                       // in the order of their tracklets' time
  std::int64_t direction_ = 1;                           // of the sweep
  std::vector<GrownSighting> grown_;
  std::set<Meeting> met_;
};

// Goes through the video in one direction, as far as something is followed.
Status Sweep(const GrowthVideo& video, std::int64_t direction, const CancelToken& cancel,
             std::vector<TrackGrower>& growers) {
  for (TrackGrower& grower : growers) grower.BeginSweep(direction);
  const auto next_frame = [&](std::int64_t from) {
    std::optional<std::int64_t> next;
    for (const TrackGrower& grower : growers) {
      const std::optional<std::int64_t> of_grower = grower.NextFrame(from);
      if (of_grower && (!next || (*next - *of_grower) * direction > 0)) next = of_grower;
    }
    return next;
  };
  const auto is_wanted = [&](std::int64_t frame) {
    return IsGrowthStep(video.times_s, frame) ||
           std::ranges::any_of(growers, [&](const TrackGrower& grower) { return grower.BeginsAt(frame); });
  };
  std::optional<std::int64_t> at = next_frame(direction > 0 ? 0 : video.end - 1);
  while (at) {
    std::int64_t end = *at;
    for (const TrackGrower& grower : growers) {
      const std::int64_t of_grower = grower.LastFrame();
      if ((of_grower - end) * direction > 0) end = of_grower;
    }
    std::int64_t last = *at;
    for (std::int64_t wanted = 1; last != end && wanted < video.max_wanted; last += direction) {
      if (is_wanted(last + direction)) ++wanted;
    }
    VICTORIOUS_ASSIGN_OR_RETURN(std::vector<Frame> frames,
                                video.read(std::min(*at, last), std::max(*at, last) + 1, is_wanted));
    if (direction < 0) std::ranges::reverse(frames);
    for (const Frame& frame : frames) {
      if (cancel.IsCancelled())
        return Fail(ErrorCode::kCancelled, "interrupted while objects were followed: the next run does this part anew");
      if (frame.image.type() != CV_8UC3 || next_frame(frame.index) != frame.index) continue;
      const SurroundFrame image(frame.image);
      std::vector<Status> entered(growers.size());
      oneapi::tbb::this_task_arena::isolate([&] {  // else a waiting thread could take other work of the process
        oneapi::tbb::parallel_for(std::size_t{0}, growers.size(), [&](std::size_t i) {
          const StageScope scope(Stage::kTracking);
          entered[i] = growers[i].Enter(frame, image);
        });
      });
      for (Status& status : entered) VICTORIOUS_RETURN_IF_ERROR(std::move(status));
    }
    at = next_frame(last + direction);
  }
  return {};
}

}  // namespace

bool IsGrowthStep(std::span<const double> times_s, std::int64_t frame) {
  const auto slot = [&](std::int64_t of) {
    return std::floor((times_s[static_cast<std::size_t>(of)] + kSameTime_s) / kStep_s);
  };
  return frame == 0 || frame + 1 == std::ssize(times_s) || slot(frame) != slot(frame - 1);
}

Expected<std::vector<TrackGrowth>> GrowTracks(const GrowthVideo& video, std::span<const GrowthInput> inputs,
                                              const CancelToken& cancel) {
  std::vector<TrackGrower> growers;
  for (const GrowthInput& input : inputs) growers.emplace_back(video, input);
  for (const std::int64_t direction : {1, -1}) VICTORIOUS_RETURN_IF_ERROR(Sweep(video, direction, cancel, growers));
  std::vector<TrackGrowth> growths;
  for (TrackGrower& grower : growers) growths.push_back(grower.TakeResult());
  return growths;
}

}  // namespace victorious
