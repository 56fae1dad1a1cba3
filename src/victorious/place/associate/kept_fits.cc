#include "victorious/place/associate/kept_fits.h"

#include <algorithm>
#include <bit>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "victorious/base/file.h"
#include "victorious/base/program_id.h"
#include "victorious/place/associate/fit_options.h"
#include "victorious/place/observe/bearing_observation.h"

namespace victorious {
namespace {

// Sightings held at a time, beyond those of one flight or of one fit: some 250 bytes each.
constexpr std::int64_t kMaxContent = 1'000'000;

std::int64_t ChecksumOf(std::string_view text) {
  return std::bit_cast<std::int64_t>(Checksum(std::as_bytes(std::span(text))));
}

// What all fits depend on, but for the content of tracklets. std::nullopt if it cannot be told, so that fits are not
// kept: a ground or the program is not identified.
std::optional<std::string> ContextOf(const ObjectOptions& options) {
  if ((options.ground && options.ground_id.empty()) || options.locate.ground) return std::nullopt;
  const Expected<std::string> program = ProgramId();
  if (!program) return std::nullopt;
  return fmt::format("{} {} {:d} ", *program, FitOptionsText(options), options.ground != nullptr);
}

// With the revision alone, sightings added by an older program, which does not count it, would be missed.
std::string TextOf(const TrackletRecord& record) {
  return fmt::format("{} {} {} {} {} {} {} {} ", record.id, record.video, record.model, record.revision, record.frames,
                     std::bit_cast<std::uint64_t>(record.score), std::bit_cast<std::uint64_t>(record.first_time_s),
                     std::bit_cast<std::uint64_t>(record.last_time_s));
}

std::string TextOf(const ObservedTracklet& tracklet) {
  return fmt::format("{}{:d}{:d}{:d}{:d} ", TextOf(tracklet.record), tracklet.is_category, tracklet.is_cad_model,
                     tracklet.is_of_photos, tracklet.has_filtered_telemetry);
}

std::string TextOf(const std::optional<TelemetryErrors>& errors) {
  if (!errors) return "supposed";
  std::string text = errors->is_receiver_known ? "receiver" : "rows";
  for (const double ratio :
       {errors->position.ratio, errors->attitude.ratio, errors->clock_ratio, errors->focal_ratio}) {
    text += fmt::format(" {}", std::bit_cast<std::uint64_t>(ratio));
  }
  return text;
}

std::string TextOf(const std::vector<LengthError>& lengths) {
  std::string text;
  for (const LengthError& length : lengths)
    text += fmt::format(" {} {}", length.model, std::bit_cast<std::uint64_t>(length.factor));
  return text;
}

std::string TextOf(const FlightErrors& errors) {
  return fmt::format("{} {} {} {} {}{}", errors.heading ? std::bit_cast<std::uint64_t>(errors.heading->error_rad) : 0,
                     errors.focal ? std::bit_cast<std::uint64_t>(errors.focal->log_factor) : 0,
                     errors.focal ? std::bit_cast<std::uint64_t>(errors.focal->sigma_ratio) : 0,
                     errors.range ? std::bit_cast<std::uint64_t>(errors.range->factor) : 0, TextOf(errors.telemetry),
                     TextOf(errors.lengths));
}

ObjectPlace WithoutPath(ObjectPlace place) {
  place.path = {};
  return place;
}

}  // namespace

KeptFits::KeptFits(const ObjectOptions& options, IndexStore& store, const Interim& interim,
                   std::optional<std::string> context)
    : Fits(options), store_(store), interim_(interim), context_(std::move(context)) {}

Expected<std::unique_ptr<KeptFits>> KeptFits::Load(const ObjectOptions& options, IndexStore& store,
                                                   const Interim& interim) {
  std::unique_ptr<KeptFits> fits(new KeptFits(options, store, interim, ContextOf(options)));
  if (!fits->context_) return fits;
  VICTORIOUS_RETURN_IF_ERROR(store.VisitKeptFits([&](KeptFit&& kept) {
    Entry& entry = fits->entries_[kept.key];
    entry.bytes = std::move(kept.fit);
    entry.is_stored = true;
    return true;
  }));
  return fits;
}

FitKey KeptFits::KeyOf(const ObjectHypothesis& hypothesis) const {
  const std::int64_t first = ObjectId(hypothesis);
  if (hypothesis.tracklets.size() == 1) return {first, known_.at(first).key};
  std::string keys;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets)
    keys += fmt::format("{} ", known_.at(tracklet->record.id).key);
  return {first, ChecksumOf(keys)};
}

