#include "victorious/object/model/relit_template_folder.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/small_cad_model.h"
#include "victorious/base/file.h"
#include "victorious/object/model/relit_views.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;
using testing::ScratchFolder;
using testing::SmallCadModel;

constexpr RelitTemplateKey kKey{.sun_view = 2, .view = 3, .half_resolution = true};

std::shared_ptr<const RelitTemplate> Make(const RelitTemplateFolder* folder, const RelitTemplateKey& key = kKey) {
  const std::vector<ObjectModel> models = {SmallCadModel()};
  return MakeRelitViews(models, folder).value().front()->GetTemplate(key).value();
}

// The templates, and whatever else is there.
std::vector<fs::path> Files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().filename() != "tidied") files.push_back(entry.path());
  }
  return files;
}

TEST(RelitTemplateFolder, TemplatesComeBackAsTheyWereMade) {
  const ScratchFolder folder;
  const RelitTemplateFolder templates(folder.path(), "build");
  const auto made = Make(&templates);
  ASSERT_GT(made->features.size(), 10U);
  const std::optional<RelitTemplate> stored = templates.Of(SmallCadModel().id)->Find(kKey);
  ASSERT_TRUE(stored);
  EXPECT_EQ(PackRelitTemplate(*stored), PackRelitTemplate(*made));
  EXPECT_EQ(PackRelitTemplate(*Make(&templates)), PackRelitTemplate(*Make(nullptr)));
  EXPECT_EQ(stored->features.keypoints, made->features.keypoints);
  EXPECT_EQ(stored->shortened.cells, made->shortened.cells);
}

TEST(RelitTemplateFolder, OtherKeysModelsAndBuildsHaveTheirOwn) {
  const ScratchFolder folder;
  const RelitTemplateFolder templates(folder.path(), "build");
  Make(&templates);
  const std::string id = SmallCadModel().id;
  RelitTemplateKey full = kKey;
  full.half_resolution = false;
  EXPECT_FALSE(templates.Of(id)->Find(full));
  EXPECT_FALSE(templates.Of(id)->Find({.sun_view = 3, .view = 2, .half_resolution = true}));
  EXPECT_FALSE(templates.Of(id + "0")->Find(kKey));
  EXPECT_FALSE(RelitTemplateFolder(folder.path(), "other").Of(id)->Find(kKey));
}

TEST(RelitTemplateFolder, DamagedTemplateIsMadeAgain) {
  const ScratchFolder folder;
  const RelitTemplateFolder templates(folder.path(), "build");
  const auto made = Make(&templates);
  const std::vector<fs::path> files = Files(folder.path());
  ASSERT_EQ(files.size(), 1U) << "no parts are left";
  const std::string sound = ReadFile(files[0]).value();
  std::string flipped = sound;
  flipped[sound.size() / 2] ^= 1;
  for (const std::string& damaged : {std::string(), sound.substr(0, sound.size() - 1), sound + "x", flipped}) {
    ASSERT_TRUE(WriteFileAtomically(files[0], damaged));
    EXPECT_FALSE(templates.Of(SmallCadModel().id)->Find(kKey));
    EXPECT_EQ(PackRelitTemplate(*Make(&templates)), PackRelitTemplate(*made));
    EXPECT_EQ(ReadFile(files[0]).value(), sound);
  }
}

TEST(RelitTemplateFolder, OtherBytesComeBackUndamagedOrNotAtAll) {
  const ScratchFolder folder;
  const RelitTemplateFolder templates(folder.path(), "build");
  const auto of_model = templates.Of(SmallCadModel().id);
  const std::vector<std::byte> bytes = {std::byte{1}, std::byte{2}, std::byte{3}};
  EXPECT_FALSE(of_model->FindBytes("shape-1"));
  of_model->PutBytes("shape-1", bytes);
  EXPECT_EQ(of_model->FindBytes("shape-1"), bytes);
  EXPECT_FALSE(of_model->FindBytes("shape-2"));
  EXPECT_FALSE(templates.Of(SmallCadModel().id + "0")->FindBytes("shape-1"));
  const std::vector<fs::path> files = Files(folder.path());
  ASSERT_EQ(files.size(), 1U) << "no parts are left";
  std::string flipped = ReadFile(files[0]).value();
  flipped.back() ^= 1;
  ASSERT_TRUE(WriteFileAtomically(files[0], flipped));
  EXPECT_FALSE(of_model->FindBytes("shape-1"));
}

TEST(RelitTemplateFolder, PlaceThatCannotBeWrittenIsNoError) {
  const ScratchFolder folder;
  const fs::path file = fs::path(folder.path()) / "file";
  ASSERT_TRUE(WriteFileAtomically(file, "x"));
  const RelitTemplateFolder templates(file / "folder", "build");
  EXPECT_EQ(PackRelitTemplate(*Make(&templates)), PackRelitTemplate(*Make(nullptr)));
}

TEST(RelitTemplateFolder, ModelsNotUsedForTheLongestTimeAreRemovedFirst) {
  const ScratchFolder folder;
  const fs::path path = folder.path();
  const auto made = Make(nullptr);
  const auto bytes = static_cast<std::int64_t>(PackRelitTemplate(*made).size());
  const RelitTemplateFolder templates(path, "build");
  // Returns the folder of a model that was used so long ago.
  const auto put = [&](const char* model, int hours) {
    const std::vector<fs::path> before = Files(path);
    templates.Of(model)->Put(kKey, *made);
    std::vector<fs::path> added = Files(path);
    std::erase_if(added, [&](const fs::path& one) { return std::ranges::find(before, one) != before.end(); });
    const fs::path of_model = added.at(0).parent_path();
    fs::last_write_time(of_model, fs::file_time_type::clock::now() - std::chrono::hours(hours));
    return of_model;
  };
  const fs::path old = put("old", 3);
  const fs::path recent = put("new", 1);
  const fs::path oldest = put("oldest", 5);
  ASSERT_TRUE(WriteFileAtomically(path / "anybody's", std::string(1000, 'x')));
  const RelitTemplateFolder soon(path, "build", bytes);
  EXPECT_TRUE(fs::exists(oldest)) << "looked through within the hour";
  fs::remove(path / "tidied");
  const RelitTemplateFolder later(path, "build", 2 * bytes);
  EXPECT_FALSE(fs::exists(oldest));
  EXPECT_TRUE(fs::exists(old));
  EXPECT_TRUE(fs::exists(recent));
  EXPECT_TRUE(fs::exists(path / "anybody's"));
}

}  // namespace
}  // namespace victorious
