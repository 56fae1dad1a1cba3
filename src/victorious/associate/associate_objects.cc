#include "victorious/associate/associate_objects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/median.h"
#include "victorious/associate/object_place.h"
#include "victorious/observe/bearing_observation.h"

namespace victorious {
namespace {

// Tracklets merged into one object hypothesis.
struct Thing {
  std::vector<const SeenRun*> runs;  // by id
  ObjectPlace where;                 // place for the comparison with others of its flight
};

std::vector<Sight> SightsOf(const Thing& thing) {
  std::vector<Sight> sights;
  for (const SeenRun* run : thing.runs) sights.insert(sights.end(), run->sights.begin(), run->sights.end());
  std::ranges::stable_sort(sights, {}, [](const Sight& sight) { return sight.line.time_s; });
  return sights;
}

bool InOneVideo(const Thing& thing) {
  return std::ranges::all_of(thing.runs,
                             [&](const SeenRun* run) { return run->record.video == thing.runs[0]->record.video; });
}

// Videos have no common clock, so an object of several videos is modelled as static.
ObjectPlace PlaceOf(const Thing& thing, ObjectOptions options, double common_share) {
  if (!InOneVideo(thing)) options.locate.motion = "static";
  return PlaceOf(SightsOf(thing), options, common_share);
}

bool ShareAFrame(const SeenRun& a, const SeenRun& b) {
  if (a.record.video != b.record.video) return false;
  std::vector<std::int64_t> both;
  std::ranges::set_intersection(a.frames, b.frames, std::back_inserter(both));
  return !both.empty();
}

bool ShareAFrame(const Thing& a, const Thing& b) {
  return std::ranges::any_of(a.runs, [&](const SeenRun* of_a) {
    return std::ranges::any_of(b.runs, [&](const SeenRun* of_b) { return ShareAFrame(*of_a, *of_b); });
  });
}

bool ShareAVideo(const Thing& a, const Thing& b) {
  return std::ranges::any_of(a.runs, [&](const SeenRun* of_a) {
    return std::ranges::any_of(b.runs, [&](const SeenRun* of_b) { return of_a->record.video == of_b->record.video; });
  });
}

double FirstTime(const Thing& thing) {
  double first_s = std::numeric_limits<double>::infinity();
  for (const SeenRun* run : thing.runs) first_s = std::min(first_s, run->record.first_time_s);
  return first_s;
}

double LastTime(const Thing& thing) {
  double last_s = -std::numeric_limits<double>::infinity();
  for (const SeenRun* run : thing.runs) last_s = std::max(last_s, run->record.last_time_s);
  return last_s;
}

// Distance of two hypotheses at the time midway between them: Euclidean and Mahalanobis.
struct Distance {
  double metres = 0;
  double sigmas = 0;
};

std::optional<Distance> DistanceOf(const Thing& a, const Thing& b, const ObjectOptions& options) {
  std::optional<Place> of_a = a.where.place;
  std::optional<Place> of_b = b.where.place;
  if (!ShareAVideo(a, b) || !InOneVideo(a) || !InOneVideo(b)) {  // flights have independent common errors
    of_a = PlaceOf(a, options, 1).place;
    of_b = PlaceOf(b, options, 1).place;
    if (!of_a || !of_b || of_a->Moves() || of_b->Moves()) return std::nullopt;
  }
  if (!of_a || !of_b) return std::nullopt;
  const bool a_first = FirstTime(a) <= FirstTime(b);
  const double between_s = (LastTime(a_first ? a : b) + FirstTime(a_first ? b : a)) / 2;
  const TangentPlane plane(of_a->point);
  const Place at_a = At(*of_a, between_s);
  const Place at_b = At(*of_b, between_s);
  const double slack_m2 = 2 * options.identity_slack_m * options.identity_slack_m;
  const Eigen::Matrix3d covariance =
      at_a.covariance_enu_m2 + at_b.covariance_enu_m2 + slack_m2 * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d apart = plane.EnuFromGeodetic(at_b.point) - plane.EnuFromGeodetic(at_a.point);
  return Distance{apart.norm(), std::sqrt(apart.dot(covariance.ldlt().solve(apart)))};
}

Thing Joined(const Thing& a, const Thing& b, const ObjectOptions& options) {
  Thing joined{.runs = a.runs};
  joined.runs.insert(joined.runs.end(), b.runs.begin(), b.runs.end());
  std::ranges::sort(joined.runs, {}, [](const SeenRun* run) { return run->record.id; });
  joined.where = PlaceOf(joined, options, InOneVideo(joined) ? options.flight_share : 1);
  return joined;
}

// Agglomerative merging of the hypotheses of one model, nearest pair (Mahalanobis) first, until no pair passes the
// gates.
void Join(std::vector<Thing>& things, const ObjectOptions& options) {
  using Pair = std::pair<std::int64_t, std::int64_t>;  // first tracklet ids of two hypotheses
  std::map<Pair, double> distances;
  const auto id_of = [](const Thing& thing) { return thing.runs[0]->record.id; };
  const auto measure = [&](const Thing& a, const Thing& b) {
    if (ShareAFrame(a, b)) return;
    const std::optional<Distance> distance = DistanceOf(a, b, options);
    if (!distance || distance->metres > options.identity_farthest_m) return;
    if (distance->sigmas <= options.identity_gate_sigma) distances[std::minmax(id_of(a), id_of(b))] = distance->sigmas;
  };
  for (std::size_t i = 0; i < things.size(); ++i) {
    for (std::size_t k = i + 1; k < things.size(); ++k) measure(things[i], things[k]);
  }
  while (!distances.empty()) {
    const Pair nearest = std::ranges::min_element(distances, {}, [](const auto& entry) {
                           return std::pair(entry.second, entry.first);
                         })->first;
    const auto a = std::ranges::find(things, nearest.first, id_of);
    const auto b = std::ranges::find(things, nearest.second, id_of);
    Thing joined = Joined(*a, *b, options);
    if (!joined.where.place || joined.where.agreeing < options.least_agreeing) {
      distances.erase(nearest);
      continue;
    }
    std::erase_if(distances, [&](const auto& entry) {
      const auto& [first, second] = entry.first;
      return first == nearest.first || first == nearest.second || second == nearest.first || second == nearest.second;
    });
    *a = std::move(joined);
    const std::int64_t id = id_of(*a);
    things.erase(b);
    const Thing& grown = *std::ranges::find(things, id, id_of);
    for (const Thing& other : things) {
      if (&other != &grown) measure(grown, other);
    }
  }
}

// Number of frames in which another tracklet covers the same pixels (intersection over union).
std::int64_t FramesCovered(const SeenRun& run, const SeenRun& by, double least_overlap) {
  if (run.record.video != by.record.video) return 0;
  std::int64_t covered = 0;
  auto other = by.frames.begin();
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    other = std::lower_bound(other, by.frames.end(), run.frames[i]);
    if (other == by.frames.end()) break;
    if (*other != run.frames[i]) continue;
    const Box& box = by.boxes[static_cast<std::size_t>(other - by.frames.begin())];
    if (IntersectionOverUnion(run.boxes[i], box) >= least_overlap) ++covered;
  }
  return covered;
}

std::int64_t FramesOf(const ObjectRecord& object, const std::map<std::int64_t, const SeenRun*>& runs) {
  std::int64_t frames = 0;
  for (const std::int64_t run : object.runs) frames += runs.at(run)->record.frames;
  return frames;
}

// True if `a` has more frames; ties go to the smaller id, the object seen first.
bool IsSeenMore(const ObjectRecord& a, const ObjectRecord& b, const std::map<std::int64_t, const SeenRun*>& runs) {
  return std::pair(FramesOf(a, runs), -a.id) > std::pair(FramesOf(b, runs), -b.id);
}

// Median height, per video, of the objects whose place follows from intersection and not from apparent size only.
class Heights {
 public:
  void Add(const Thing& thing, double altitude_m) {
    for (const SeenRun* run : thing.runs) of_video_[run->record.video].push_back(altitude_m);
  }
  [[nodiscard]] std::optional<double> Usual(const Thing& thing) const {
    const auto found = of_video_.find(thing.runs[0]->record.video);
    if (found == of_video_.end()) return std::nullopt;
    return Median(found->second);
  }

