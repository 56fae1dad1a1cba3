#include "victorious/category/finder/detection_list.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/base/file.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

void ExpectBox(const ListedBox& one, const Box& box) {
  EXPECT_DOUBLE_EQ(one.box.x, box.x);
  EXPECT_DOUBLE_EQ(one.box.y, box.y);
  EXPECT_DOUBLE_EQ(one.box.width, box.width);
  EXPECT_DOUBLE_EQ(one.box.height, box.height);
}

std::string ErrorOf(const Expected<DetectionList>& list) { return list ? "no error" : list.error().message; }

constexpr std::string_view kCoco = R"({
  "categories": [{"id": 3, "name": "car"}, {"id": 8, "name": "truck"}],
  "videos": [{"id": 1, "name": "a.mp4"}, {"id": 2, "name": "flights/b.mp4"}],
  "images": [{"id": 10, "video_id": 1, "frame_index": 4}, {"id": 11, "video_id": 2, "frame_index": 7}],
  "annotations": [
    {"image_id": 10, "category_id": 3, "bbox": [1, 2, 30, 40], "score": 0.7, "track_id": 5},
    {"image_id": 11, "category_id": 8, "bbox": [5, 6, 7.5, 8]},
    {"image_id": 11, "category_id": 9, "bbox": [5, 6, 0, 8]}]})";

TEST(CocoDetections, AreThoseOfTheVideoByItsName) {
  const auto list = ParseCocoDetections(kCoco, "d.json", "/data/a.mp4", {});
  ASSERT_TRUE(list) << list.error().message;
  EXPECT_THAT(list->classes, ElementsAre("car"));
  ASSERT_EQ(list->CountBoxes(), 1U);
  const ListedBox& one = list->frames.at(4).front();
  ExpectBox(one, {1, 2, 30, 40});
  EXPECT_DOUBLE_EQ(one.score, 0.7);
  EXPECT_EQ(one.track, 5);
  const auto other = ParseCocoDetections(kCoco, "d.json", "b.mp4", {});
  ASSERT_TRUE(other) << other.error().message;
  EXPECT_EQ(other->CountBoxes(), 1U);  // the box without a width is none
  EXPECT_DOUBLE_EQ(other->frames.at(7).front().score, 1);
  EXPECT_THAT(ErrorOf(ParseCocoDetections(kCoco, "d.json", "c.mp4", {})),
              HasSubstr("d.json: has boxes of 2 videos, none of them named c.mp4"));
}

TEST(CocoDetections, TakeFramesFromFileNamesAndResultsByImageId) {
  const auto named = ParseCocoDetections(
      R"({"categories":[{"id":1,"name":"boat"}],"images":[{"id":1,"file_name":"f/frame_000012.png"}],
          "annotations":[{"image_id":1,"category_id":1,"bbox":[1,2,3,4],"attributes":{"track_id":9}}]})",
      "d.json", "v.mp4", {});
  ASSERT_TRUE(named) << named.error().message;
  EXPECT_EQ(named->frames.at(12).front().track, 9);
  const auto results =
      ParseCocoDetections(R"([{"image_id":3,"category_id":2,"bbox":[1,2,3,4],"score":1.5}])", "d.json", "v.mp4", {});
  ASSERT_TRUE(results) << results.error().message;
  EXPECT_THAT(results->classes, ElementsAre("class-2"));
  EXPECT_DOUBLE_EQ(results->frames.at(3).front().score, 1);
}