KeptFits::Entry& KeptFits::EntryOf(const FitKey& key) {
  Entry& entry = entries_[key];
  entry.is_used = true;
  if (!entry.fits) {
    // Bytes that cannot be read are those of no fit.
    entry.fits = UnpackHypothesisFits(std::exchange(entry.bytes, {}));
    if (!entry.fits) entry.fits.emplace();
  }
  return entry;
}

KeptFits::Entry& KeptFits::EntryOf(const ObjectHypothesis& hypothesis) {
  return hypothesis.tracklets.size() == 1 ? *known_.at(ObjectId(hypothesis)).entry : EntryOf(KeyOf(hypothesis));
}

void KeptFits::DropContent() {
  for (auto& [id, known] : known_) {
    if (!std::exchange(known.has_content, false)) continue;
    known.tracklet->frames = {};
    known.tracklet->boxes = {};
    known.tracklet->scores = {};
    known.tracklet->by_shape = 0;
    known.tracklet->missed = 0;
    known.tracklet->views = {};
    known.tracklet->observations = {};
    known.tracklet->observation_frames = {};
  }
  content_ = 0;
}

Status KeptFits::ReadContent(const SightingFilter& filter) {
  return store_.VisitSightings(filter, [&](SightingRecord&& sighting) {
    const auto known = known_.find(sighting.tracklet);
    // Another process may have added it in the meantime.
    if (known == known_.end() || known->second.has_content) return true;
    ObservedTracklet& tracklet = *known->second.tracklet;
    ++content_;
    AddSighting(sighting, tracklet);
    if (!sighting.observation) return true;
    std::vector<BearingObservation>& observations = tracklet.observations;
    sighting.observation->recognition_id =
        NextRecognitionId(sighting, observations.empty() ? nullptr : &observations.back(), recognitions_);
    observations.push_back(*std::move(sighting.observation));
    tracklet.observation_frames.push_back(sighting.frame);
    return true;
  });
}

Status KeptFits::ReadTracklet(Known& known) {
  const TrackletRecord& record = known.tracklet->record;
  VICTORIOUS_RETURN_IF_ERROR(ReadContent({.include_rejected = true, .video = record.video, .tracklet = record.id}));
  known.has_content = true;
  Correct(errors_[record.video], options(), std::span(known.tracklet, 1));
  return {};
}

bool KeptFits::EnsureContent(const ObjectHypothesis& hypothesis) {
  if (content_ > kMaxContent) DropContent();
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) {
    Known& known = known_.at(tracklet->record.id);
    if (!known.has_content && status_) status_ = ReadTracklet(known);
  }
  return status_.has_value();
}

void KeptFits::Note(const FitKey& key, Entry& entry) {
  entry.is_changed = true;
  noted_.push_back(key);
}

void KeptFits::StoreIfDue() {
  if (status_ && Clock::now() - stored_ >= interim_.interval) status_ = StoreNoted();
}

Status KeptFits::StoreNoted() {
  std::vector<KeptFit> fits;
  for (const FitKey& key : noted_) {
    Entry& entry = entries_.at(key);
    if (!std::exchange(entry.is_changed, false)) continue;  // noted twice
    fits.push_back({.key = key, .fit = entry.fits ? Pack(*entry.fits) : entry.bytes, .path = entry.path});
    entry.is_stored = true;
  }
  noted_.clear();
  if (context_ && !fits.empty()) VICTORIOUS_RETURN_IF_ERROR(store_.PutFits(fits));
  stored_ = Clock::now();
  if (!interim_.cancel.IsCancelled()) return {};
  return Fail(ErrorCode::kCancelled,
              "the sightings are stored, the objects not updated: stopped before all of them were placed; run this "
              "again");
}