 private:
  std::map<std::int64_t, std::vector<double>> of_video_;
};

double LogOdds(double score) {
  constexpr double kSurest = 1 - 1e-12;
  const double share = std::clamp(score, 1 - kSurest, kSurest);
  return std::log(share / (1 - share));
}

// A contrario test. A score p is the probability that a detection is right if there is an object, with odds p / (1 -
// p). The expected number of false detections with odds above x is about 1/x of that with even odds (`false_share` per
// frame and model), and they last one frame. An object in n consistent frames is therefore n times less likely to be
// false. Its odds are those of a typical frame, exp(mean of the log odds): the maximum over n frames would be biased.
bool IsFaint(const Thing& thing, std::int64_t frames_searched, const ObjectOptions& options) {
  double log_odds = 0;
  double recognised = 0;
  double frames = 0;
  for (const SeenRun* run : thing.runs) {
    frames += static_cast<double>(run->record.frames);
    for (const double score : run->scores) {
      log_odds += LogOdds(score);
      ++recognised;
    }
  }
  if (recognised > 0) log_odds /= recognised;
  if (thing.where.place) frames = std::max(1.0, frames * thing.where.borne_out);
  constexpr double kMostByChance = 0.1;  // maximum expected number of false detections as strong, over the whole search
  const double even_by_chance = options.false_share * static_cast<double>(frames_searched);
  return std::exp(log_odds) * frames * kMostByChance < even_by_chance;
}

// The lowest land is the shore of the Dead Sea, about 440 m below sea level.
bool LiesBelowAnyGround(const Place& place) {
  constexpr double kLowestGround_m = -500;
  constexpr double kSigmas = 2;
  return place.point.altitude_m + kSigmas * std::sqrt(place.covariance_enu_m2(2, 2)) < kLowestGround_m;
}

std::string WhyNone(const ObjectPlace& where, std::size_t sights, const ObjectOptions& options) {
  constexpr std::size_t kFewestToDisagree = 3;
  if (where.place && LiesBelowAnyGround(*where.place)) {
    return fmt::format("{:.0f} m below the sea, below any ground", -where.place->point.altitude_m);
  }
  if (where.too_large &&
      (*where.too_large > options.scale_allowance || *where.too_large < 1 / options.scale_allowance)) {
    return *where.too_large > 1 ? fmt::format("{:.1f} times too large for its distance", *where.too_large)
                                : fmt::format("{:.1f} times too small for its distance", 1 / *where.too_large);
  }
  if (sights >= kFewestToDisagree && where.agreeing < options.least_agreeing)
    return "its lines of sight do not intersect";
  return {};
}

// Rejects an object whose height follows from its size only and is far from the median height.
void RejectFloating(const Thing& thing, const Heights& heights, const ObjectOptions& options, ObjectRecord& object) {
  if (thing.where.too_large || !object.place || !object.rejected.empty() || thing.runs[0]->of_category) return;
  const std::optional<double> usual_m = heights.Usual(thing);
  if (!usual_m) return;
  const double above_m = object.place->point.altitude_m - *usual_m;
  if (std::abs(above_m) < options.floating_m) return;
  object.rejected = fmt::format("{:.0f} m {} the other objects, judged by its size only", std::abs(above_m),
                                above_m > 0 ? "above" : "below");
}

// Rejects the less-observed of two CAD objects in the same pixels: one would occlude the other.
void RejectCovered(std::vector<ObjectRecord>& objects, const std::map<std::int64_t, const SeenRun*>& runs,
                   const ObjectOptions& options) {
  for (ObjectRecord& less : objects) {
    if (!less.rejected.empty() || !runs.at(less.id)->of_solid) continue;
    for (const ObjectRecord& more : objects) {
      if (!more.rejected.empty() || more.model == less.model || !runs.at(more.id)->of_solid) continue;
      if (!IsSeenMore(more, less, runs)) continue;
      std::int64_t covered = 0;
      for (const std::int64_t run : less.runs) {
        for (const std::int64_t by : more.runs)
          covered += FramesCovered(*runs.at(run), *runs.at(by), options.same_pixels);
      }
      if (2 * covered < FramesOf(less, runs)) continue;
      less.rejected = fmt::format("in the same pixels as object {}", more.id);
      break;
    }
  }
}

// Rejects the less-observed of two coincident static objects.
void RejectDoubles(std::vector<ObjectRecord>& objects, const std::map<std::int64_t, const SeenRun*>& runs,
                   const ObjectOptions& options) {
  for (ObjectRecord& less : objects) {
    if (!less.place || !less.rejected.empty() || runs.at(less.id)->of_category) continue;
    const TangentPlane plane(less.place->point);
    for (const ObjectRecord& more : objects) {
      if (!more.place || !more.rejected.empty() || more.id == less.id || runs.at(more.id)->of_category) continue;
      if (!IsSeenMore(more, less, runs)) continue;
      if (less.place->Moves() || more.place->Moves()) continue;
      if (plane.EnuFromGeodetic(more.place->point).norm() >= options.least_apart_m) continue;
      less.rejected = fmt::format("at the same place as object {}", more.id);
      break;
    }
  }
}

}  // namespace

