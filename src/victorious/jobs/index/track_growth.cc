#include "victorious/jobs/index/track_growth.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "victorious/object/model/model_builder.h"
#include "victorious/search/follow/region_features.h"
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

constexpr double kMinGrowthOverlap = 0.3;  // IoU of boxes that are one object's
constexpr double kSearchSpacing_s = 0.3;   // between two searches for known views
constexpr int kSearchSpacing = 4;          // steps, likewise, while there is evidence
constexpr double kStep_s = 0.15;           // between two frames that are looked at; in between, boxes are interpolated
constexpr double kRegionMargin = 0.35;     // around the box in which keypoints are searched for, over its sides
constexpr std::size_t kMinViewFeatures = 8;  // of a learnt view
constexpr std::size_t kRecentViews = 8;      // learnt views that are searched for, beside the photos
constexpr std::size_t kMaxLearntViews = 60;
constexpr double kWeakMatches = 0.5;     // of the most that a view had: it is at the end of its reach
constexpr double kMinProbability = 0.5;  // of a view that is learnt

Box Widened(const Box& box, double fraction) {
  return {box.x - fraction * box.width, box.y - fraction * box.height, (1 + 2 * fraction) * box.width,
          (1 + 2 * fraction) * box.height};
}

FeatureSet FeaturesOn(const FeatureSet& features, const Polygon& outline) {
  FeatureSet inside{.keypoints = {},
                    .descriptors = {},
                    .image_width = features.image_width,
                    .image_height = features.image_height,
                    .part = {}};
  std::vector<cv::Point2f> corners;
  for (const Eigen::Vector2d& corner : outline)
    corners.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Keypoint& keypoint = features.keypoints[i];
    if (cv::pointPolygonTest(corners, {keypoint.x, keypoint.y}, false) >= 0)
      AppendFeature(keypoint, features, i, inside);
  }
  return inside;
}

// A model of views without pictures, as ModelBuilder makes it.
class ViewModel {
 public:
  void Add(ModelView view, const FeatureView& features) {
    view.thumbnail = {};
    view.surface = {};
    view.first_feature = features_->size();
    view.feature_count = features.size();
    features_->keypoints.insert(features_->keypoints.end(), features.keypoints.begin(), features.keypoints.end());
    features_->descriptors.insert(features_->descriptors.end(), features.descriptors.begin(),
                                  features.descriptors.end());
    views_.push_back(std::move(view));
  }

  // @param of  the model that it stands for
  ObjectModel Finish(const ObjectModel& of) && {
    ObjectModel model = of;
    model.id = {};
    model.views = std::move(views_);
    model.features = features_->View();
    model.storage = std::move(features_);
    return model;
  }

 private:
  std::vector<ModelView> views_;
  std::shared_ptr<FeatureSet> features_ = std::make_shared<FeatureSet>();
};

// What is known of the objects in the frames, stored or grown.
struct KnownBox {
  std::int64_t tracklet = 0;
  Box box;
  bool is_recognised = false;
  bool is_grown = false;
};

// The photos of a model and the views that were learnt, as models that can be searched for.
class ViewChain {
 public:
  struct Found {
    int matches = 0;
    std::optional<std::size_t> view;  // learnt; std::nullopt: a photo
    double score = 0;
  };

  static Expected<ViewChain> Create(const GrowthInput& input) {
    ViewChain chain(input);
    VICTORIOUS_RETURN_IF_ERROR(chain.Rebuild());
    return chain;
  }

