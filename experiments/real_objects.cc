#include "experiments/real_objects.h"

#include <algorithm>
#include <array>
#include <memory>
#include <regex>
#include <span>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/persistence.hpp>
#include <zlib.h>

#include "experiments/pose_by_points.h"
#include "experiments/video_frames.h"
#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"
#include "victorious/object/mesh/load_mesh.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Reads a camera without distortion from a ViSP calibration, a parameter file (.xml) or JSON. The image size is not
// set.
Expected<PinholeCamera> ReadCamera(const fs::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(path));
  PinholeCamera camera;
  for (const auto& [name, value] :
       {std::pair("px", &camera.fx), {"py", &camera.fy}, {"u0", &camera.cx}, {"v0", &camera.cy}}) {
    std::smatch found;
    const std::regex number(fmt::format(R"(\b{}\W+([0-9]+\.?[0-9]*))", name));
    if (!std::regex_search(text, found, number)) {
      return Fail(ErrorCode::kDataLoss, fmt::format("{}: a calibration must have px, py, u0 and v0", path.string()));
    }
    *value = std::stod(found[1]);
  }
  return camera;
}

PinholeCamera ForImage(PinholeCamera camera, const cv::Mat& image) {
  camera.width = image.cols;
  camera.height = image.rows;
  return camera;
}

// Reads at most 40 evenly spaced frames, the first one included.
Expected<std::vector<RealView>> ReadVideo(const fs::path& path, double focal_px) {
  constexpr std::int64_t kMaxFrames = 40;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t count, CountFrames(path));
  std::vector<std::int64_t> numbers;
  for (std::int64_t i = 0; i < count; i += (count + kMaxFrames - 1) / kMaxFrames) numbers.push_back(i);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Frame> frames, ReadNumberedFrames(path, numbers, FrameColor::kBgr));
  std::vector<RealView> views;
  for (const Frame& frame : frames) {
    views.push_back({.bgr = frame.image, .focal_px = focal_px, .camera_from_object = {}});
  }
  if (views.empty()) return Fail(ErrorCode::kDataLoss, fmt::format("{}: no frame can be decoded", path.string()));
  return views;
}

// Reads points and faces of a ViSP model (.cao): numbers in that order, comments after '#'.
Expected<Mesh> ReadCao(const fs::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(path));
  std::istringstream numbers(std::regex_replace(text, std::regex("#[^\n]*|V1"), ""));
  const auto damaged = [&] {
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: must be a .cao model of points and faces only", path.string()));
  };
  Mesh mesh;
  std::size_t points = 0;
  numbers >> points;
  for (std::size_t i = 0; i < points && numbers; ++i) {
    Eigen::Vector3f& point = mesh.positions.emplace_back();
    numbers >> point.x() >> point.y() >> point.z();
  }
  std::size_t lines = 0;
  std::size_t faces_of_lines = 0;
  std::size_t faces = 0;
  numbers >> lines >> faces_of_lines >> faces;
  if (!numbers || lines != 0 || faces_of_lines != 0) return damaged();
  for (std::size_t i = 0; i < faces; ++i) {
    std::size_t count = 0;
    numbers >> count;
    std::vector<std::uint32_t> corners(std::min<std::size_t>(count, points));
    for (std::uint32_t& corner : corners) numbers >> corner;
    if (!numbers || std::ranges::any_of(corners, [&](std::uint32_t corner) { return corner >= points; })) {
      return damaged();
    }
    for (std::size_t k = 2; k < corners.size(); ++k) mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
  }
  mesh.normals.resize(points, Eigen::Vector3f::UnitZ());
  mesh.uvs.resize(points, Eigen::Vector2f::Zero());
  mesh.materials = {{.name = "plain", .base_colour = {0.5F, 0.5F, 0.5F, 1}, .double_sided = true}};
  mesh.parts = {{0, 0, static_cast<std::uint32_t>(mesh.triangles.size())}};
  return mesh;
}

// A corner of the mesh, by its index, and its manually marked pixel.
struct Click {
  std::size_t corner;
  Vector2d at_px;
};

