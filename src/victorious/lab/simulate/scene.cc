#include "victorious/lab/simulate/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/enum_text.h"
#include "victorious/base/file.h"
#include "victorious/base/json.h"

namespace victorious {
namespace {

constexpr std::size_t kMaxSceneBytes = std::size_t{1} << 24;
constexpr std::size_t kMaxListed = 10000;  // objects, pieces, points
constexpr double kMaxReachM = 20000;       // maximum distance from the origin, per coordinate
constexpr double kMaxTimeS = 1e6;          // maximum time of a point of a path, before and after the first frame
constexpr int kMaxSquare = 50;             // maximum column and row of a town, in each direction from the origin
constexpr const char* kDefaultAssets = "../assets";
constexpr auto kPathTexts = std::to_array<EnumText<PathInterpolation>>(
    {{PathInterpolation::kLinear, "linear"}, {PathInterpolation::kSmooth, "smooth"}});

std::unexpected<Error> InvalidScene(std::string message) {
  return Fail(ErrorCode::kInvalidArgument, std::move(message));
}

// Removes a member from a JSON object and returns it; std::nullopt if there is none. The plain fields remain.
std::optional<nlohmann::json> Take(nlohmann::json& object, const char* key) {
  const auto at = object.find(key);
  if (at == object.end()) return std::nullopt;
  nlohmann::json value = std::move(*at);
  object.erase(at);
  return value;
}

bool IsNumberIn(const nlohmann::json& value, double low, double high) {
  if (!value.is_number()) return false;
  const double number = value.get<double>();
  return number >= low && number <= high;
}

// If `key` exists, removes it and sets `numbers` to its list or single number.
Status TakeNumbers(nlohmann::json& object, const char* key, const SceneRange& range, std::vector<double>& numbers) {
  std::optional<nlohmann::json> value = Take(object, key);
  if (!value) return {};
  if (value->is_number()) value = nlohmann::json::array({*value});
  const bool fits =
      value->is_array() && !value->empty() && value->size() <= kMaxListed &&
      std::ranges::all_of(*value, [&](const nlohmann::json& n) { return IsNumberIn(n, range.low, range.high); });
  if (!fits)
    return InvalidScene(
        fmt::format("{}: must be a number from {} to {}, or a list of them", key, range.low, range.high));
  numbers = value->get<std::vector<double>>();
  return {};
}

Status TakePoints(nlohmann::json& object, const char* key, std::size_t least, std::vector<Eigen::Vector2d>& points) {
  const std::optional<nlohmann::json> value = Take(object, key);
  if (!value) return {};
  const auto is_point = [](const nlohmann::json& point) {
    return point.is_array() && point.size() == 2 && IsNumberIn(point[0], -kMaxReachM, kMaxReachM) &&
           IsNumberIn(point[1], -kMaxReachM, kMaxReachM);
  };
  const bool fits = value->is_array() && value->size() >= least && value->size() <= kMaxListed &&
                    std::ranges::all_of(*value, is_point);
  if (!fits) {
    return InvalidScene(
        fmt::format("{}: must be a list of {} or more points [x, y] in metres, at most {:.0f} from the origin", key,
                    least, kMaxReachM));
  }
  points.clear();
  for (const nlohmann::json& point : *value) points.emplace_back(point[0].get<double>(), point[1].get<double>());
  return {};
}

Status TakeSquares(nlohmann::json& object, std::array<int, 4>& squares) {
  const std::optional<nlohmann::json> value = Take(object, "squares");
  if (!value) return {};
  const auto is_square = [](const nlohmann::json& n) {
    return n.is_number_integer() && IsNumberIn(n, -kMaxSquare, kMaxSquare);
  };
  if (value->is_array() && value->size() == 4 && std::ranges::all_of(*value, is_square)) {
    squares = value->get<std::array<int, 4>>();
    if (squares[0] <= squares[2] && squares[1] <= squares[3]) return {};
  }
  return InvalidScene(
      fmt::format("town.squares: must be [first column, first row, last column, last row], from {} to {}", -kMaxSquare,
                  kMaxSquare));
}

// Removes the list `key` and appends its entries to `list`; `read` converts each entry, a JSON object, into a T.
template <typename T, typename Read>
Status TakeList(nlohmann::json& object, const char* key, const Read& read, std::vector<T>& list) {
  std::optional<nlohmann::json> value = Take(object, key);
  if (!value) return {};
  if (!value->is_array() || value->size() > kMaxListed) {
    return InvalidScene(fmt::format("{}: must be a list of at most {}", key, kMaxListed));
  }
  for (std::size_t i = 0; i < value->size(); ++i) {
    const std::string context = fmt::format("{}[{}]", key, i);
    if (!(*value)[i].is_object()) return InvalidScene(context + ": must be an object");
    Expected<T> entry = read((*value)[i]);
    if (!entry) return std::unexpected(std::move(entry).error().WithContext(context));
    list.push_back(*std::move(entry));
  }
  return {};
}

template <typename T>
Expected<T> ReadFields(nlohmann::json& json) {
  T entry;
  VICTORIOUS_RETURN_IF_ERROR(SetFromJson(json, CollectFields(entry)));
  return entry;
}

// Asset names become file paths: they must not leave the assets folder.
bool IsAssetName(std::string_view name) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789_/";
  return !name.empty() && name.front() != '/' && name.find_first_not_of(kLetters) == std::string_view::npos;
}

// Checks the times at which an object is at the points of its path.
Status CheckTimes(const std::vector<double>& times_s, const std::vector<Eigen::Vector2d>& path_m, double speed_m_s) {
  if (times_s.empty()) return {};
  if (speed_m_s != 0) return InvalidScene("speed_m_s: times_s gives it, leave one of them out");
  if (times_s.size() != path_m.size())
    return InvalidScene(
        fmt::format("times_s: {} times for {} points of path_m: must be one each", times_s.size(), path_m.size()));
  if (std::ranges::adjacent_find(times_s, std::greater_equal()) != times_s.end())
    return InvalidScene("times_s: must increase from point to point");
  return {};
}

Expected<SceneObject> ReadObject(nlohmann::json& json) {
  std::vector<Eigen::Vector2d> path_m;
  std::vector<double> times_s;
  VICTORIOUS_RETURN_IF_ERROR(TakePoints(json, "path_m", 2, path_m));
  VICTORIOUS_RETURN_IF_ERROR(TakeNumbers(json, "times_s", {-kMaxTimeS, kMaxTimeS}, times_s));
  for (const char* key : {"x_m", "y_m", "heading_deg"}) {
    if (!path_m.empty() && json.contains(key))
      return InvalidScene(fmt::format("{}: path_m gives it, leave one of them out", key));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(SceneObject object, ReadFields<SceneObject>(json));
  if (object.id.empty()) return InvalidScene("id: must be a name; the truth names the object by it");
  if (object.model.empty()) return InvalidScene("model: must be a name; the truth names the object's model by it");
  if (object.file.empty() && !IsAssetName(object.model))
    return InvalidScene("model: no shipped model has such a name; give its file");
  const bool stays =
      !path_m.empty() && std::ranges::all_of(path_m, [&](const auto& point) { return point == path_m[0]; });
  if (stays) return InvalidScene("path_m: all points are the same: must have at least two different points");
  if (path_m.empty() && object.speed_m_s != 0) return InvalidScene("speed_m_s: needs a path_m to drive along");
  VICTORIOUS_RETURN_IF_ERROR(CheckTimes(times_s, path_m, object.speed_m_s));
  object.path_m = std::move(path_m);
  object.times_s = std::move(times_s);
  return object;
}

Expected<ScenePiece> ReadPiece(nlohmann::json& json) {
  VICTORIOUS_ASSIGN_OR_RETURN(ScenePiece piece, ReadFields<ScenePiece>(json));
  if (!IsAssetName(piece.asset))
    return InvalidScene("asset: must be a name such as \"town/trees/oak\" or \"models/bus\"");
  return piece;
}

Expected<SceneTile> ReadTile(nlohmann::json& json) {
  VICTORIOUS_ASSIGN_OR_RETURN(SceneTile tile, ReadFields<SceneTile>(json));
  if (!IsAssetName(tile.tile)) return InvalidScene("tile: must be a name such as \"apron\"");
  return tile;
}

Status TakeCamera(nlohmann::json& root, SceneCamera& camera) {
  const auto at = root.find("camera");
  if (at == root.end()) return {};
  if (!at->is_object()) return InvalidScene("camera: must be an object");
  VICTORIOUS_RETURN_IF_ERROR(TakePoints(*at, "aim_m", 1, camera.aim_m));
  VICTORIOUS_RETURN_IF_ERROR(TakeNumbers(*at, "from_deg", {-36000, 36000}, camera.from_deg));
  VICTORIOUS_RETURN_IF_ERROR(TakeNumbers(*at, "off_nadir_deg", kOffNadirDeg, camera.off_nadir_deg));
  VICTORIOUS_RETURN_IF_ERROR(TakeNumbers(*at, "range_m", kRangeM, camera.range_m));
  return TakeNumbers(*at, "roll_deg", {-180, 180}, camera.roll_deg);
}

Status TakeTown(nlohmann::json& root, SceneTown& town) {
  const auto at = root.find("town");
  if (at == root.end()) return {};
  if (!at->is_object()) return InvalidScene("town: must be an object");
  VICTORIOUS_RETURN_IF_ERROR(TakeSquares(*at, town.squares));
  return TakeList(*at, "tiles", &ReadTile, town.tiles);
}

// Checks that every tile lies on a square of the town, and at most one tile on each.
Status CheckTiles(const SceneTown& town) {
  const auto [first_column, first_row, last_column, last_row] = town.squares;
  std::set<std::pair<int, int>> seen;
  for (std::size_t i = 0; i < town.tiles.size(); ++i) {
    const auto& [tile, column, row, turns] = town.tiles[i];
    const std::string where = fmt::format("town.tiles[{}]: {} on square ({}, {})", i, tile, column, row);
    if (column < first_column || column > last_column || row < first_row || row > last_row) {
      return InvalidScene(fmt::format("{}: must lie in town.squares: columns {} to {}, rows {} to {}", where,
                                      first_column, last_column, first_row, last_row));
    }
    if (!seen.insert({column, row}).second)
      return InvalidScene(where + ": another tile lies there; leave one of them out");
  }
  return {};
}

Status CheckIds(const std::vector<SceneObject>& objects) {
  std::set<std::string_view> seen;
  for (const SceneObject& object : objects) {
    if (!seen.insert(object.id).second)
      return InvalidScene(
          fmt::format("objects: two have the id {}: ids must be unique", DumpJson(nlohmann::json(object.id))));
  }
  return {};
}

// The plain fields of a scene: the JSON without its lists.
struct PlainFields {
  Scene& scene;
  std::string& assets;

  void ListFields(FieldList& fields) {
    fields.Add("assets", assets, {.reason = "the folder with models/ and town/, relative to the scene's folder"});
    fields.Add("seed", scene.seed, {.reason = "of noise and camera shake; the town has its own"});
    fields.AddGroup("video", scene.video);
    fields.AddGroup("origin", scene.origin);
    fields.AddGroup("sun", scene.sun);
    fields.AddGroup("camera", scene.camera);
    fields.AddGroup("town", scene.town);
  }
};

Expected<Scene> SceneFromJson(nlohmann::json& root) {
  Scene scene;
  VICTORIOUS_RETURN_IF_ERROR(TakeCamera(root, scene.camera));
  VICTORIOUS_RETURN_IF_ERROR(TakeTown(root, scene.town));
  VICTORIOUS_RETURN_IF_ERROR(TakeList(root, "objects", &ReadObject, scene.objects));
  VICTORIOUS_RETURN_IF_ERROR(TakeList(root, "pieces", &ReadPiece, scene.pieces));
  VICTORIOUS_RETURN_IF_ERROR(CheckIds(scene.objects));
  VICTORIOUS_RETURN_IF_ERROR(CheckTiles(scene.town));
  std::string assets = kDefaultAssets;
  PlainFields plain{scene, assets};
  VICTORIOUS_RETURN_IF_ERROR(SetFromJson(root, CollectFields(plain)));
  if (scene.video.width % 2 != 0 || scene.video.height % 2 != 0) {
    return InvalidScene(
        fmt::format("video: {} x {} pixels: must be even numbers", scene.video.width, scene.video.height));
  }
  scene.assets = assets;
  return scene;
}

FieldSpec PositionField(std::string reason) {
  return {.min = -kMaxReachM, .max = kMaxReachM, .unit = "m", .reason = std::move(reason)};
}

FieldSpec HeadingField(std::string reason) {
  return {.min = -3600, .max = 3600, .unit = "deg", .reason = std::move(reason)};
}

}  // namespace

void SceneVideo::ListFields(FieldList& fields) {
  fields.Add("frames", frames, {.min = 1, .max = 100000, .reason = "number of frames"});
  fields.Add("fps", fps, {.min = 0.1, .max = 240, .unit = "1/s", .reason = "frames a second"});
  fields.Add("width", width, {.min = 16, .max = 4096, .unit = "px", .reason = "even"});
  fields.Add("height", height, {.min = 16, .max = 4096, .unit = "px", .reason = "even"});
  fields.Add("hfov_deg", hfov_deg, {.min = 1, .max = 120, .unit = "deg", .reason = "full horizontal field of view"});
  fields.Add("supersampling", supersampling, {.min = 1, .max = 4, .reason = "samples along each side of a pixel"});
  fields.Add("blur_px", blur_px,
             {.min = 0, .max = 10, .unit = "px", .reason = "standard deviation of the optical blur"});
  fields.Add("grain", grain,
             {.min = 0, .max = 64, .reason = "standard deviation of the sensor noise, grey levels (0 to 255)"});
  fields.Add("noise", noise,
             {.min = 0, .max = 0.5, .reason = "salt-and-pepper noise: fraction of pixels set to white or black"});
  fields.Add("crf", crf, {.min = 0, .max = 51, .reason = "x264's constant rate factor: 0 lossless"});
}

void SceneOrigin::ListFields(FieldList& fields) {
  fields.Add("latitude_deg", latitude_deg, {.min = -89, .max = 89, .unit = "deg", .reason = "WGS 84"});
  fields.Add("longitude_deg", longitude_deg, {.min = -180, .max = 180, .unit = "deg", .reason = "WGS 84"});
  fields.Add("altitude_m", altitude_m, {.min = -500, .max = 9000, .unit = "m", .reason = "above the ellipsoid"});
  fields.Add("heading_deg", heading_deg, HeadingField("heading of the town's y axis, clockwise from north"));
}

void SceneSun::ListFields(FieldList& fields) {
  fields.Add("azimuth_deg", azimuth_deg, HeadingField("azimuth of the sun, clockwise from true north"));
  fields.Add("elevation_deg", elevation_deg, {.min = 5, .max = 90, .unit = "deg", .reason = "above the horizon"});
  fields.Add("strength", strength, {.min = 0, .max = 10, .reason = "intensity on a white surface that faces the sun"});
  fields.Add("sky", sky, {.min = 0, .max = 10, .reason = "light from straight above"});
  fields.Add("ground", ground, {.min = 0, .max = 10, .reason = "light from straight below"});
}

void SceneCamera::ListFields(FieldList& fields) {
  fields.Add("path", path, kPathTexts, {.reason = "interpolation between the knots: linear, or a Catmull-Rom spline"});
  fields.Add("shake_deg", shake_deg,
             {.min = 0, .max = 5, .unit = "deg", .reason = "root mean square of the camera shake about each axis"});
  fields.Add("shake_hz", shake_hz, {.min = 0.01, .max = 50, .unit = "Hz", .reason = "frequency of the camera shake"});
}

void SceneObject::ListFields(FieldList& fields) {
  fields.Add("id", id, {.reason = "its name in the truth"});
  fields.Add("model", model, {.reason = "its model name in the truth"});
  fields.Add("file", file, {.reason = "its CAD file, relative to the scene's folder; default: the shipped model"});
  fields.Add("x_m", x_m, PositionField("position of the centre of its bounding box"));
  fields.Add("y_m", y_m, PositionField("position of the centre of its bounding box"));
  fields.Add("z_m", z_m, {.min = 0, .max = 1000, .unit = "m", .reason = "height of its lowest point above the ground"});
  fields.Add("heading_deg", heading_deg, HeadingField("heading of its front, clockwise from the town's y axis"));
  fields.Add("speed_m_s", speed_m_s, {.min = 0, .max = 400, .unit = "m/s", .reason = "along path_m"});
}

void ScenePiece::ListFields(FieldList& fields) {
  fields.Add("asset", asset, {.reason = "a shipped asset: town/trees/oak, models/bus"});
  fields.Add("x_m", x_m, PositionField("position of the centre of its bounding box"));
  fields.Add("y_m", y_m, PositionField("position of the centre of its bounding box"));
  fields.Add("z_m", z_m, {.min = 0, .max = 1000, .unit = "m", .reason = "height of its lowest point above the ground"});
  fields.Add("heading_deg", heading_deg, HeadingField("heading of its front, clockwise from the town's y axis"));
}

void SceneTile::ListFields(FieldList& fields) {
  fields.Add("tile", tile, {.reason = "a shipped tile: apron, helipad"});
  fields.Add("column", column, {.min = -kMaxSquare, .max = kMaxSquare, .reason = "of the square, to the right"});
  fields.Add("row", row, {.min = -kMaxSquare, .max = kMaxSquare, .reason = "of the square, ahead"});
  fields.Add("turns", turns, {.min = 0, .max = 3, .reason = "quarter turns, clockwise"});
}

void SceneTown::ListFields(FieldList& fields) {
  fields.Add("seed", seed, {.reason = "of the layout"});
  fields.Add("density", density, {.min = 0, .max = 1, .reason = "occupancy of squares and kerbs; 1 is full"});
  fields.Add("columns_per_street", columns_per_street,
             {.min = 2, .max = 100, .reason = "squares from street to street"});
  fields.Add("rows_per_street", rows_per_street, {.min = 2, .max = 100, .reason = "squares from street to street"});
}

Expected<Scene> ParseScene(std::string_view text, const std::string& name) {
  Expected<nlohmann::json> root = ParseJson(text);
  if (!root) return std::unexpected(std::move(root).error().WithContext(name));
  if (!root->is_object()) return InvalidScene(name + ": not a JSON object");
  Expected<Scene> scene = SceneFromJson(*root);
  if (!scene) return std::unexpected(std::move(scene).error().WithContext(name));
  return scene;
}

Expected<Scene> ReadScene(const std::filesystem::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, kMaxSceneBytes));
  VICTORIOUS_ASSIGN_OR_RETURN(Scene scene, ParseScene(text, path.string()));
  scene.folder = path.parent_path();
  scene.assets = scene.folder / scene.assets;
  return scene;
}

}  // namespace victorious