void KeptFits::MakeSingle(const ObservedTracklet& tracklet, const RangeComparison& comparison, Entry& entry) const {
  const ObjectHypothesis alone{.tracklets = {&tracklet}, .estimate = {}, .absolute = {}};
  // The comparison is one of an object that may move.
  ObjectPlace relative =
      EstimatePlace(alone, options(), kFlightErrorFraction, tracklet.is_of_photos ? RangeComparison() : comparison);
  if (relative.HasPath()) entry.path = Pack(relative.path);
  entry.fits->relative = WithoutPath(std::move(relative));
  entry.fits->absolute = WithoutPath(EstimatePlace(alone, options(), 1));
  entry.fits->tracklet = {.summary = Summarise(tracklet), .frames = tracklet.frames};
}

Status KeptFits::AddFlight(std::span<ObservedTracklet> tracklets) {
  if (tracklets.empty()) return {};
  if (content_ > kMaxContent) DropContent();
  const std::int64_t video = tracklets.front().record.video;
  const std::string context = context_.value_or("");  // the keys of fits that are not kept count in this run only
  std::string flight_text = fmt::format("flight {} ", context);
  std::vector<std::string> texts;
  for (ObservedTracklet& tracklet : tracklets) {
    known_[tracklet.record.id] = {.tracklet = &tracklet};
    flight_text += texts.emplace_back(TextOf(tracklet));
  }
  // What the sightings of the flight as a whole say.
  const FitKey flight_key{tracklets.front().record.id, ChecksumOf(flight_text)};
  Entry& flight_entry = entries_[flight_key];
  flight_entry.is_used = true;
  std::vector<RangeComparison> comparisons;
  std::optional<FlightFits> flight = UnpackFlightFits(flight_entry.bytes);
  if (!flight) {
    VICTORIOUS_RETURN_IF_ERROR(ReadContent({.include_rejected = true, .video = video}));
    std::vector<const ObservedTracklet*> pointers;
    for (const ObservedTracklet& tracklet : tracklets) {
      known_.at(tracklet.record.id).has_content = true;
      pointers.push_back(&tracklet);
    }
    FlightEstimate estimate = CorrectFlight(tracklets, options());
    comparisons = std::move(estimate.comparisons);
    flight = FlightFits{.errors = estimate.errors, .overlaps = FindOverlaps(pointers)};
    flight_entry.bytes = Pack(*flight);
    Note(flight_key, flight_entry);
  }
  errors_[video] = flight->errors;
  overlaps_.insert(overlaps_.end(), flight->overlaps.begin(), flight->overlaps.end());

  struct Missing {
    const ObservedTracklet* tracklet;
    RangeComparison comparison;
    Entry* entry;
  };
  std::vector<Missing> missing;
  const std::string errors_text = TextOf(flight->errors);
  for (std::size_t i = 0; i < tracklets.size(); ++i) {
    ObservedTracklet& tracklet = tracklets[i];
    tracklet.length_factor = LengthFactorOf(flight->errors.lengths, tracklet.record.model);
    Known& known = known_.at(tracklet.record.id);
    known.key = ChecksumOf(context + texts[i] + errors_text);
    Entry& entry = EntryOf({tracklet.record.id, known.key});
    known.entry = &entry;
    if (entry.fits->relative && entry.fits->absolute && entry.fits->tracklet) continue;
    if (!known.has_content) VICTORIOUS_RETURN_IF_ERROR(ReadTracklet(known));
    missing.push_back({&tracklet, comparisons.empty() ? RangeComparison() : comparisons[i], &entry});
  }
  const auto make = [&](std::size_t i) { MakeSingle(*missing[i].tracklet, missing[i].comparison, *missing[i].entry); };
  if (options().ground) {  // its tiles are read as they are needed
    for (std::size_t i = 0; i < missing.size(); ++i) make(i);
  } else {
    oneapi::tbb::parallel_for(std::size_t{0}, missing.size(), make);
  }
  for (const Missing& made : missing) {
    const std::int64_t id = made.tracklet->record.id;
    Note({id, known_.at(id).key}, *made.entry);
  }
  if (!noted_.empty()) StoreIfDue();
  for (ObservedTracklet& tracklet : tracklets)
    tracklet.summary = known_.at(tracklet.record.id).entry->fits->tracklet->summary;
  return status_;
}