TEST(CocoDetections, NameWhatIsWrong) {
  const auto error = [](std::string_view text) { return ErrorOf(ParseCocoDetections(text, "d.json", "v.mp4", {})); };
  EXPECT_THAT(error("{"), HasSubstr("d.json: not JSON"));
  EXPECT_THAT(error("{}"), HasSubstr("no `annotations`"));
  EXPECT_THAT(error(R"({"images":[{"id":1,"file_name":"a.png"}],"annotations":[{"image_id":1,"bbox":[1,2,3,4]}]})"),
              HasSubstr("image 1: which frame it is cannot be told"));
  EXPECT_THAT(error(R"([{"image_id":1,"bbox":[1,2,3]}])"), HasSubstr("annotation 0: must have"));
  EXPECT_THAT(error(R"([{"image_id":-1,"bbox":[1,2,3,4]}])"), HasSubstr("image_id -1 is no frame"));
  EXPECT_THAT(error(R"([{"image_id":18446744073709551615,"bbox":[1,2,3,4]}])"), HasSubstr("annotation 0: must have"));
  EXPECT_THAT(error(R"([{"image_id":1,"category_id":"car","bbox":[1,2,3,4]}])"), HasSubstr("`category_id` must be"));
  EXPECT_THAT(error(R"({"images":[],"annotations":[{"image_id":1,"bbox":[1,2,3,4]}]})"),
              HasSubstr("there is no image 1"));
}

TEST(MotDetections, AreReadWithAndWithoutClasses) {
  const auto list = ParseMotDetections("1,7,10,20,30,40,0.5,-1,-1,-1\n\n3,-1,1,2,3,4,-1,-1,-1,-1\r\n", "d.txt", {});
  ASSERT_TRUE(list) << list.error().message;
  EXPECT_THAT(list->classes, ElementsAre("object"));
  const ListedBox& one = list->frames.at(1).front();
  ExpectBox(one, {10, 20, 30, 40});
  EXPECT_EQ(one.track, 7);
  EXPECT_DOUBLE_EQ(one.score, 0.5);
  EXPECT_FALSE(list->frames.at(3).front().track);
  EXPECT_DOUBLE_EQ(list->frames.at(3).front().score, 1);
  const std::vector<std::string> names = {"none", "person", "car"};
  const auto truth = ParseMotDetections("1,1,1,1,2,2,1,2,1\n1,2,1,1,2,2,0,1,1\n1,3,1,1,2,2,1,9,1\n", "d.txt", names);
  ASSERT_TRUE(truth) << truth.error().message;
  EXPECT_THAT(truth->classes, ElementsAre("car", "class-9"));
  EXPECT_THAT(ErrorOf(ParseMotDetections("1,1,1,1,2,2,1\n1,1,x,1,2,2,1\n", "d.txt", {})),
              HasSubstr("d.txt, line 2: must be numbers"));
  EXPECT_THAT(ErrorOf(ParseMotDetections("1,1,1,1,2,2,1,2.5,1\n", "d.txt", {})), HasSubstr("line 1: the class"));
  EXPECT_THAT(ErrorOf(ParseMotDetections("1.5,1,1,1,2,2,1\n", "d.txt", {})), HasSubstr("line 1: the frame must be"));
}

