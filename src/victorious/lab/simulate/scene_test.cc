#include "victorious/lab/simulate/scene.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"

namespace victorious {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string ErrorOf(std::string_view text) {
  const Expected<Scene> scene = ParseScene(text, "town.json");
  if (scene) return "(accepted)";
  EXPECT_EQ(scene.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(scene.error().message, ::testing::StartsWith("town.json: "));
  return scene.error().message;
}

TEST(Scene, EmptyObjectGivesDefaults) {
  const Expected<Scene> scene = ParseScene("{}", "town.json");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->video.width, 640);
  EXPECT_EQ(scene->camera.range_m, std::vector<double>{110});
  EXPECT_TRUE(scene->objects.empty());
}

TEST(Scene, ReadsEverySection) {
  const Expected<Scene> scene = ParseScene(R"({
    "seed": 9, "video": {"frames": 12, "noise": 0.1},
    "origin": {"latitude_deg": 42.5, "heading_deg": 17}, "sun": {"elevation_deg": 30},
    "camera": {"path": "smooth", "aim_m": [[1, 2], [3, 4]], "from_deg": [10, 370], "range_m": 90, "shake_deg": 0.2},
    "objects": [{"id": "jeep-1", "model": "jeep", "x_m": 5, "y_m": 6, "heading_deg": 90},
                {"id": "tank-1", "model": "tank", "path_m": [[0, 0], [9, 0]], "speed_m_s": 3}],
    "pieces": [{"asset": "town/trees/oak", "x_m": 1, "y_m": 2}],
    "town": {"seed": 4, "squares": [0, -1, 2, 3], "tiles": [{"tile": "apron", "column": 1, "row": 2, "turns": 3}]}})",
                                           "town.json");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->seed, 9U);
  EXPECT_EQ(scene->camera.aim_m[1], Eigen::Vector2d(3, 4));
  EXPECT_EQ(scene->camera.from_deg[1], 370);
  EXPECT_EQ(scene->camera.range_m, std::vector<double>{90});
  EXPECT_EQ(scene->objects[0].heading_deg, 90);
  EXPECT_EQ(scene->objects[1].path_m.size(), 2U);
  EXPECT_EQ(scene->pieces[0].asset, "town/trees/oak");
  EXPECT_EQ(scene->town.squares[3], 3);
  EXPECT_EQ(scene->town.tiles[0].turns, 3);
}

TEST(Scene, PathsAreRelativeToTheSceneFile) {
  const testing::ScratchFolder folder;
  std::ofstream(folder / "scene.json") << R"({"assets": "objects"})";
  const Expected<Scene> scene = ReadScene(folder / "scene.json");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->assets, folder / "objects");
  EXPECT_EQ(scene->folder, folder.path());
}

TEST(Scene, ErrorsNameTheKey) {
  EXPECT_THAT(ErrorOf("[1]"), HasSubstr("not a JSON object"));
  EXPECT_THAT(ErrorOf("{\"seed\": "), HasSubstr("not JSON"));
  EXPECT_THAT(ErrorOf(R"({"video": {"fps": 5, "fps": 6}})"), HasSubstr("\"fps\": given twice"));
  EXPECT_THAT(ErrorOf(R"({"viedo": {}})"), HasSubstr("viedo"));
  EXPECT_THAT(ErrorOf(R"({"video": {"frame": 3}})"), AllOf(HasSubstr("video.frame"), HasSubstr("video.frames")));
  EXPECT_THAT(ErrorOf(R"({"video": {"noise": 0.7}})"), AllOf(HasSubstr("video.noise"), HasSubstr("0 to 0.5")));
  EXPECT_THAT(ErrorOf(R"({"video": {"width": 641}})"), HasSubstr("even"));
  EXPECT_THAT(ErrorOf(R"({"video": {"width": "wide"}})"), HasSubstr("whole number"));
  EXPECT_THAT(ErrorOf(R"({"camera": {"path": "zigzag"}})"), HasSubstr("linear, smooth"));
  EXPECT_THAT(ErrorOf(R"({"camera": {"aim_m": [1, 2]}})"), HasSubstr("[x, y]"));
  EXPECT_THAT(ErrorOf(R"({"camera": {"range_m": [100, -3]}})"), HasSubstr("range_m"));
  EXPECT_THAT(ErrorOf(R"({"camera": 3})"), HasSubstr("camera"));
  EXPECT_THAT(ErrorOf(R"({"town": {"squares": [3, 0, 1, 0]}})"), HasSubstr("squares"));
}