  // The best view of the chain in features of a region, if its box agrees with `box`.
  Expected<std::optional<Found>> Find(const FeatureSet& region, const Box& box) const {
    if (region.keypoints.empty()) return std::nullopt;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Detection> detections, recognizer_->Recognize(region));
    for (const Detection& detection : detections) {
      if (IntersectionOverUnion(detection.box, box) < kMinGrowthOverlap) continue;
      const std::size_t photos = input_->model.views.size();
      return Found{.matches = static_cast<int>(detection.fit.inliers.size()),
                   .view = detection.view < photos ? std::nullopt : std::optional(first_ + detection.view - photos),
                   .score = detection.score};
    }
    return std::nullopt;
  }

  // The score with which a view is found where an older one was recognised; 0: it is not.
  // @param region   features of the region around the view
  // @param witness  features of a region in which a view of the chain was recognised, in `witness_box`
  Expected<double> ScoreIn(const FeatureSet& witness, const Box& witness_box, const LearntView& view,
                           const FeatureSet& region) const {
    const FeatureSet features = FeaturesOn(region, view.outline);
    if (features.size() < kMinViewFeatures) return 0;
    ViewModel alone;
    alone.Add(ViewOf(view, features), features.View());
    VICTORIOUS_ASSIGN_OR_RETURN(
        const Recognizer recognizer,
        Recognizer::Create({std::move(alone).Finish(input_->model)}, input_->model.engine, input_->recognize));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Detection> detections, recognizer.Recognize(witness));
    const bool is_there =
        !detections.empty() && IntersectionOverUnion(detections.front().box, witness_box) >= kMinGrowthOverlap;
    return is_there ? detections.front().score : 0;
  }

  // Learns a view, unless its probability is too low. Returns whether it has.
  Expected<bool> Learn(const LearntView& view, const FeatureSet& region) {
    FeatureSet features = FeaturesOn(region, view.outline);
    if (features.size() < kMinViewFeatures || views_.size() >= kMaxLearntViews) return false;
    if (view.probability < kMinProbability) return false;
    views_.push_back(view);
    features_.push_back(std::move(features));
    VICTORIOUS_RETURN_IF_ERROR(Rebuild());
    return true;
  }

  [[nodiscard]] const std::vector<LearntView>& views() const { return views_; }

 private:
  explicit ViewChain(const GrowthInput& input) : input_(&input) {}

  static ModelView ViewOf(const LearntView& view, const FeatureSet& features) {
    return {.source = {},
            .width = features.image_width,
            .height = features.image_height,
            .outline = view.outline,
            .angles = {},
            .neighbours = {},
            .thumbnail = {},
            .surface = {}};
  }

  Status Rebuild() {
    ViewModel all;
    const ObjectModel& model = input_->model;
    for (std::size_t view = 0; view < model.views.size(); ++view) all.Add(model.views[view], model.ViewFeatures(view));
    first_ = views_.size() - std::min(views_.size(), kRecentViews);
    for (std::size_t i = first_; i < views_.size(); ++i) all.Add(ViewOf(views_[i], features_[i]), features_[i].View());
    VICTORIOUS_ASSIGN_OR_RETURN(Recognizer made,
                                Recognizer::Create({std::move(all).Finish(model)}, model.engine, input_->recognize));
    recognizer_.emplace(std::move(made));
    return {};
  }

  const GrowthInput* input_;
  std::vector<LearntView> views_;
  std::vector<FeatureSet> features_;  // of the views
  std::size_t first_ = 0;             // of the learnt views that are searched for
  std::optional<Recognizer> recognizer_;
};

class TrackGrower {
 public:
  TrackGrower(const GrowthInput& input, const ReadFrames& read, std::int64_t block, const CancelToken& cancel)
      : input_(input), read_(read), block_(std::max<std::int64_t>(1, block)), cancel_(cancel) {
    for (const SightingRecord& sighting : input.sightings) {
      known_[sighting.frame].push_back({.tracklet = sighting.tracklet,
                                        .box = sighting.box,
                                        .is_recognised = sighting.source == SightingSource::kRecognised});
    }
  }

  Expected<TrackGrowth> Run() {
    std::vector<const TrackletRecord*> tracklets;
    for (const TrackletRecord& tracklet : input_.tracklets) tracklets.push_back(&tracklet);
    std::ranges::sort(tracklets, {}, [](const TrackletRecord* one) { return std::pair(one->first_time_s, one->id); });
    for (const TrackletRecord* tracklet : tracklets) {
      const SightingRecord* const best = BestRecognition(*tracklet);
      if (best != nullptr) VICTORIOUS_RETURN_IF_ERROR(Grow(*best));
    }
    return Result();
  }

 private:
  // The object as it is followed in one direction.
  struct Walk {
    std::int64_t tracklet = 0;
    double score = 0;
    double probability = 1;  // of the chain, at the last recognition
    double evidence_s = 0;   // time of the last frame with evidence
    double searched_s = 0;
    int steps = 0;                          // since the last search
    std::optional<GrownSighting> previous;  // at the last step, if there was evidence; stored or not
    int contradictions = 0;                 // in a row, of the tracklet's own recognitions
    std::vector<std::int64_t> unconfirmed;  // frames that it has added since its last own recognition that agreed
    FeatureSet witness;                     // features of the last region in which a view was recognised
    Box witness_box;
    std::optional<std::size_t> parent;  // the view that was recognised or learnt last
    int max_matches = 0;                // of it so far
    bool is_over = false;
  };