TEST(MotDetections, HaveALimitedNumberOfClasses) {
  std::string text;
  for (int i = 0; i <= 10'000; ++i) text += "1,1,1,1,2,2,1," + std::to_string(i) + ",1\n";
  EXPECT_THAT(ErrorOf(ParseMotDetections(text, "d.txt", {})), HasSubstr("line 10001: more than 10000 classes"));
}

TEST(YoloLabels, HaveConfidenceAndTrackInEitherForm) {
  DetectionList list{.is_relative = true};
  const std::vector<std::string> names = {"car"};
  const std::string text = "0 0.5 0.5 0.2 0.1\n0 0.5 0.5 0.2 0.1 0.75\n0 0.5 0.5 0.2 0.1 12\n1 0.5 0.5 0.2 0.1 0.5 3\n";
  ASSERT_TRUE(ParseYoloLabels(text, "v_4.txt", 4, names, list));
  const std::vector<ListedBox>& boxes = list.frames.at(4);
  ASSERT_EQ(boxes.size(), 4U);
  ExpectBox(boxes[0], {0.4, 0.45, 0.2, 0.1});
  EXPECT_DOUBLE_EQ(boxes[1].score, 0.75);
  EXPECT_EQ(boxes[2].track, 12);
  EXPECT_EQ(boxes[3].track, 3);
  EXPECT_THAT(list.classes, ElementsAre("car", "class-1"));
  for (const std::string wrong :
       {"0 0.5 0.5", "0 1.5 0.5 0.2 0.1", "car 0.5 0.5 0.2 0.1", "0 .1 .1 .2 .2 .3 .3 .4 .4"}) {
    const Status status = ParseYoloLabels(wrong, "v_4.txt", 4, names, list);
    ASSERT_FALSE(status) << wrong;
    EXPECT_THAT(status.error().message, HasSubstr("v_4.txt, line 1: ")) << wrong;
  }
}

class DetectionFolder : public ::testing::Test {
 protected:
  void Write(const std::string& name, std::string_view text) {
    std::filesystem::create_directories((folder_.path() / name).parent_path());
    ASSERT_TRUE(WriteFileAtomically(folder_.path() / name, text));
  }
  std::filesystem::path At(const std::string& name) const { return folder_.path() / name; }

 private:
  testing::ScratchFolder folder_;
};

TEST_F(DetectionFolder, CountsFramesFromTheFirstOneOfEachFormat) {
  Write("mot.txt", "1,1,1,1,2,2,1\n");
  Write("labels/v_1.txt", "0 0.5 0.5 0.2 0.1\n");
  Write("labels/notes.md", "no labels\n");
  Write("zero/v_0.txt", "0 0.5 0.5 0.2 0.1\n");
  Write("zero/v_2.txt", "0 0.5 0.5 0.2 0.1\n");
  for (const std::string name : {"mot.txt", "labels", "zero"}) {
    const auto list = ReadDetectionList({.path = At(name)});
    ASSERT_TRUE(list) << list.error().message;
    EXPECT_EQ(list->frames.begin()->first, 0) << name;
  }
  EXPECT_EQ(ReadDetectionList({.path = At("mot.txt")})->detector, "mot");
  EXPECT_EQ(ReadDetectionList({.path = At("labels/")})->detector, "labels");
  EXPECT_EQ(ReadDetectionList({.path = At("mot.txt"), .detector = "yolo", .first_frame = 0})->frames.begin()->first, 1);
  EXPECT_THAT(ErrorOf(ReadDetectionList({.path = At("mot.txt"), .first_frame = 2})),
              HasSubstr("has boxes of frame 1, but the first frame is 2: give --first-frame 1"));
}

TEST_F(DetectionFolder, HoldsLabelsOfOneVideoOrOfThisOne) {
  Write("labels/a_1.txt", "0 0.5 0.5 0.2 0.1\n");
  Write("labels/b_1.txt", "0 0.5 0.5 0.3 0.1\n0 0.5 0.5 0.3 0.1\n");
  EXPECT_EQ(ReadDetectionList({.path = At("labels"), .video = "flights/b.mp4"})->CountBoxes(), 2U);
  EXPECT_THAT(ErrorOf(ReadDetectionList({.path = At("labels"), .video = "c.mp4"})),
              HasSubstr("labels of 2 names, none of them c_FRAME.txt"));
}

TEST_F(DetectionFolder, NothingFoundIsAResult) {
  Write("empty.txt", "");
  Write("empty.json", R"({"annotations":[],"images":[]})");
  Write("results.json", "[]");
  Write("labels/v_1.txt", "");
  for (const std::string name : {"empty.txt", "empty.json", "results.json", "labels"}) {
    const auto list = ReadDetectionList({.path = At(name)});
    ASSERT_TRUE(list) << list.error().message;
    EXPECT_EQ(list->CountBoxes(), 0U) << name;
  }
}

TEST_F(DetectionFolder, RefusesOtherFiles) {
  Write("text.txt", "some words\n");
  Write("none/readme.txt", "words\n");
  EXPECT_THAT(ErrorOf(ReadDetectionList({.path = At("text.txt")})), HasSubstr("no detections"));
  EXPECT_THAT(ErrorOf(ReadDetectionList({.path = At("none")})), HasSubstr("no labels in it"));
  EXPECT_FALSE(ReadDetectionList({.path = At("missing.json")}));
}

}  // namespace
}  // namespace victorious
