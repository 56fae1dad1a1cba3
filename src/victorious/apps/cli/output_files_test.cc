#include "victorious/apps/cli/output_files.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "testing/photo_file.h"
#include "victorious/apps/cli/argument_parser.h"
#include "victorious/show/export/export_coco.h"
#include "victorious/show/export/export_cot.h"
#include "victorious/show/export/export_gpkg.h"
#include "victorious/show/export/export_lines.h"
#include "victorious/show/export/export_map.h"
#include "victorious/show/export/export_mot.h"

namespace victorious::cli {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kPng = "\x89PNG\r\n\x1A\n....IHDR and the rest";
const std::string kSighting = R"({"object_id":1,"model":"box-1","video":"a.mp4","frame":3,"box":[1,2,3,4]})"
                              "\n";

// A command with the input VIDEO, the output --out and the model folder --models, in a folder of its own.
class OutputFilesTest : public ::testing::Test {
 protected:
  OutputFilesTest() : folder_(fs::temp_directory_path() / ("output_files_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
    parser_.Add("NAME", name_);
    parser_.Add("VIDEO", video_);
    parser_.Add("--models", models_).TypeName("DIR");
    parser_.Add("--out", out_).TypeName("FILE");
    parser_.Add("--type", type_).TypeName("WORD");
    AddForce(parser_);
  }
  ~OutputFilesTest() override { fs::remove_all(folder_); }

  std::string Write(const std::string& name, const std::string& content) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return (folder_ / name).string();
  }
  [[nodiscard]] std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  [[nodiscard]] const ArgumentParser& Parser() const { return parser_; }

  // The message of CheckOutputs for these arguments; empty if they are accepted.
  std::string Message(const std::vector<std::string>& arguments, OutputKind kind = &kSightingsFormat,
                      const std::vector<std::string>& further_inputs = {}) {
    EXPECT_TRUE(ParseArguments(parser_, arguments));
    const Status checked = CheckOutputs(parser_, {{"--out", out_, kind}}, further_inputs);
    return checked ? "" : checked.error().message;
  }

