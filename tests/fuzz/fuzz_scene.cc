// Fuzzes the scene reader: it reads the scene or fails with a one-line error; a scene read must have a town and a valid
// camera everywhere on its path.
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/lab/simulate/flight_path.h"
#include "victorious/lab/simulate/scene.h"
#include "victorious/lab/simulate/town.h"

using victorious::Scene;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto parsed = victorious::ParseScene({reinterpret_cast<const char*>(data), size}, "scene.json");
  if (!parsed) {
    VICTORIOUS_CHECK(parsed.error().code == victorious::ErrorCode::kInvalidArgument);
    VICTORIOUS_CHECK(parsed.error().message.find('\n') == std::string::npos);
    return 0;
  }
  const Scene& scene = *parsed;
  for (const double fraction : {0.0, 0.37, 1.0}) {
    const victorious::Rigid3 camera = victorious::CameraFromTown(scene.camera, fraction, 12.5, scene.seed);
    VICTORIOUS_CHECK(camera.translation.allFinite() && std::abs(camera.rotation.norm() - 1) < 1e-9);
    for (const victorious::SceneObject& object : scene.objects) {
      VICTORIOUS_CHECK(victorious::ComputeGroundPose(object, 4, 30 * fraction).place_m.allFinite());
    }
  }
  victorious::SceneTown town = scene.town;
  town.squares = {-2, -2, 2, 2};  // small enough to be fast
  for (const victorious::Placement& placement : victorious::LayOutTown(town)) {
    VICTORIOUS_CHECK(placement.place_m.allFinite() && placement.asset.starts_with("town/"));
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  const std::string plain =
      R"({"seed": 9, "assets": "../assets", "video": {"frames": 12, "fps": 10, "noise": 0.1, "blur_px": 0.5},)"
      R"( "origin": {"latitude_deg": 42.5, "heading_deg": 17}, "sun": {"elevation_deg": 30, "strength": 0.5},)"
      R"( "camera": {"path": "smooth", "aim_m": [[1, 2], [3, 4], [5, 1]], "from_deg": [10, 370], "range_m": 90}})";
  const std::string objects =
      R"({"objects": [{"id": "jeep-1", "model": "jeep", "x_m": 5, "y_m": 6, "heading_deg": 90},)"
      R"( {"id": "tank-1", "model": "tank", "path_m": [[0, 0], [9, 0], [9, 9]], "speed_m_s": 3}],)"
      R"( "pieces": [{"asset": "town/trees/oak", "x_m": 1, "y_m": 2}]})";
  const std::string town =
      R"({"town": {"seed": 4, "density": 1, "squares": [0, -1, 2, 3],)"
      R"( "tiles": [{"tile": "apron", "column": 1, "row": 2, "turns": 3}]}, "camera": {"shake_deg": 2}})";
  return {plain,
          objects,
          town,
          R"({"objects": [{"id": "a", "model": "b", "file": "c.glb", "path_m": [[0, 0], [0, 0]], "speed_m_s": 400}]})",
          R"({"video": {"width": 1e300, "fps": -0.0}, "camera": {"aim_m": [[1e308, 1]], "range_m": []}})",
          "[[[[[[[[",
          "{}"};
}
