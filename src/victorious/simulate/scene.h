// A scene as JSON, read into a struct: what stands where in which town, under which sun, and how the camera flies over
// it. docs/formats/scene.md describes the file.
//
// The town's frame: metres, x to the right and y ahead as a map of the town lies on the table, z up, ground at 0. Its
// origin lies at `origin`, and y points to `origin.heading_deg` there. Directions in the town (headings, `from_deg`)
// are degrees clockwise from y. The sun alone is given by the compass.
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

/// The pictures, and what spoils them (degrade.h).
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

/// Where on Earth the town lies.
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

/// From the least to the largest that may be.
struct SceneRange {
  double low;
  double high;
};
inline constexpr SceneRange kOffNadirDeg = {0, 80};
inline constexpr SceneRange kRangeM = {1, 10000};

/// The camera's way (flight_path.h). Each list holds the values at times spread evenly from the first frame to the
/// last; a list of one holds throughout.
struct SceneCamera {
  std::string path = "linear";
  double shake_deg = 0;
  double shake_hz = 1.5;
  std::vector<Eigen::Vector2d> aim_m = {Eigen::Vector2d::Zero()};  ///< where on the ground the optical axis points
  std::vector<double> from_deg = {180};                            ///< where the camera stands, seen from there
  std::vector<double> off_nadir_deg = {35};
  std::vector<double> range_m = {110};
  std::vector<double> roll_deg = {0};

  void ListFields(FieldList& fields);
};

/// Something to be found: it is in the truth.
struct SceneObject {
  std::string id;
  std::string model;  ///< its kind, as truth names it
  std::string file;   ///< a CAD file; unless given, the asset models/<model>
  double x_m = 0;     ///< where the middle of its bounding box stands
  double y_m = 0;
  double z_m = 0;  ///< of its lowest point
  double heading_deg = 0;
  std::vector<Eigen::Vector2d> path_m;  ///< unless empty, it drives there: x_m, y_m and heading_deg may not be given
  double speed_m_s = 0;

  void ListFields(FieldList& fields);
};

/// Something that is only there: a tree in front of an object, a vehicle that nobody asks for.
struct ScenePiece {
  std::string asset;  ///< a shipped CAD file, without its ending: "town/trees/oak", "models/bus"
  double x_m = 0;
  double y_m = 0;
  double z_m = 0;
  double heading_deg = 0;

  void ListFields(FieldList& fields);
};

/// A square of the town's ground that is chosen and not drawn by lot.
struct SceneTile {
  std::string tile;  ///< "apron"
  int column = 0;
  int row = 0;
  int turns = 0;  ///< quarter turns, clockwise

  void ListFields(FieldList& fields);
};

/// The town by lot (town.h). Square (0, 0) has its middle at the town's origin.
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
  std::filesystem::path folder;  ///< where the scene lies: its CAD files' names start there
  std::uint64_t seed = 1;
  SceneVideo video;
  SceneOrigin origin;
  SceneSun sun;
  SceneCamera camera;
  SceneTown town;
  std::vector<SceneObject> objects;
  std::vector<ScenePiece> pieces;
};

/// Any bytes are safe. Error: kInvalidArgument, one line with `name` and the first list, entry of a list or name that
/// is wrong; where all of those are right, every other key that is unknown, of the wrong type or out of range.
Expected<Scene> ParseScene(std::string_view text, const std::string& name);

/// The same from a file, whose folder relative names start from. Errors besides: those of reading.
Expected<Scene> ReadScene(const std::filesystem::path& path);

}  // namespace victorious
