// Scene description, read from JSON: town, objects, sun and camera path. docs/formats/scene.md describes the file.
//
// Town frame: metres, x right and y ahead on the map of the town, z up, ground at z = 0. Its origin lies at `origin` on
// the Earth; y points to the heading `origin.heading_deg` there. Directions in the town (headings, `from_deg`) are
// degrees clockwise from y. Only the sun's azimuth is relative to true north.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/error.h"
#include "victorious/base/options.h"

namespace victorious {

/// Video format and image degradation (degrade.h).
struct SceneVideo {
  int frames = 100;
  double fps = 10;
  int width = 640;
  int height = 480;
  double hfov_deg = 15;
  int supersampling = 2;
  double blur_px = 0;
  double grain = 0;
  double noise = 0;
  int crf = 18;

  void ListFields(FieldList& fields);
};

/// Position and heading of the town frame on the Earth (WGS 84).
struct SceneOrigin {
  double latitude_deg = 0;
  double longitude_deg = 0;
  double altitude_m = 0;
  double heading_deg = 0;

  void ListFields(FieldList& fields);
};

struct SceneSun {
  double azimuth_deg = 180;
  double elevation_deg = 50;
  double strength = 0.6;
  double sky = 0.5;
  double ground = 0.25;

  void ListFields(FieldList& fields);
};

/// Allowed range of a value, inclusive.
struct SceneRange {
  double low;
  double high;
};
inline constexpr SceneRange kOffNadirDeg = {0, 80};
inline constexpr SceneRange kRangeM = {1, 10000};

/// The interpolation between the knots of a camera path.
enum class PathInterpolation {
  kLinear,
  kSmooth,  ///< Catmull-Rom spline
};

/// Camera path (flight_path.h). Each list has the values of the knots, at equal time steps from the first frame to the
/// last; a list with one value is constant.
struct SceneCamera {
  PathInterpolation path = PathInterpolation::kLinear;
  double shake_deg = 0;
  double shake_hz = 1.5;
  std::vector<Eigen::Vector2d> aim_m = {Eigen::Vector2d::Zero()};  ///< where the optical axis meets the ground
  std::vector<double> from_deg = {180};                            ///< direction from there to the camera
  std::vector<double> off_nadir_deg = {35};
  std::vector<double> range_m = {110};
  std::vector<double> roll_deg = {0};

  void ListFields(FieldList& fields);
};

/// A target object: the ground truth lists it.
struct SceneObject {
  std::string id;
  std::string model;  ///< its model name in the truth
  std::string file;   ///< a CAD file; default: the asset models/<model>
  double x_m = 0;     ///< position of the centre of its bounding box
  double y_m = 0;
  double z_m = 0;  ///< height of its lowest point
  double heading_deg = 0;
  std::vector<Eigen::Vector2d> path_m;  ///< not empty: it drives along this; x_m, y_m and heading_deg must not be given
  double speed_m_s = 0;                 ///< constant; 0 if there are times
  std::vector<double> times_s;          ///< not empty: when it is at each point of the path; the speed follows

  void ListFields(FieldList& fields);
};

/// An object that the ground truth does not list: an occluder (a tree) or a distractor (another vehicle).
struct ScenePiece {
  std::string asset;  ///< a shipped CAD file, without its extension: "town/trees/oak", "models/bus"
  double x_m = 0;
  double y_m = 0;
  double z_m = 0;
  double heading_deg = 0;

  void ListFields(FieldList& fields);
};

/// A square of the town whose tile the scene specifies; the others are random.
struct SceneTile {
  std::string tile;  ///< "apron"
  int column = 0;
  int row = 0;
  int turns = 0;  ///< quarter turns, clockwise

  void ListFields(FieldList& fields);
};

/// The random town (town.h). The centre of square (0, 0) is the origin of the town frame.
struct SceneTown {
  std::uint64_t seed = 1;
  double density = 0.7;
  int columns_per_street = 4;
  int rows_per_street = 3;
  std::array<int, 4> squares = {-5, -4, 5, 4};  ///< first column and row, last column and row
  std::vector<SceneTile> tiles;

  void ListFields(FieldList& fields);
};

struct Scene {
  std::filesystem::path assets;  ///< the folder with models/ and town/
  std::filesystem::path folder;  ///< folder of the scene file; paths of CAD files are relative to it
  std::uint64_t seed = 1;
  SceneVideo video;
  SceneOrigin origin;
  SceneSun sun;
  SceneCamera camera;
  SceneTown town;
  std::vector<SceneObject> objects;
  std::vector<ScenePiece> pieces;
};

/// Parses a scene; safe for untrusted bytes. Error: kInvalidArgument, one line with `name` and the first wrong list,
/// list entry or name; if all of these are right, with every key that is unknown, of the wrong type or out of range.
[[nodiscard]] Expected<Scene> ParseScene(std::string_view text, const std::string& name);

/// The same from a file; relative paths start from its folder. Further errors: those of reading.
[[nodiscard]] Expected<Scene> ReadScene(const std::filesystem::path& path);

}  // namespace victorious