// The camera pose from marked corners; the mesh frame is the world frame.
Expected<Rigid3> FitPoseToClicks(std::span<const Click> clicks, const Mesh& mesh, const PinholeCamera& camera) {
  const Vector3d middle = BoundingBox(mesh).center();
  std::vector<PointObservation> points;
  for (const auto& [corner, at_px] : clicks) {
    points.push_back({mesh.positions[corner].cast<double>() - middle, camera.Unproject(at_px).head<2>()});
  }
  const auto pose = FitPoseToPoints(points, 1 / camera.fx);
  if (!pose) return Fail(ErrorCode::kDataLoss, "no pose fits the marked corners of the model");
  const Rigid3& best = pose->camera_from_object;
  return Rigid3{best.rotation, best.translation - best.rotation * middle};
}

Expected<RealObject> LoadTeaBox(const fs::path& folder) {
  // Manually marked corners of the lid and of the bottom in the first frame of teabox.mp4.
  const std::array<Click, 5> clicks = {
      {{0, {192.5, 84}}, {3, {349.5, 207}}, {4, {489, 187}}, {2, {331, 377}}, {5, {463, 348}}}};
  RealObject box{.name = "tea box", .mesh = {}, .views = {}, .first_camera = {}, .other_views = {}};
  VICTORIOUS_ASSIGN_OR_RETURN(box.mesh, ReadCao(folder / "teabox.cao"));
  constexpr std::size_t kCorners = 8;
  if (box.mesh.positions.size() != kCorners) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: must have {} corners", (folder / "teabox.cao").string(), kCorners));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const PinholeCamera camera, ReadCamera(folder / "teabox.xml"));
  VICTORIOUS_ASSIGN_OR_RETURN(const PinholeCamera other, ReadCamera(folder / "teabox_left.xml"));
  VICTORIOUS_ASSIGN_OR_RETURN(box.views, ReadVideo(folder / "teabox.mp4", camera.fx));
  VICTORIOUS_ASSIGN_OR_RETURN(box.other_views, ReadVideo(folder / "teabox_left.mp4", other.fx));
  VICTORIOUS_ASSIGN_OR_RETURN(const Rigid3 first_pose, FitPoseToClicks(clicks, box.mesh, camera));
  box.first_camera = {ForImage(camera, box.views.front().bgr), first_pose};
  return box;
}

Expected<Eigen::Matrix4d> ParseMatrix(const nlohmann::json& rows, const fs::path& path) {
  Eigen::Matrix4d matrix;
  for (Eigen::Index row = 0; row < 4; ++row) {
    for (Eigen::Index column = 0; column < 4; ++column) {
      const auto pointer = nlohmann::json::json_pointer(fmt::format("/{}/{}", row, column));
      if (!rows.contains(pointer) || !rows.at(pointer).is_number()) {
        return Fail(ErrorCode::kDataLoss, fmt::format("{}: expected a matrix of 4 x 4 numbers", path.string()));
      }
      matrix(row, column) = rows.at(pointer).get<double>();
    }
  }
  return matrix;
}

Rigid3 RigidFromMatrix(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  return {Eigen::Quaterniond(rotation).normalized(), matrix.topRightCorner<3, 1>()};
}

// Reads the pose of the tag board in each frame: camera_from_board.
Expected<std::vector<Rigid3>> ReadBoard(const fs::path& path) {
  std::vector<Rigid3> board;
  try {
    const cv::FileStorage file(path.string(), cv::FileStorage::READ);
    for (const cv::FileNode& frame : file["grid"]) {
      Eigen::Matrix4d matrix;
      for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) matrix(row, column) = static_cast<double>(frame[row][column]);
      }
      board.push_back(RigidFromMatrix(matrix));
    }
  } catch (const cv::Exception& /*damaged*/) {
    board.clear();
  }
  if (board.empty())
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: must have 4 x 4 matrices in `grid`", path.string()));
  return board;
}

