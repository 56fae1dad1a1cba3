#include "victorious/input/video/image_sequence_reader.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "testing/data.h"
#include "testing/video_tools.h"

namespace victorious {
namespace {

using testing::DecodeImageNumber;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::NumberedImage;
using testing::ScratchFolder;

std::unique_ptr<VideoReader> MustOpenImages(const std::filesystem::path& path, const VideoReaderOptions& options = {}) {
  auto reader = VideoReader::Open(path.string(), options);
  EXPECT_TRUE(reader) << reader.error().message;
  return reader ? *std::move(reader) : nullptr;
}

std::string IdOf(const std::string& source) {
  const auto reader = VideoReader::Open(source, {});
  EXPECT_TRUE(reader) << reader.error().message;
  return reader ? (*reader)->ContentId(CancelToken(), {}).value() : "";
}

TEST(ImageSequenceReader, FolderIdDependsOnImagesOnly) {
  const ScratchFolder folder;
  const auto put = [&](const std::string& name, int number) {
    ASSERT_TRUE(cv::imwrite((folder / name).string(), NumberedImage(number, {80, 60})));
  };
  put("1.png", 1);
  put("2.png", 2);
  const std::string id = IdOf(folder.path().string());
  EXPECT_EQ(id.size(), 32U);
  testing::WriteBytes(folder / "index.db", "an index");
  testing::WriteBytes(folder / "run.log", "a log");
  std::filesystem::create_directory(folder / "more.png");
  EXPECT_EQ(IdOf(folder.path().string()), id);
  EXPECT_EQ(IdOf("file://" + folder.path().string()), id);
  put("3.png", 3);
  EXPECT_NE(IdOf(folder.path().string()), id);
  std::filesystem::remove(folder / "3.png");
  put("2.png", 4);
  EXPECT_NE(IdOf(folder.path().string()), id);
  EXPECT_EQ(IdOf((folder / "1.png").string()), ContentId(folder / "1.png").value());
}

TEST(ImageSequenceReader, FolderInNaturalOrder) {
  const ScratchFolder folder;
  for (const int number : {10, 9, 1, 100}) {
    ASSERT_TRUE(
        cv::imwrite((folder / ("frame" + std::to_string(number) + ".png")).string(), NumberedImage(number, {80, 60})));
  }
  testing::WriteBytes(folder / "notes.txt", "not an image");
  const auto reader = MustOpenImages(folder.path(), {.folder_frame_rate = 4});
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().container, "folder of images");
  EXPECT_TRUE(reader->info().of_images);
  EXPECT_EQ(reader->info().codec, "png");
  EXPECT_EQ(reader->info().frame_count, 4);
  EXPECT_EQ(reader->info().width, 80);
  EXPECT_FALSE(reader->info().live);
  std::vector<int> numbers;
  std::vector<double> times_s;
  while (const auto frame = reader->NextFrame().value()) {
    EXPECT_EQ(frame->index, static_cast<std::int64_t>(numbers.size()));
    EXPECT_EQ(frame->image.type(), CV_8UC1);
    numbers.push_back(DecodeImageNumber(frame->image));
    times_s.push_back(frame->time_s);
  }
  EXPECT_THAT(numbers, ElementsAre(1, 9, 10, 100));
  EXPECT_THAT(times_s, ElementsAre(0, 0.25, 0.5, 0.75));
  EXPECT_TRUE(reader->warnings().empty());
}

TEST(ImageSequenceReader, UnusableImagesAreSkippedWithAWarning) {
  const ScratchFolder folder;
  testing::WriteBytes(folder / "0.png", "damaged");
  cv::imwrite((folder / "1.png").string(), NumberedImage(1, {80, 60}));
  cv::imwrite((folder / "2.png").string(), NumberedImage(2, {40, 60}));
  cv::imwrite((folder / "3.png").string(), NumberedImage(3, {80, 60}));
  const auto reader = MustOpenImages(folder.path(), {.color = FrameColor::kBgr});
  ASSERT_TRUE(reader);
  const auto first = reader->NextFrame().value();
  const auto second = reader->NextFrame().value();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->time_s, 0);
  EXPECT_EQ(DecodeImageNumber(second->image), 3);
  EXPECT_EQ(second->index, 1);
  EXPECT_DOUBLE_EQ(second->time_s, 0.2);  // by its index among the files
  EXPECT_FALSE(reader->NextFrame().value());
  EXPECT_THAT(reader->warnings(), ElementsAre(HasSubstr("0.png"), HasSubstr("2.png: 40 x 60 pixels")));
}

TEST(ImageSequenceReader, ImageIsAVideoOfOneFrame) {
  const ScratchFolder folder;
  const cv::Mat image = NumberedImage(77, {81, 61});
  cv::imwrite((folder / "one.png").string(), image);
  const auto reader = MustOpenImages(folder / "one.png", {.color = FrameColor::kBgr});
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().container, "image");
  const auto frame = reader->NextFrame().value();
  ASSERT_TRUE(frame);
  EXPECT_EQ(cv::norm(frame->image, image, cv::NORM_INF), 0);
  EXPECT_FALSE(reader->NextFrame().value());
}

TEST(ImageSequenceReader, FolderErrors) {
  const ScratchFolder folder;
  const auto none = VideoReader::Open(folder.path().string(), {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(none.error().message, HasSubstr("a folder without images"));
  testing::WriteBytes(folder / "1.png", "bad");
  testing::WriteBytes(folder / "2.jpg", "bad");
  const auto bad = VideoReader::Open(folder.path().string(), {});
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().code, ErrorCode::kDataLoss);
  EXPECT_THAT(bad.error().message, HasSubstr("none of its 2 images can be read"));
}

TEST(NaturalLess, ComparesNumbersByValue) {
  EXPECT_TRUE(NaturalLess("9.png", "10.png"));
  EXPECT_FALSE(NaturalLess("10.png", "9.png"));
  EXPECT_TRUE(NaturalLess("frame_2_b", "frame_10_a"));
  EXPECT_TRUE(NaturalLess("a", "a1"));
  EXPECT_TRUE(NaturalLess("img007.png", "img8.png"));
  EXPECT_TRUE(NaturalLess("1.jpg", "1.png"));
  EXPECT_NE(NaturalLess("01.png", "1.png"), NaturalLess("1.png", "01.png"));  // the order is total
  EXPECT_FALSE(NaturalLess("7", "7"));
  EXPECT_TRUE(NaturalLess("99999999999999999999998", "99999999999999999999999"));
}

}  // namespace
}  // namespace victorious
