#include "victorious/object/model/model_library.h"

#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/drawn_objects.h"
#include "victorious/base/file.h"
#include "victorious/object/model/photo_model.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::ScratchFolder;

Photo MakePhoto() {
  const cv::Mat image = testing::DrawObject(testing::ObjectKind::kCrate, 3).image;
  cv::Mat bgr(image.size(), CV_8UC3);
  cv::Mat alpha(image.size(), CV_8UC1);
  cv::Mat parts[] = {bgr, alpha};
  const int from_to[] = {0, 0, 1, 1, 2, 2, 3, 3};
  cv::mixChannels(&image, 1, parts, 2, from_to, 4);
  return PreparePhoto("crate.png", bgr, alpha, std::nullopt).value();
}

ObjectModel MakeModel(const std::string& name) {
  const Photo photo = MakePhoto();
  return MakePhotoModel(name, std::span(&photo, 1), 1.2, {}).value();
}

void ExpectError(const Error& error, ErrorCode code, const std::string& words) {
  EXPECT_EQ(error.code, code) << error.message;
  EXPECT_THAT(error.message, AllOf(HasSubstr(words), Not(HasSubstr("\n"))));
}

TEST(ModelLibrary, AddedModelIsLoaded) {
  const ScratchFolder folder;
  const ModelLibrary library(folder / "new/models");
  const ObjectModel made = MakeModel("crate");
  const Status added = library.Add(made);
  ASSERT_TRUE(added) << added.error().message;
  const Expected<ObjectModel> model = library.Load("crate");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->name, "crate");
  EXPECT_FALSE(model->id.empty());
  EXPECT_EQ(model->engine, made.engine);
  EXPECT_EQ(model->options_json, made.options_json);
  EXPECT_EQ(model->length_m, 1.2);
  ASSERT_EQ(model->features.size(), made.features.size());
  EXPECT_TRUE(std::ranges::equal(model->features.keypoints, made.features.keypoints));
  EXPECT_TRUE(std::ranges::equal(model->features.descriptors, made.features.descriptors));
  EXPECT_EQ(model->views.at(0).outline.size(), made.views.at(0).outline.size());
}

TEST(ModelLibrary, ListsByName) {
  const ScratchFolder folder;
  const ModelLibrary library(folder.path());
  EXPECT_THAT(library.Names().value(), IsEmpty());
  for (const char* name : {"truck", "Crate", "sign-2", "_sign", "7up", "a.b"})
    ASSERT_TRUE(library.Add(MakeModel(name)));
  std::ofstream(folder / "notes.txt") << "not a model";
  EXPECT_THAT(library.Names().value(), ElementsAre("7up", "Crate", "_sign", "a.b", "sign-2", "truck"));
  const Expected<std::vector<ObjectModel>> models = library.LoadAll();
  ASSERT_TRUE(models) << models.error().message;
  std::vector<std::string> names;
  for (const ObjectModel& model : *models) names.push_back(model.name);
  EXPECT_EQ(names, library.Names().value());
}

TEST(ModelLibrary, NamesMustBeFileNames) {
  const ScratchFolder folder;
  const ModelLibrary library(folder / "models");
  for (const std::string& name : {std::string(), std::string("a/b"), std::string("../a"), std::string(".hidden"),
                                  std::string("-rf"), std::string("two words"), std::string("naïve"),
                                  std::string("a\tb"), std::string("a\0b", 3), std::string(101, 'a')}) {
    ObjectModel model = MakeModel("crate");
    model.name = name;
    for (const Status& status : {library.CheckNewName(name), library.Add(model), library.Remove(name)}) {
      ASSERT_FALSE(status) << name;
      ExpectError(status.error(), ErrorCode::kInvalidArgument, "letters, digits");
    }
    const Expected<ObjectModel> loaded = library.Load(name);
    ASSERT_FALSE(loaded);
    ExpectError(loaded.error(), ErrorCode::kInvalidArgument, "letters, digits");
  }
  EXPECT_FALSE(fs::exists(folder / "models")) << "nothing was added";
  EXPECT_TRUE(library.CheckNewName(std::string(100, 'a')));
}

// Before minutes of rendering.
TEST(ModelLibrary, AFileIsNoFolderOfModels) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteFileAtomically(folder / "notes.txt", "notes"));
  for (const fs::path& path : {folder / "notes.txt", folder / "notes.txt" / "models"}) {
    const Status status = ModelLibrary(path).CheckNewName("crate");
    ASSERT_FALSE(status) << path;
    ExpectError(status.error(), ErrorCode::kInvalidArgument, "notes.txt: is a file");
  }
  EXPECT_TRUE(ModelLibrary(folder / "new" / "models").CheckNewName("crate"));
}