// Reads a whole gzip file, decompressed.
Expected<std::string> ReadGzip(const fs::path& path) {
  constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  if (!file) return Fail(ErrorCode::kNotFound, fmt::format("{}: no such file", path.string()));
  std::string bytes(kMaxBytes, '\0');
  const int read = gzread(file.get(), bytes.data(), static_cast<unsigned>(bytes.size()));
  if (read <= 0) return Fail(ErrorCode::kDataLoss, fmt::format("{}: not a gzip file", path.string()));
  bytes.resize(static_cast<std::size_t>(read));
  return bytes;
}

Expected<Mesh> ReadMesh(const fs::path& path, Axis up) {
  const LoadMeshOptions axes{.up = up, .front = Axis::kPlusX, .length_m = {}};
  if (path.extension() == ".gz") {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, ReadGzip(path));
    VICTORIOUS_ASSIGN_OR_RETURN(LoadedMesh loaded,
                                DecodeMesh(std::as_bytes(std::span(bytes)), path.stem().string(), axes));
    return std::move(loaded.mesh);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(LoadedMesh loaded, LoadMesh(path, axes));
  return std::move(loaded.mesh);
}

// An object that stands beside a board of tags.
struct BoardObject {
  const char* name;
  const char* mesh_file;
  Axis up;                                 // up axis of the mesh file
  Eigen::Quaterniond mesh_from_pose_file;  // the mesh's axes from the axes of its pose file
};

Expected<RealObject> LoadBoardObject(const fs::path& folder, const BoardObject& board_object) {
  VICTORIOUS_ASSIGN_OR_RETURN(const PinholeCamera camera, ReadCamera(folder / "cam.json"));
  RealObject object{.name = board_object.name, .mesh = {}, .views = {}, .first_camera = {}, .other_views = {}};
  VICTORIOUS_ASSIGN_OR_RETURN(
      object.mesh, ReadMesh(folder / "models" / board_object.name / board_object.mesh_file, board_object.up));
  const fs::path pose_file = folder / "init" / fmt::format("{}.json", board_object.name);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(pose_file));
  VICTORIOUS_ASSIGN_OR_RETURN(const nlohmann::json rows, ParseJson(text));
  VICTORIOUS_ASSIGN_OR_RETURN(const Eigen::Matrix4d first, ParseMatrix(rows, pose_file));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Rigid3> board, ReadBoard(folder / "apriltag_data.json.gz"));
  const Vector3d middle = BoundingBox(object.mesh).center();
  const Rigid3 first_pose =
      RigidFromMatrix(first) * Rigid3{board_object.mesh_from_pose_file.conjugate(), Vector3d::Zero()};
  for (std::size_t i = 0; i < board.size(); ++i) {
    const fs::path path = folder / "frames" / fmt::format("color_image_{:04}.png", i);
    if (!fs::exists(path)) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(const Image image, ReadImage(path));
    const Rigid3 pose = board[i] * board[0].Inverse() * first_pose;
    object.views.push_back(
        {.bgr = image.bgr, .focal_px = camera.fx, .camera_from_object = Rigid3{pose.rotation, pose.Apply(middle)}});
  }
  if (object.views.empty()) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}: no images: expected color_image_NNNN.png", (folder / "frames").string()));
  }
  object.first_camera = {ForImage(camera, object.views.front().bgr), first_pose};
  return object;
}

}  // namespace

Expected<std::vector<RealObject>> LoadRealObjects(const fs::path& data) {
  const fs::path folder = data / "real/recognition";
  std::vector<RealObject> objects;
  VICTORIOUS_ASSIGN_OR_RETURN(objects.emplace_back(), LoadTeaBox(folder / "visp_video/teabox"));
  const BoardObject cube{.name = "cube",
                         .mesh_file = "cube.obj",
                         .up = Axis::kPlusZ,
                         .mesh_from_pose_file = Eigen::Quaterniond::Identity()};
  const BoardObject dragon{.name = "dragon",
                           .mesh_file = "dragon.obj.gz",
                           .up = Axis::kMinusZ,
                           .mesh_from_pose_file = Eigen::Quaterniond(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitX()))};
  for (const BoardObject& board_object : {cube, dragon}) {
    VICTORIOUS_ASSIGN_OR_RETURN(objects.emplace_back(), LoadBoardObject(folder / "visp_cad_multi", board_object));
  }
  return objects;
}

}  // namespace victorious
