// store/, in: what a search of videos found. Out: the same, to be listed, exported and searched again. One interface;
// sqlite/ is the implementation that files use, a server database comes behind the same interface.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"
#include "victorious/types/place.h"
#include "victorious/types/sight.h"

namespace victorious {

/// A video that was indexed, known by its content, named by its path as given last.
struct VideoRecord {
  std::int64_t id = 0;  ///< the store's own
  std::string content_id;
  std::string name;
  int width = 0;                             ///< px
  int height = 0;                            ///< px
  std::optional<std::int64_t> frame_count;   ///< known once it was read to its end
  std::optional<double> duration_s;          ///< presentation time of the last frame, known then too
  std::optional<std::int64_t> start_utc_us;  ///< of the first frame, microseconds since 1970, where telemetry tells
  std::string features_json;                 ///< the feature options of the features kept; empty: none kept yet
};

/// ModelRecord::kind of a category.
inline constexpr std::string_view kCategoryKind = "category";

/// What was searched for: a model, or a category.
struct ModelRecord {
  std::int64_t id = 0;
  std::string name;
  std::string model_id;  ///< ObjectModel::id, or that of the category model: the content
  std::string kind;      ///< ObjectModel::kind, or kCategoryKind

  [[nodiscard]] bool IsCategory() const { return kind == kCategoryKind; }
};

/// How far the search for one model in one video has come.
struct SearchRecord {
  std::int64_t video = 0;
  std::int64_t model = 0;
  std::int64_t next_frame = 0;  ///< frames before this one are done
  bool finished = false;        ///< to the video's end
  std::string options_json;     ///< what it was searched with
  std::string program_version;
};

/// A run: sightings of one video that overlap from frame to frame. What an object is made of.
struct RunRecord {
  std::int64_t id = 0;
  std::int64_t object = 0;  ///< of which it is a part
  std::int64_t video = 0;
  std::int64_t model = 0;
  double score = 0;
  std::int64_t frames = 0;  ///< with a sighting
  double first_time_s = 0;
  double last_time_s = 0;
};

/// One object: the runs that show it, in one video or several.
struct ObjectRecord {
  std::int64_t id = 0;  ///< that of its first run
  std::int64_t model = 0;
  double score = 0;                  ///< the highest of its runs
  std::int64_t frames = 0;           ///< with a sighting
  double first_time_s = 0;           ///< of its sightings, each on its own video's clock
  double last_time_s = 0;            ///< likewise
  std::vector<std::int64_t> videos;  ///< that it is seen in, in the order they were added
  std::vector<std::int64_t> runs;    ///< rising
  std::optional<Place> place;
  std::optional<double> heading_rad;  ///< of its front, clockwise from north
  std::string rejected;               ///< why this is no object; empty: it is one
};

struct SightingRecord {
  std::int64_t object = 0;
  std::int64_t run = 0;
  std::int64_t video = 0;
  std::int64_t model = 0;
  std::int64_t frame = 0;
  double time_s = 0;
  Box box;
  Polygon outline;
  double score = 0;
  std::string source = "recognised";
  int matches = 0;
  int view_index = 0;                      ///< the model's view that matched best
  std::optional<ViewAngles> view;          ///< from where it is seen: between views where its points tell that
  double in_plane_rad = 0;                 ///< clockwise turn from a template seen from there to the scene
  std::optional<double> sigma_view_rad;    ///< of the direction of view, each axis; nothing: the matched view's own
  std::optional<double> distance_m;        ///< from the camera; nothing where its field of view is not known
  std::optional<double> sigma_distance_m;  ///< goes with it
  std::optional<std::int64_t> track;  ///< those of a video and model with the same were followed: they are one thing
  std::optional<Sight> sight;         ///< where there is telemetry
};

/// The features of a frame, kept for search by picture.
struct KeptFrame {
  std::int64_t video = 0;
  std::int64_t frame = 0;
  double time_s = 0;
  FeatureSet features;
};

/// What one stretch of frames gave: committed whole or not at all.
struct IndexBatch {
  /// A run that is new (no id), and an object by itself until PutObjects says otherwise, or one that has grown (its
  /// id).
  struct RunUpdate {
    std::optional<std::int64_t> id;
    RunRecord run;
  };
  /// A sighting of the batch's run number `run_update`, which says its run, video and model. A run has at most one
  /// sighting in a frame.
  struct NewSighting {
    std::size_t run_update = 0;
    SightingRecord sighting;
  };
  struct Progress {
    SearchRecord search;                   ///< as it stands after the batch
    std::int64_t expected_next_frame = 0;  ///< as it stood before: refused if another process moved it
  };