TEST(ModelLibrary, DuplicateNameIsRefusedAndTheModelKept) {
  const ScratchFolder folder;
  const ModelLibrary library(folder.path());
  ASSERT_TRUE(library.Add(MakeModel("crate")));
  const std::string before = ReadFile(folder / "crate.vmodel").value();
  for (const Status& status : {library.CheckNewName("crate"), library.Add(MakeModel("crate"))}) {
    ASSERT_FALSE(status);
    ExpectError(status.error(), ErrorCode::kAlreadyExists, "model crate is already in " + folder.path().string());
  }
  EXPECT_EQ(ReadFile(folder / "crate.vmodel").value(), before);
}

TEST(ModelLibrary, RemovesOneModelOnly) {
  const ScratchFolder folder;
  const ModelLibrary library(folder.path());
  ASSERT_TRUE(library.Add(MakeModel("crate")));
  ASSERT_TRUE(library.Add(MakeModel("truck")));
  ASSERT_TRUE(library.Remove("crate"));
  EXPECT_THAT(library.Names().value(), ElementsAre("truck"));
  const Status again = library.Remove("crate");
  ASSERT_FALSE(again);
  ExpectError(again.error(), ErrorCode::kNotFound, "there are: truck");
  const Expected<ObjectModel> loaded = library.Load("crate");
  ASSERT_FALSE(loaded);
  ExpectError(loaded.error(), ErrorCode::kNotFound, "there are: truck");
  EXPECT_TRUE(library.Add(MakeModel("crate"))) << "the name is free again";
}

TEST(ModelLibrary, RenamedFileHasItsNewName) {
  const ScratchFolder folder;
  const ModelLibrary library(folder.path());
  ASSERT_TRUE(library.Add(MakeModel("crate")));
  fs::rename(folder / "crate.vmodel", folder / "box.vmodel");
  EXPECT_EQ(library.Load("box").value().name, "box");
}

TEST(ModelLibrary, ErrorNamesCorruptFile) {
  const ScratchFolder folder;
  const ModelLibrary library(folder.path());
  ASSERT_TRUE(library.Add(MakeModel("crate")));
  std::string bytes = ReadFile(folder / "crate.vmodel").value();
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  ASSERT_TRUE(WriteFileAtomically(folder / "flipped.vmodel", bytes));
  ASSERT_TRUE(WriteFileAtomically(folder / "cut.vmodel", bytes.substr(0, bytes.size() / 3)));
  ASSERT_TRUE(WriteFileAtomically(folder / "empty.vmodel", ""));
  for (const char* name : {"flipped", "cut", "empty"}) {
    const Expected<ObjectModel> model = library.Load(name);
    ASSERT_FALSE(model);
    ExpectError(model.error(), ErrorCode::kDataLoss, std::string(name) + ".vmodel");
  }
  EXPECT_FALSE(library.LoadAll());
  EXPECT_TRUE(library.Load("crate")) << "the others remain readable";
  EXPECT_TRUE(library.Remove("cut"));
}

TEST(ModelLibrary, ErrorNamesMissingFolder) {
  const ScratchFolder folder;
  const ModelLibrary library(folder / "none");
  const Expected<std::vector<std::string>> names = library.Names();
  ASSERT_FALSE(names);
  ExpectError(names.error(), ErrorCode::kNotFound, (folder / "none").string());
  for (const Error& error :
       {library.Load("crate").error(), library.LoadAll().error(), library.Remove("crate").error()}) {
    ExpectError(error, ErrorCode::kNotFound, (folder / "none").string());
  }
  std::ofstream(folder / "file") << "not a folder";
  const Status added = ModelLibrary(folder / "file").Add(MakeModel("crate"));
  ASSERT_FALSE(added);
  ExpectError(added.error(), ErrorCode::kInvalidArgument, (folder / "file").string());
}

TEST(ModelLibrary, ReplaceWritesInThePlaceOfTheOld) {
  const ScratchFolder folder;
  const ModelLibrary library(folder.path());
  ASSERT_TRUE(library.Add(MakeModel("crate")));
  const ObjectModel known = library.Load("crate").value();
  const Photo photo = MakePhoto();
  const FeatureSet features = ExtractObjectFeatures(photo, *MakeFeatureExtractor({}).value(), {}).value();
  ASSERT_TRUE(library.Replace(WithView(known, photo, features).value()));
  const ObjectModel now = library.Load("crate").value();
  EXPECT_EQ(now.views.size(), 2U);
  EXPECT_EQ(now.features.size(), 2 * known.features.size());
  EXPECT_NE(now.id, known.id);
}

}  // namespace
}  // namespace victorious
