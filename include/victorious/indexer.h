// The main job: a video is searched for models, what is found is tracked, placed on Earth by the telemetry, and stored.
//
//   Indexer indexer(ModelLibrary("models").LoadAll());
//   IndexReport report = indexer.Index("flight.mp4", "index.db");
//
// It is the same work as `victorious index`, with the same defaults, and gives the same index.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <victorious/export.h>
#include <victorious/model.h>
#include <victorious/progress.h>

namespace libvictorious {

struct IndexerSettings {
  /// File of a category model (`victorious category train`) or an imported detector; empty: none.
  std::string categories;
  /// "fast", "normal" or "thorough"; empty: normal.
  std::string quality;
  /// JSON object of parameters, or a preset's name; empty: the defaults. Names, units and ranges: `victorious params
  /// index`.
  std::string params;
  /// The camera's full horizontal field of view, degrees, above 0 and below 180; std::nullopt: as telemetry says.
  std::optional<double> hfov_deg;
  WarningCallback warn;  ///< while the indexer is made
};

/// One video, and how it is searched.
struct IndexJob {
  /// A telemetry file; empty: the video's own, or a file beside it.
  std::string telemetry;
  std::optional<double> from_s;  ///< only frames at this time or later, s since the first frame
  std::optional<double> to_s;    ///< only frames up to this time
  bool redo = false;             ///< deletes the results that the index has of these models, and searches again
  int threads = 0;               ///< 0: one a processor
  ProgressCallback progress;
  WarningCallback warn;
};

struct IndexReport {
  bool has_telemetry = false;        ///< else nothing gets a place
  std::int64_t frames_searched = 0;  ///< as a whole, by this call; 0 if all was searched before
  std::int64_t sightings = 0;        ///< found by this call
};

/// Searches videos, one after the other, for a set of models. Used by one thread at a time; can be moved, not copied.
class LIBVICTORIOUS_EXPORT Indexer {
 public:
  /// Errors: kInvalidArgument for nothing to search for, parameters out of range, models of different feature engines,
  /// or two targets of one name; those of reading the categories.
  explicit Indexer(const std::vector<Model>& models, const IndexerSettings& settings = {});
  Indexer(Indexer&& other) noexcept;
  Indexer& operator=(Indexer&& other) noexcept;
  ~Indexer();

  /// Indexes one video into a database, which is created if it does not exist. Goes on where an earlier call stopped.
  /// One indexer serves one index.
  /// @param video  a file, a folder of images or a URL
  /// @param index  a SQLite file, or postgresql://USER@HOST/DATABASE
  /// Errors: those of Video and of a telemetry file that is given; kInvalidArgument if the index has results with other
  /// parameters (IndexJob::redo); kConflict if another process indexes the same video; kCancelled; kNoSpace;
  /// kUnavailable.
  IndexReport Index(const std::string& video, const std::string& index, const IndexJob& job = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace libvictorious