  std::vector<RunUpdate> runs;
  std::vector<NewSighting> sightings;
  std::vector<KeptFrame> kept_frames;
  std::vector<Progress> progress;
};

/// About a point of the Earth, whatever the height.
struct Surroundings {
  GeodeticPoint middle;
  double radius_m = 0;
};

/// Which objects or sightings: every condition that is set must hold.
struct SightingFilter {
  std::optional<std::string> model_name;
  std::optional<std::string> category_name;  ///< and the categories within it: "vehicle" for "vehicle/car"
  std::optional<std::string> video_name;     ///< see VideosNamed
  std::optional<double> from_s;              ///< inclusive; an object counts if any of its time does
  std::optional<double> to_s;                ///< inclusive
  std::optional<Surroundings> near;          ///< objects of known place, and their sightings
  bool rejected_too = false;                 ///< else what was rejected as no object is left out
};

/// The videos of that whole name; if there is none, those whose name ends in it part by part: "flight/video.mp4" is the
/// end of "/data/flight/video.mp4", "deo.mp4" is not.
std::vector<VideoRecord> VideosNamed(const std::vector<VideoRecord>& videos, std::string_view name);

/// Not thread-safe: one thread at a time; other processes may read while one writes.
class IndexStore {
 public:
  virtual ~IndexStore() = default;

  /// Adds the video, or finds it by its content and gives it the name as now given, and the start if given.
  virtual Expected<VideoRecord> PutVideo(const VideoRecord& video) = 0;
  /// Forgets the videos of this name but other content: a file that was changed. Returns how many there were.
  virtual Expected<std::int64_t> ForgetOtherContent(const std::string& name, const std::string& content_id) = 0;
  virtual Status SetVideoLength(std::int64_t video, std::int64_t frame_count, double duration_s) = 0;
  virtual Status SetVideoFeatures(std::int64_t video, const std::string& features_json) = 0;
  virtual Expected<std::vector<VideoRecord>> Videos() = 0;

  /// Adds the model, or finds it. A model of the same name but other content replaces the old one, whose sightings,
  /// objects and progress go (in the same transaction).
  virtual Expected<ModelRecord> PutModel(const ModelRecord& model) = 0;
  virtual Expected<std::vector<ModelRecord>> Models() = 0;

  virtual Expected<std::optional<SearchRecord>> FindSearch(std::int64_t video, std::int64_t model) = 0;
  /// Forgets what was found of a model in a video, and how far the search had come.
  virtual Status ForgetSearch(std::int64_t video, std::int64_t model) = 0;
  /// Forgets the kept features of a video.
  virtual Status ForgetKeptFrames(std::int64_t video) = 0;

  /// One transaction. Returns the ids of batch.runs, in their order. A kept frame that is there already stays.
  /// Errors: kConflict if another process moved the progress; kNotFound for a run, video or model that is
  /// gone; kInvalidArgument for a sighting that is there already.
  virtual Expected<std::vector<std::int64_t>> Commit(const IndexBatch& batch) = 0;

  /// All of them, by id.
  virtual Expected<std::vector<RunRecord>> Runs() = 0;
  /// One transaction: joins runs to these objects, and forgets objects that are left without a run. Of ObjectRecord it
  /// takes the id, model, runs, place, heading and rejection; runs that are gone by now are passed over.
  virtual Status PutObjects(std::span<const ObjectRecord> objects) = 0;

  /// Best first: by score, then by number of frames, then by id.
  virtual Expected<std::vector<ObjectRecord>> Objects(const SightingFilter& filter) = 0;
  /// By video (in the order they were added), frame, then object, one at a time; `visit` returns false to stop.
  virtual Status VisitSightings(const SightingFilter& filter, const std::function<bool(SightingRecord&&)>& visit) = 0;
  /// All of them at once: some 300 bytes each.
  Expected<std::vector<SightingRecord>> Sightings(const SightingFilter& filter);
  /// By video and frame, one at a time; `visit` returns false to stop. The filter's model does not apply.
  virtual Status VisitKeptFrames(const SightingFilter& filter, const std::function<bool(KeptFrame&&)>& visit) = 0;
};

enum class StoreMode {
  kCreate,  ///< for writing; made if it is not there
  kRead,    ///< for reading; must exist
};

/// Opens a SQLite index. Reading leaves no file behind, and works where nothing may be written. Errors: kNotFound;
/// kDataLoss (not a database, or damaged); kUnsupported (another program's database, or one of a newer version);
/// kPermissionDenied; kNoSpace.
Expected<std::unique_ptr<IndexStore>> OpenSqliteStore(const std::filesystem::path& path, StoreMode mode);

}  // namespace victorious