std::vector<ObjectRecord> MakeObjects(std::vector<SeenRun> runs, std::int64_t frames_searched,
                                      const ObjectOptions& options) {
  std::ranges::sort(runs, {}, [](const SeenRun& run) { return run.record.id; });
  std::map<std::int64_t, const SeenRun*> by_id;
  std::map<std::int64_t, std::vector<Thing>> of_model;
  for (const SeenRun& run : runs) {
    by_id[run.record.id] = &run;
    of_model[run.record.model].push_back({.runs = {&run}, .where = PlaceOf(run.sights, options, options.flight_share)});
  }
  std::vector<Thing> things;
  for (auto& [model, of_one] : of_model) {
    Join(of_one, options);
    std::ranges::move(of_one, std::back_inserter(things));
  }

  std::vector<ObjectRecord> objects;
  Heights heights;
  for (Thing& thing : things) {
    thing.where = PlaceOf(thing, options, 1);
    ObjectRecord object{.id = thing.runs[0]->record.id,
                        .model = thing.runs[0]->record.model,
                        .place = thing.where.place,
                        .heading_rad = thing.where.heading_rad,
                        .rejected = WhyNone(thing.where, SightsOf(thing).size(), options)};
    for (const SeenRun* run : thing.runs) object.runs.push_back(run->record.id);
    if (thing.runs[0]->of_category) {
      if (!std::exchange(object.rejected, {}).empty()) object.place.reset();
    } else if (object.rejected.empty() && IsFaint(thing, frames_searched, options)) {
      object.rejected =
          fmt::format("not significant: as strong a false detection is expected by chance in {} frames of one model",
                      frames_searched);
    }
    if (object.place && object.rejected.empty() && thing.where.too_large) {
      heights.Add(thing, object.place->point.altitude_m);
    }
    objects.push_back(std::move(object));
  }
  for (std::size_t i = 0; i < objects.size(); ++i) RejectFloating(things[i], heights, options, objects[i]);
  RejectCovered(objects, by_id, options);
  RejectDoubles(objects, by_id, options);
  std::ranges::sort(objects, {}, &ObjectRecord::id);
  return objects;
}

