// What an index holds: objects with their places on Earth, and the frames that show them.
//
//   Index index("index.db");
//   for (const Object& one : index.Objects()) {
//     if (one.place) Use(one.model, one.place->latitude_deg, one.place->longitude_deg, one.place->ce90_m);
//   }
//
// Angles are in degrees; directions clockwise from north. Heights are above the ellipsoid of WGS 84.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <victorious/export.h>
#include <victorious/image.h>
#include <victorious/model.h>

namespace libvictorious {

/// The motion of an object over the ground. The standard deviations are to first order.
struct Motion {
  double speed_m_s = 0;        ///< over the ground
  double sigma_speed_m_s = 0;  ///< standard deviation
  double course_deg = 0;       ///< of the motion, [0, 360)
  double sigma_course_deg = 0;
};

/// A place on Earth with its error.
struct Place {
  double latitude_deg = 0;   ///< WGS 84, northwards
  double longitude_deg = 0;  ///< eastwards
  double altitude_m = 0;     ///< above the ellipsoid
  double time_s = 0;         ///< of the place: of the last line of sight, s since the first frame of its video
  /// Row by row, m^2: east, north, up at the place.
  std::array<double, 9> covariance_enu_m2{};
  double ce90_m = 0;             ///< radius of the horizontal circle that holds the true place with 90 %
  double le90_m = 0;             ///< half the vertical interval that holds the true height with 90 %
  std::optional<Motion> motion;  ///< std::nullopt: it stands still, or its motion is not known
};

/// An object in one video.
struct Moment {
  std::string video;        ///< name
  double first_time_s = 0;  ///< of its first sighting there, s since the first frame of this video
  double last_time_s = 0;   ///< of its last sighting there
  std::int64_t frames = 0;  ///< with a sighting
  /// UTC of the first frame of the video, microseconds since 1970; std::nullopt: telemetry does not give it.
  std::optional<std::int64_t> video_start_utc_us;
};

/// An object: what was seen in one or more videos and is one.
struct Object {
  std::int64_t id = 0;
  std::int64_t rank = 0;              ///< from 1, best first
  std::string model;                  ///< name of the model or category
  bool is_category = false;           ///< `model` is the name of a category
  double score = 0;                   ///< 0 to 1
  std::int64_t frames = 0;            ///< with a sighting
  std::optional<Place> place;         ///< std::nullopt: without telemetry, or rejected
  std::optional<double> heading_deg;  ///< of its front
  std::vector<Moment> moments;        ///< by video
  std::string rejected;               ///< why it is no find; empty: it is one
  std::string place_rejected;         ///< why it has no place, if one was estimated and rejected
  std::vector<std::string> against;   ///< what speaks against it
};

enum class SightingSource { kRecognised, kTracked };

/// An object in one frame.
struct Sighting {
  std::int64_t object = 0;  ///< Object::id
  std::string model;
  bool is_category = false;
  std::string video;           ///< name
  std::int64_t frame = 0;      ///< from 0
  double time_s = 0;           ///< presentation time, s since the first frame of the video
  Box box;                     ///< px
  std::vector<Point> outline;  ///< px; may leave the frame
  double score = 0;            ///< 0 to 1
  SightingSource source = SightingSource::kRecognised;
  std::int64_t matches = 0;                ///< keypoints; 0 for a category
  std::optional<double> distance_m;        ///< from the camera
  std::optional<double> sigma_distance_m;  ///< standard deviation of it
  std::optional<std::int64_t> utc_us;      ///< microseconds since 1970, if telemetry gives it
};

/// Conditions that must all hold.
struct Filter {
  std::optional<std::string> model;     ///< name of a model
  std::optional<std::string> category;  ///< name; holds its subcategories: "vehicle" matches "vehicle/car"
  std::optional<std::string> video;     ///< name, or the last parts of its path
  std::optional<double> from_s;         ///< of the sightings, s
  std::optional<double> to_s;
  std::optional<std::int64_t> object;  ///< id
  bool include_rejected = false;
  bool include_weak = false;  ///< objects of models that score below 0.5, and are more likely false than right
};

struct IndexedVideo {
  std::string name;
  int width = 0;                             ///< px
  int height = 0;                            ///< px
  std::optional<std::int64_t> frame_count;   ///< once it was read to its end
  std::optional<double> duration_s;          ///< presentation time of its last frame
  std::optional<std::int64_t> start_utc_us;  ///< UTC of its first frame, microseconds since 1970
};

struct IndexedModel {
  std::string name;
  std::string id;  ///< Model::id, or of the category model
  ModelKind kind = ModelKind::kPhotos;
};

/// An index, read only, while others may write it. Used by one thread at a time; can be moved, not copied.
class LIBVICTORIOUS_EXPORT Index {
 public:
  /// @param name  a SQLite file, or postgresql://USER@HOST/DATABASE
  /// Errors: kNotFound, kDataLoss, kUnsupported (of a newer version), kPermissionDenied, kUnavailable.
  explicit Index(const std::string& name);
  Index(Index&& other) noexcept;
  Index& operator=(Index&& other) noexcept;
  ~Index();

  [[nodiscard]] std::vector<IndexedVideo> Videos() const;
  [[nodiscard]] std::vector<IndexedModel> Models() const;

  /// Best first, as `victorious search` lists them. Error: kNotFound for a name that the index does not have; the
  /// message lists those that it has.
  [[nodiscard]] std::vector<Object> Objects(const Filter& filter = {}) const;

  /// Visits the sightings one at a time, by video, frame and object; `visit` returns false to stop, and may throw, but
  /// does not use this index. Errors: as Objects.
  void VisitSightings(const Filter& filter, const std::function<bool(const Sighting& sighting)>& visit) const;
  /// All of them; about 300 bytes each.
  [[nodiscard]] std::vector<Sighting> Sightings(const Filter& filter = {}) const;

  /// Writes a file as `victorious export --format` does: "objects", "sightings", "mot", "coco", "geojson", "kml",
  /// "gpkg" and what else the command lists. Errors: kInvalidArgument for another format; kNotFound; kNoSpace;
  /// kPermissionDenied.
  void Export(const std::string& format, const std::string& file, const Filter& filter = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace libvictorious