TEST(Scene, RefusesNull) {
  for (const std::string key : {"camera", "town", "objects", "pieces", "seed", "video", "sun"}) {
    EXPECT_THAT(ErrorOf("{\"" + key + "\": null}"), HasSubstr(key));
  }
  for (const std::string key : {"aim_m", "from_deg", "off_nadir_deg", "range_m", "roll_deg", "path"}) {
    EXPECT_THAT(ErrorOf(R"({"camera": {")" + key + R"(": null}})"), HasSubstr(key));
  }
  for (const std::string key : {"squares", "tiles", "density"}) {
    EXPECT_THAT(ErrorOf(R"({"town": {")" + key + R"(": null}})"), HasSubstr(key));
  }
  for (const std::string key : {"id", "model", "file", "path_m", "x_m"}) {
    EXPECT_THAT(ErrorOf(R"({"objects": [{")" + key + R"(": null}]})"), AllOf(HasSubstr("objects[0]"), HasSubstr(key)));
  }
}

TEST(Scene, TilesHaveDistinctSquares) {
  EXPECT_THAT(ErrorOf(R"({"town": {"tiles": [{"tile": "apron", "column": 5}, {"tile": "park", "column": 6}]}})"),
              AllOf(HasSubstr("tiles[1]"), HasSubstr("(6, 0)"), HasSubstr("columns -5 to 5, rows -4 to 4")));
  EXPECT_THAT(ErrorOf(R"({"town": {"squares": [0, 1, 0, 1], "tiles": [{"tile": "apron"}]}})"),
              HasSubstr("rows 1 to 1"));
  EXPECT_THAT(ErrorOf(R"({"town": {"tiles": [{"tile": "apron", "row": 2}, {"tile": "park", "row": 2}]}})"),
              AllOf(HasSubstr("tiles[1]"), HasSubstr("park"), HasSubstr("(0, 2)"), HasSubstr("another")));
}

TEST(Scene, ErrorsNameTheObject) {
  EXPECT_THAT(ErrorOf(R"({"objects": [{"id": "a", "model": "jeep"}, {"id": "b"}]})"),
              AllOf(HasSubstr("objects[1]"), HasSubstr("model")));
  EXPECT_THAT(ErrorOf(R"({"objects": [{"model": "jeep"}]})"), HasSubstr("id"));
  EXPECT_THAT(ErrorOf(R"({"objects": [{"id": "a", "model": "jeep"}, {"id": "a", "model": "tank"}]})"),
              HasSubstr("two have the id \"a\""));
  EXPECT_THAT(ErrorOf(R"({"objects": [{"id": "a", "model": "jeep", "speed_m_s": 4}]})"), HasSubstr("path_m"));
  EXPECT_THAT(ErrorOf(R"({"objects": [{"id": "a", "model": "jeep", "x_m": 4, "path_m": [[0, 0], [1, 1]]}]})"),
              AllOf(HasSubstr("x_m"), HasSubstr("path_m")));
  EXPECT_THAT(ErrorOf(R"({"objects": [{"id": "a", "model": "jeep", "path_m": [[0, 0]]}]})"), HasSubstr("2 or more"));
  EXPECT_THAT(ErrorOf(R"({"objects": [{"id": "a", "model": "jeep", "times_s": [0, 1]}]})"), HasSubstr("path_m"));
  EXPECT_THAT(ErrorOf(R"({"objects": [{"id": "a", "model": "jeep", "path_m": [[0, 0], [1, 1]], "times_s": [1, 1]}]})"),
              AllOf(HasSubstr("times_s"), HasSubstr("increase")));
  EXPECT_THAT(ErrorOf(R"({"objects": [{"id": "a", "model": "jeep", "path_m": [[0, 0], [1, 1]], "times_s": [0, 1],
                          "speed_m_s": 2}]})"),
              AllOf(HasSubstr("times_s"), HasSubstr("speed_m_s")));
  EXPECT_THAT(ErrorOf(R"({"objects": [{"id": "a", "model": "jeep", "path_m": [[2, 3], [2, 3], [2, 3]]}]})"),
              AllOf(HasSubstr("path_m"), HasSubstr("two different points")));
  EXPECT_THAT(ErrorOf(R"({"objects": {}})"), HasSubstr("objects: must be a list"));
}

TEST(Scene, AssetsStayInsideTheirFolder) {
  EXPECT_THAT(ErrorOf(R"({"pieces": [{"asset": "../../etc/passwd"}]})"), HasSubstr("asset"));
  EXPECT_THAT(ErrorOf(R"({"town": {"tiles": [{"tile": ""}]}})"), AllOf(HasSubstr("tiles[0]"), HasSubstr("tile")));
  EXPECT_THAT(ErrorOf(R"({"objects": [{"id": "a", "model": "../jeep"}]})"), HasSubstr("model"));
}

}  // namespace
}  // namespace victorious