namespace {

// Number of frames between two full-frame searches.
std::int64_t StepOf(const SearchRecord& search) {
  const auto options = nlohmann::json::parse(search.options_json, nullptr, /*allow_exceptions=*/false);
  const auto every = options.is_object() ? options.find("every") : options.end();
  return every != options.end() && every->is_number_integer() ? std::max<std::int64_t>(1, *every) : 1;
}

// Number of full-frame searches, summed over videos and models; categories do not count.
Expected<std::int64_t> FramesSearched(const std::vector<ModelRecord>& models, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store.Videos());
  std::int64_t frames = 0;
  for (const VideoRecord& video : videos) {
    for (const ModelRecord& model : models) {
      if (model.IsCategory()) continue;
      VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SearchRecord> search, store.FindSearch(video.id, model.id));
      if (!search) continue;
      const std::int64_t step = StepOf(*search);
      frames += (search->next_frame + step - 1) / step;
    }
  }
  return frames;
}

}  // namespace

Status UpdateObjects(const ObjectOptions& options, IndexStore& store) {
  std::map<std::int64_t, SeenRun> runs;
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<RunRecord> records, store.Runs());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, store.Models());
  for (RunRecord& record : records) {
    const auto model = std::ranges::find(models, record.model, &ModelRecord::id);
    const bool known = model != models.end();
    runs[record.id] = {
        .record = record, .of_category = known && model->IsCategory(), .of_solid = known && model->kind == "cad"};
  }
  std::int64_t recognitions = 0;
  VICTORIOUS_RETURN_IF_ERROR(store.VisitSightings({.rejected_too = true}, [&](SightingRecord&& sighting) {
    const auto run = runs.find(sighting.run);
    if (run == runs.end()) return true;  // added by another process in the meantime
    run->second.frames.push_back(sighting.frame);
    run->second.boxes.push_back(sighting.box);
    if (sighting.source == "recognised") run->second.scores.push_back(sighting.score);
    if (!sighting.sight) return true;
    std::vector<Sight>& sights = run->second.sights;
    sighting.sight->recognition = RecognitionOf(sighting, sights.empty() ? nullptr : &sights.back(), recognitions);
    sights.push_back(*std::move(sighting.sight));
    return true;
  }));
  std::vector<SeenRun> seen;
  for (auto& [id, run] : runs) seen.push_back(std::move(run));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t frames_searched, FramesSearched(models, store));
  return store.PutObjects(MakeObjects(std::move(seen), frames_searched, options));
}

}  // namespace victorious