 private:
  fs::path folder_;
  ProgramParser parser_{"command", "Writes a file"};
  std::string name_;
  std::string video_;
  std::string models_;
  std::string out_;
  std::string type_;
};

TEST_F(OutputFilesTest, RefusesAnInputByAnyOfItsNames) {
  const std::string video = Write("w.mp4", kSighting);  // of the right kind, so that only the first rule applies
  fs::create_symlink(video, Path("symbolic"));
  fs::create_hard_link(video, Path("hard"));
  for (const std::string& out : {video, Path("./w.mp4"), Path("symbolic"), Path("hard")}) {
    EXPECT_THAT(Message({"n", video, "--out", out}),
                AllOf(HasSubstr("--out " + out), HasSubstr("VIDEO " + video), HasSubstr("another name")));
    EXPECT_THAT(Message({"n", video, "--out", out, "--force"}), HasSubstr("input"));
    EXPECT_THAT(Message({"n", "other", "--out", out}, &kSightingsFormat, {video}), HasSubstr("input"));
  }
  EXPECT_EQ(Message({"n", video, "--out", Path("new")}), "");
}

TEST_F(OutputFilesTest, RefusesTheFilesOfAFolderAndThePartsOfAnIndex) {
  const std::string frame = Write("frames/1.png", kPng);
  const std::string wal = Write("index.db-wal", kSighting);
  EXPECT_THAT(Message({"n", Path("frames"), "--out", frame}, FileKind::kImage), HasSubstr("input"));
  EXPECT_EQ(Message({"n", Path("frames"), "--out", Path("2.png")}, FileKind::kImage), "");
  EXPECT_THAT(Message({"n", Path("index.db"), "--out", wal}), HasSubstr("input"));
}

TEST_F(OutputFilesTest, OfAModelFolderOnlyTheModelsAreInputs) {
  const std::string drawing = Write("models/drawing.png", kPng);
  const std::string model = Write("models/crate.vmodel", kPng);
  EXPECT_EQ(Message({"n", "v", "--models", Path("models"), "--out", drawing}, FileKind::kImage), "");
  EXPECT_THAT(Message({"n", "v", "--models", Path("models"), "--out", model}, FileKind::kImage), HasSubstr("input"));
}

TEST_F(OutputFilesTest, AWordThatIsAlsoAFileIsNoInput) {
  const std::string out = Write("crate", kSighting);
  EXPECT_EQ(Message({out, "v", "--type", out, "--out", out}), "");
}

TEST_F(OutputFilesTest, ReplacesOnlyItsOwnKindWithoutForce) {
  const std::string notes = Write("notes.txt", "my notes\n");
  EXPECT_THAT(Message({"n", "v", "--out", notes}),
              AllOf(HasSubstr("--out " + notes), HasSubstr("list of sightings"), HasSubstr("--force")));
  EXPECT_EQ(Message({"n", "v", "--out", notes, "--force"}), "");
  EXPECT_EQ(Message({"n", "v", "--out", Write("empty", "")}), "");
  EXPECT_EQ(Message({"n", "v", "--out", Write("before.jsonl", kSighting)}), "");
  EXPECT_EQ(Message({"n", "v", "--out", "/dev/null"}), "");
  EXPECT_EQ(Message({"n", "/dev/null", "--out", "/dev/null"}), "");
  EXPECT_EQ(Message({"n", "v", "--out", "-"}), "");
}

TEST_F(OutputFilesTest, TwoOutputsAreTwoFiles) {
  const auto message = [&](const std::string& out, const std::string& draw) {
    const Status checked =
        CheckOutputs(Parser(), {{"--out", out, &kSightingsFormat}, {"--draw", draw, &kSightingsFormat}});
    return checked ? "" : checked.error().message;
  };
  const std::string made = Write("made", kSighting);
  fs::create_symlink("new", Path("dangling"));
  fs::create_hard_link(made, Path("hard"));
  for (const auto& [out, draw] : std::vector<std::pair<std::string, std::string>>{
           {Path("new"), Path("new")},
           {Path("new"), Path("none/../new")},
           {Path("new"), Path("dangling")},
           {made, Path("hard")},
       }) {
    EXPECT_THAT(message(out, draw), AllOf(HasSubstr("--draw " + draw), HasSubstr("same file as --out " + out)));
  }
  EXPECT_EQ(message(Path("new"), Path("other")), "");
  EXPECT_EQ(message(Path("new"), made), "");
  EXPECT_EQ(message("-", "-"), "");
  EXPECT_EQ(message("", ""), "");
  EXPECT_EQ(message("/dev/null", "/dev/null"), "");
}

TEST_F(OutputFilesTest, KnowsEachKindByItsContent) {
  const std::vector<std::pair<OutputKind, std::string>> contents = {
      {FileKind::kImage, kPng},
      {&kObjectsFormat, R"({"object_id":1,"rank":1,"first_time_s":0.5})"},
      {&kSightingsFormat, kSighting},
      {&kMotFormat, "1,2,3.00,4.00,5.00,6.00,0.9000,-1,-1,-1\n"},
      {&kCocoFormat, R"({"categories":[],"annotations":[],"images":[]})"},
      {&kGeoJsonFormat, R"({"type":"FeatureCollection","features":[]})"},
      {&kKmlFormat, "<?xml version=\"1.0\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\">"},
      {&kCotFormat, "<event version=\"2.0\" uid=\"victorious-0-1\" type=\"a-u-G\">"},
      {&kGpkgFormat, std::string("SQLite format 3\0", 16) + std::string(52, '\0') + "GPKG and the rest"},
      {FileKind::kCameraTable, "time_s,latitude_deg,longitude_deg\n0,52,13\n"},
      {FileKind::kTelemetryReport, R"({"format":"csv","records":1,"states":[]})"},
      {FileKind::kFeatures, "2 128\n1 2 3 4\n"},
      {FileKind::kCategoryModel, "\x8AVCAT\r\n\x1A and the rest"},
  };
  for (const auto& [content_kind, content] : contents) {
    const std::string out = Write("existing", content);
    for (const auto& [kind, unused] : contents) {
      EXPECT_EQ(Message({"n", "v", "--out", out}, kind).empty(), kind == content_kind) << content;
    }
  }
}

TEST_F(OutputFilesTest, PhotosAreNotReplaced) {
  const std::string jpeg = "\xFF\xD8\xFF\xE0....JFIF and the rest";
  for (const std::string& own : {kPng, jpeg}) {
    EXPECT_EQ(Message({"n", "v", "--out", Write("own", own)}, FileKind::kImage), "");
  }
  for (const std::string& photo :
       {testing::PhotoHead({}), testing::PhotoHead({.xmp = testing::DjiXmp(0, -60, 500, 60)}),
        std::string("II*\0....", 8), kPng + "....eXIfII*....IDAT", kPng + "....iTXtXML:com.adobe.xmp...."}) {
    const std::string path = Write("photo", photo);
    EXPECT_THAT(Message({"n", "v", "--out", path}, FileKind::kImage),
                AllOf(HasSubstr("--out " + path), HasSubstr("EXIF"), HasSubstr("--force")));
    EXPECT_EQ(Message({"n", "v", "--out", path, "--force"}, FileKind::kImage), "");
  }
}

TEST_F(OutputFilesTest, AFolderOfASimulationHasItsTruth) {
  const std::string video = Write("flight/video.mp4", "footage");
  EXPECT_THAT(Message({"n", "v", "--out", video}, FileKind::kSimulation), HasSubstr("truth.jsonl"));
  Write("flight/truth.jsonl", "somebody's truth\n");
  EXPECT_THAT(Message({"n", "v", "--out", video}, FileKind::kSimulation), HasSubstr("truth.jsonl"));
  Write("flight/truth.jsonl", R"({"frame":0,"object":"a","visible":1})");
  EXPECT_EQ(Message({"n", "v", "--out", video}, FileKind::kSimulation), "");
}

}  // namespace
}  // namespace victorious::cli