  const SightingRecord* BestRecognition(const TrackletRecord& tracklet) const {
    const SightingRecord* best = nullptr;
    int count = 0;
    for (const SightingRecord& one : input_.sightings) {
      if (one.tracklet != tracklet.id || one.source != SightingSource::kRecognised) continue;
      ++count;
      if (best == nullptr || std::pair(one.score, one.matches) > std::pair(best->score, best->matches)) best = &one;
    }
    const bool is_strong =
        best != nullptr && count >= input_.options.min_recognitions && best->score >= input_.options.min_score;
    return is_strong ? best : nullptr;
  }

  Status Grow(const SightingRecord& anchor) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Frame> first, read_(anchor.frame, anchor.frame + 1));
    if (first.size() != 1 || first.front().image.type() != CV_8UC3) return {};
    const cv::Mat& image = first.front().image;
    const SurroundTracker start(image, anchor.outline);
    if (!start.first()) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(ViewChain chain, ViewChain::Create(input_));
    VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet region, RegionFeatures(image, anchor.box));
    for (const int direction : {1, -1}) {
      Walk walk{.tracklet = anchor.tracklet,
                .score = anchor.score,
                .evidence_s = anchor.time_s,
                .searched_s = anchor.time_s,
                .previous = {},
                .unconfirmed = {},
                .witness = region,
                .witness_box = anchor.box,
                .parent = {},
                .max_matches = anchor.matches};
      SurroundTracker tracker = start;
      std::int64_t next = anchor.frame + direction;
      while (!walk.is_over && IsInReach(next, walk)) {
        std::int64_t last = next;
        while (std::abs(last - next) + 1 < block_ && IsInReach(last + direction, walk)) last += direction;
        VICTORIOUS_ASSIGN_OR_RETURN(std::vector<Frame> frames, read_(std::min(next, last), std::max(next, last) + 1));
        if (direction < 0) std::ranges::reverse(frames);
        for (const Frame& frame : frames) {
          if (cancel_.IsCancelled()) return Fail(ErrorCode::kCancelled, "interrupted while it followed what it found");
          VICTORIOUS_RETURN_IF_ERROR(Enter(frame, tracker, chain, walk));
          if (walk.is_over) break;
        }
        next = last + direction;
      }
    }
    views_.insert(views_.end(), chain.views().begin(), chain.views().end());
    return {};
  }

  // True if a frame is not so far beyond the last evidence that the object is given up before.
  bool IsInReach(std::int64_t frame, const Walk& walk) const {
    if (frame < 0 || frame >= input_.end) return false;
    const double time_s = input_.times_s[static_cast<std::size_t>(frame)];
    return std::abs(time_s - walk.evidence_s) <= 2 * input_.options.max_lost_s;
  }

  Expected<FeatureSet> RegionFeatures(const cv::Mat& bgr, const Box& box) const {
    cv::Mat grey;
    cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
    return FeaturesIn(grey, Widened(box, kRegionMargin), input_.extractor);
  }

  Status Enter(const Frame& frame, SurroundTracker& tracker, ViewChain& chain, Walk& walk) {
    if (!IsGrowthStep(input_.times_s, frame.index)) return {};
    const std::optional<SurroundStep> step = tracker.Step(frame.image);
    if (!step) {
      walk.is_over = true;
      return {};
    }
    if (step->moves_over_ground) {
      Drop(walk);
      return {};
    }
    const Box box = Intersection(step->box, FrameBox(frame.image.cols, frame.image.rows));
    const std::vector<KnownBox>& known = known_[frame.index];
    const auto own = std::ranges::find(known, walk.tracklet, &KnownBox::tracklet);
    const bool has_own = own != known.end();
    if (has_own && own->is_recognised) Compare(own->box, box, walk);
    if (walk.is_over) return {};
    const bool is_contrasting =
        step->contrast >= kMinContrast && std::abs(frame.time_s - walk.evidence_s) <= input_.options.max_lost_s;
    VICTORIOUS_ASSIGN_OR_RETURN(const int matches, Search(frame, box, step->outline, is_contrasting, chain, walk));
    const bool is_plausible = has_own || !input_.is_plausible || input_.is_plausible(walk.tracklet, frame.index, box);
    if (is_plausible && (is_contrasting || matches > 0)) {
      walk.evidence_s = frame.time_s;
      const auto other = std::ranges::find_if(known, [&](const KnownBox& one) {
        return one.tracklet != walk.tracklet && IntersectionOverUnion(one.box, box) >= kMinGrowthOverlap;
      });
      if (other != known.end()) {
        met_.emplace(walk.tracklet, other->tracklet);
        walk.is_over = true;
        return {};
      }
      const double support = matches > 0 ? 1.0 : std::min(1.0, step->contrast);
      GrownSighting now{.tracklet = walk.tracklet,
                        .frame = frame.index,
                        .box = box,
                        .outline = step->outline,
                        .score = walk.score * walk.probability * support,
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
  void Compare(const Box& recognised, const Box& box, Walk& walk) {
    constexpr int kMaxContradictions = 2;
    if (IntersectionOverUnion(recognised, box) >= kMinGrowthOverlap) {
      walk.contradictions = 0;
      walk.unconfirmed.clear();
      return;
    }
    if (++walk.contradictions > kMaxContradictions) Drop(walk);
  }

  // Ends a walk, and removes what it has added since the last recognition that agreed.
  void Drop(Walk& walk) {
    walk.is_over = true;
    const auto is_of_walk = [&](std::int64_t frame) {
      return std::ranges::find(walk.unconfirmed, frame) != walk.unconfirmed.end();
    };
    std::erase_if(grown_,
                  [&](const GrownSighting& one) { return one.tracklet == walk.tracklet && is_of_walk(one.frame); });
    for (const std::int64_t frame : walk.unconfirmed) {
      std::erase_if(known_[frame], [&](const KnownBox& one) { return one.is_grown && one.tracklet == walk.tracklet; });
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
  Expected<int> Search(const Frame& frame, const Box& box, const Polygon& outline, bool is_contrasting,
                       ViewChain& chain, Walk& walk) {
    ++walk.steps;
    if (is_contrasting && walk.steps < kSearchSpacing) return 0;
    if (std::abs(frame.time_s - walk.searched_s) < kSearchSpacing_s) return 0;
    walk.steps = 0;
    walk.searched_s = frame.time_s;
    VICTORIOUS_ASSIGN_OR_RETURN(FeatureSet region, RegionFeatures(frame.image, box));
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
      LearntView view{.frame = frame.index, .box = box, .outline = outline, .parent = walk.parent};
      double score = found ? found->score : 0;
      if (!found) {
        VICTORIOUS_ASSIGN_OR_RETURN(score, chain.ScoreIn(walk.witness, walk.witness_box, view, region));
      }
      view.probability = walk.probability * score;
      VICTORIOUS_ASSIGN_OR_RETURN(is_learnt, chain.Learn(view, region));
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

  // Joins what has met, unless two of a group share a frame: those are two objects.
  Expected<TrackGrowth> Result() {
    std::map<std::int64_t, std::int64_t> group_of;
    std::map<std::int64_t, std::set<std::int64_t>> frames_of;  // with stored sightings
    for (const TrackletRecord& tracklet : input_.tracklets) group_of[tracklet.id] = tracklet.id;
    for (const SightingRecord& sighting : input_.sightings) frames_of[sighting.tracklet].insert(sighting.frame);
    for (const auto& [a, b] : met_) {
      const std::int64_t low = std::min(group_of.at(a), group_of.at(b));
      const std::int64_t high = std::max(group_of.at(a), group_of.at(b));
      if (low == high) continue;
      const std::set<std::int64_t>& frames = frames_of[low];
      if (std::ranges::any_of(frames_of[high], [&](std::int64_t frame) { return frames.contains(frame); })) continue;
      frames_of[low].insert(frames_of[high].begin(), frames_of[high].end());
      for (auto& [tracklet, group] : group_of) group = group == high ? low : group;
    }
    TrackGrowth growth;
    growth.views = std::move(views_);
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

  const GrowthInput& input_;
  const ReadFrames& read_;
  std::int64_t block_;
  const CancelToken& cancel_;
  std::map<std::int64_t, std::vector<KnownBox>> known_;  // by frame
  std::vector<GrownSighting> grown_;
  std::set<std::pair<std::int64_t, std::int64_t>> met_;
  std::vector<LearntView> views_;
};

}  // namespace

bool IsGrowthStep(std::span<const double> times_s, std::int64_t frame) {
  const auto slot = [&](std::int64_t of) {
    return std::floor((times_s[static_cast<std::size_t>(of)] + kSameTime_s) / kStep_s);
  };
  return frame == 0 || frame + 1 == std::ssize(times_s) || slot(frame) != slot(frame - 1);
}

Expected<TrackGrowth> GrowTracks(const GrowthInput& input, const ReadFrames& read, std::int64_t block,
                                 const CancelToken& cancel) {
  return TrackGrower(input, read, block, cancel).Run();
}

}  // namespace victorious