ObjectPlace KeptFits::Relative(const ObjectHypothesis& hypothesis) {
  Entry& entry = EntryOf(hypothesis);
  if (entry.fits->relative) return *entry.fits->relative;
  if (!EnsureContent(hypothesis)) return {};
  ObjectPlace place = Fits::Relative(hypothesis);
  if (place.HasPath()) entry.path = Pack(place.path);
  entry.fits->relative = WithoutPath(place);
  Note(KeyOf(hypothesis), entry);
  StoreIfDue();
  return place;
}

ObjectPlace KeptFits::Absolute(const ObjectHypothesis& hypothesis) {
  Entry& entry = EntryOf(hypothesis);
  if (entry.fits->absolute) return *entry.fits->absolute;
  if (!EnsureContent(hypothesis)) return {};
  entry.fits->absolute = WithoutPath(Fits::Absolute(hypothesis));
  Note(KeyOf(hypothesis), entry);
  StoreIfDue();
  return *entry.fits->absolute;
}

LevelPlace KeptFits::OnLevel(const ObjectHypothesis& hypothesis, const Level& level) {
  Entry& entry = EntryOf(hypothesis);
  if (entry.fits->on_level && entry.fits->on_level->level == level) return entry.fits->on_level->place;
  if (!EnsureContent(hypothesis)) return {};
  LevelPlace placed = Fits::OnLevel(hypothesis, level);
  placed.relative = WithoutPath(std::move(placed.relative));
  entry.fits->on_level = {.level = level, .place = std::move(placed)};
  Note(KeyOf(hypothesis), entry);
  StoreIfDue();
  return entry.fits->on_level->place;
}

std::vector<Geolocation> KeptFits::Path(const ObjectHypothesis& hypothesis) {
  const Entry& entry = EntryOf(hypothesis);
  std::optional<std::vector<Geolocation>> path;
  if (!entry.path.empty()) {
    path = UnpackPath(entry.path);
  } else if (entry.is_stored && status_) {
    const Expected<std::vector<std::byte>> bytes = store_.FindKeptPath(KeyOf(hypothesis));
    if (!bytes) {
      status_ = std::unexpected(bytes.error());
      return {};
    }
    path = UnpackPath(*bytes);
  }
  if (path && path->size() == hypothesis.estimate.path_size) return *std::move(path);
  return EnsureContent(hypothesis) ? Fits::Relative(hypothesis).path : std::vector<Geolocation>();
}

const std::vector<std::int64_t>& KeptFits::Frames(const ObservedTracklet& tracklet) {
  return known_.at(tracklet.record.id).entry->fits->tracklet->frames;
}

void KeptFits::AddChanges(ObjectUpdate& update) const {
  if (!context_) return;
  for (const auto& [key, entry] : entries_) {
    if (entry.is_changed) {
      update.put_fits.push_back({.key = key, .fit = entry.fits ? Pack(*entry.fits) : entry.bytes, .path = entry.path});
    } else if (entry.is_stored && !entry.is_used) {
      update.deleted_fits.push_back(key);
    }
  }
  // By tracklet, as they lie in the store.
  std::ranges::sort(update.put_fits, {}, &KeptFit::key);
  std::ranges::sort(update.deleted_fits);
}

}  // namespace victorious
