// Fits that are kept in the store between runs (store/: KeptFit), so that a run makes only those that are new. A fit
// depends on the sightings of its tracklets, the errors of their flights, and some parameters. Its key is the checksum
// of
//
//   the program, the parameters, and for each tracklet: id, revision, frames, score, times, the kind of its model, the
//   errors of its flight
//
// A key that is found therefore has the fit that would be made anew, to the last bit. Only the sightings of tracklets
// without kept fits, and of those that take part in a new fit, are read. docs/adr/0023-kept-fits.md says more.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/place/associate/fits.h"
#include "victorious/place/associate/flight_errors.h"
#include "victorious/place/associate/object_rejection.h"
#include "victorious/place/associate/packed_fit.h"
#include "victorious/store/index_store.h"

namespace victorious {

class KeptFits final : public Fits {
 public:
  /// When new fits are stored before the run ends.
  struct Interim {
    std::chrono::milliseconds interval{10'000};  ///< so much of the work is lost at most if the process is killed
    const CancelToken& cancel;                   ///< stops the run, with kCancelled, when it has just stored them
  };

  /// Reads the kept fits of the store, which must outlive it, as must the token. Errors: those of the store.
  [[nodiscard]] static Expected<std::unique_ptr<KeptFits>> Load(const ObjectOptions& options, IndexStore& store,
                                                                const Interim& interim);

  /// Adds the tracklets of one video. Sets their summaries; estimates what is not kept, in parallel.
  /// @param tracklets  by id, without content; must outlive it, at their place
  /// Errors: those of the store.
  [[nodiscard]] Status AddFlight(std::span<ObservedTracklet> tracklets);

  /// Of all flights.
  [[nodiscard]] const std::vector<TrackletOverlap>& overlaps() const { return overlaps_; }
  [[nodiscard]] const std::map<std::int64_t, FlightErrors>& errors() const { return errors_; }

  // After a failure of the store they return an estimate without a place; see status().
  [[nodiscard]] ObjectPlace Relative(const ObjectHypothesis& hypothesis) override;
  [[nodiscard]] ObjectPlace Absolute(const ObjectHypothesis& hypothesis) override;
  [[nodiscard]] LevelPlace OnLevel(const ObjectHypothesis& hypothesis, const Level& level) override;
  [[nodiscard]] std::vector<Geolocation> Path(const ObjectHypothesis& hypothesis) override;
  [[nodiscard]] const std::vector<std::int64_t>& Frames(const ObservedTracklet& tracklet) override;

  /// The first error of reading sightings or paths, and of storing fits.
  [[nodiscard]] const Status& status() const { return status_; }

  /// Adds the fits that were made since they were stored last, and the keys of the kept ones that nobody asked for.
  void AddChanges(ObjectUpdate& update) const;

 private:
  struct Entry {
    std::vector<std::byte> bytes;  ///< as stored; emptied once unpacked
    std::optional<HypothesisFits> fits;
    std::vector<std::byte> path;  ///< to be stored
    bool is_stored = false;
    bool is_used = false;
    bool is_changed = false;
  };
  struct KeyHash {
    std::size_t operator()(const FitKey& key) const { return static_cast<std::size_t>(key.key ^ (key.tracklet << 1)); }
  };
  struct Known {
    ObservedTracklet* tracklet = nullptr;
    std::int64_t key = 0;    ///< of its content
    Entry* entry = nullptr;  ///< of it alone, from AddFlight on
    bool has_content = false;
  };

  KeptFits(const ObjectOptions& options, IndexStore& store, const Interim& interim, std::optional<std::string> context);

  [[nodiscard]] FitKey KeyOf(const ObjectHypothesis& hypothesis) const;
  [[nodiscard]] Entry& EntryOf(const FitKey& key);
  [[nodiscard]] Entry& EntryOf(const ObjectHypothesis& hypothesis);
  void DropContent();
  [[nodiscard]] Status ReadContent(const SightingFilter& filter);
  /// Reads the sightings of a tracklet, and corrects them.
  [[nodiscard]] Status ReadTracklet(Known& known);
  /// False after a failure.
  bool EnsureContent(const ObjectHypothesis& hypothesis);
  /// Notes a fit that was made.
  void Note(const FitKey& key, Entry& entry);
  /// Stores those noted if the interval is over. The error is that of status().
  void StoreIfDue();
  [[nodiscard]] Status StoreNoted();
  void MakeSingle(const ObservedTracklet& tracklet, const RangeComparison& comparison, Entry& entry) const;

  using Clock = std::chrono::steady_clock;

  IndexStore& store_;
  Interim interim_;
  Clock::time_point stored_ = Clock::now();  ///< when fits were stored last
  std::vector<FitKey> noted_;                ///< made since then
  std::optional<std::string> context_;       ///< the program and the parameters; std::nullopt: fits are not kept
  std::unordered_map<FitKey, Entry, KeyHash> entries_;
  std::unordered_map<std::int64_t, Known> known_;  ///< by tracklet
  std::map<std::int64_t, FlightErrors> errors_;    ///< by video
  std::vector<TrackletOverlap> overlaps_;
  Status status_;
  std::int64_t recognitions_ = 0;
  std::int64_t content_ = 0;  ///< sightings held
};

}  // namespace victorious
