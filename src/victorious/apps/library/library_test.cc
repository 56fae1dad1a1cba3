// The public headers as a caller uses them. Whole programs against the installed library: tests/e2e/test_library.py.
#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "testing/synthetic_flight.h"
#include "victorious/apps/library/facade.h"
#include "victorious/base/version.h"
#include "victorious/geometry/box.h"
#include "victorious/victorious.h"

namespace libvictorious {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using victorious::testing::SyntheticFlight;

template <typename Call>
Error ErrorOf(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "no error";
  return {ErrorCode::kInternal, ""};
}

TEST(Library, VersionIsThatOfThePrograms) {
  EXPECT_EQ(Version(), victorious::kVersion);
  EXPECT_EQ(Version(), fmt::format("{}.{}.{}", LIBVICTORIOUS_VERSION_MAJOR, LIBVICTORIOUS_VERSION_MINOR,
                                   LIBVICTORIOUS_VERSION_PATCH));
}

TEST(Library, ErrorsHaveCodeAndMessage) {
  const Error error = ErrorOf([] { static_cast<void>(Model::Load("/none.vmodel")); });
  EXPECT_EQ(error.code(), ErrorCode::kNotFound);
  EXPECT_THAT(error.what(), HasSubstr("/none.vmodel"));
  EXPECT_STREQ(Name(error.code()), "not_found");
  EXPECT_STREQ(Name(static_cast<ErrorCode>(99)), "");
}

TEST(LibraryImage, CopyReadsRowsByTheirStride) {
  const std::vector<std::uint8_t> pixels = {1, 2, 3, 4, 5, 6, 99, 99, 11, 12, 13, 14, 15, 16};
  const Image image = Image::Copy({pixels.data(), 2, 2, 8, PixelFormat::kRgb});
  const ImageView view = image.view();
  EXPECT_EQ(view.format, PixelFormat::kRgb);
  EXPECT_EQ(std::vector<std::uint8_t>(view.pixels + view.stride_bytes, view.pixels + view.stride_bytes + 6),
            (std::vector<std::uint8_t>{11, 12, 13, 14, 15, 16}));
}

TEST(LibraryImage, RefusesViewsOfNoImage) {
  const std::vector<std::uint8_t> pixels(100);
  for (const ImageView& view :
       {ImageView{}, ImageView{pixels.data(), 0, 5, 10, PixelFormat::kGrey},
        ImageView{pixels.data(), 10, -1, 10, PixelFormat::kGrey}, ImageView{nullptr, 5, 5, 5, PixelFormat::kGrey},
        ImageView{pixels.data(), 5, 5, 14, PixelFormat::kBgr}, ImageView{pixels.data(), 5, 5, -5, PixelFormat::kGrey},
        ImageView{pixels.data(), 5, 5, 5, static_cast<PixelFormat>(9)}}) {
    EXPECT_EQ(ErrorOf([&] { static_cast<void>(Image::Copy(view)); }).code(), ErrorCode::kInvalidArgument);
  }
}

TEST(LibraryImage, FormatsAgree) {
  cv::Mat bgr(4, 5, CV_8UC3);
  cv::randu(bgr, 0, 256);
  cv::Mat rgba;
  cv::cvtColor(bgr, rgba, cv::COLOR_BGR2RGBA);
  ImageView view = ViewOf(rgba);
  view.format = PixelFormat::kRgba;
  EXPECT_EQ(cv::norm(BgrOf(view).value(), bgr, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(GreyOf(view).value(), GreyOf(ViewOf(bgr)).value(), cv::NORM_INF), 0);
  EXPECT_EQ(BgrOf(ViewOf(bgr)).value().data, bgr.data) << "not copied";
}

TEST(LongWork, CallbackEndsTheWork) {
  int calls = 0;
  const ProgressCallback stop = [&](const Progress& progress) {
    ++calls;
    EXPECT_EQ(progress.unit, "frames");
    return false;
  };
  const LongWork work(stop);
  EXPECT_FALSE(work.cancel().IsCancelled());
  {
    victorious::Progress("a.mp4", 2, "frames").Update(1);
  }
  EXPECT_EQ(calls, 1);
  EXPECT_TRUE(work.cancel().IsCancelled());
  const victorious::Expected<int> cancelled = victorious::Fail(victorious::ErrorCode::kCancelled, "stopped");
  EXPECT_EQ(ErrorOf([&] { static_cast<void>(work.Finish(cancelled)); }).code(), ErrorCode::kCancelled);
}

TEST(LongWork, ThrowsWhatItsCallbackThrew) {
  const ProgressCallback fail = [](const Progress&) -> bool { throw std::out_of_range("of the caller"); };
  const LongWork work(fail);
  {
    victorious::Progress("a.mp4", 2, "frames").Update(1);
  }
  EXPECT_TRUE(work.cancel().IsCancelled());
  EXPECT_THROW(static_cast<void>(work.Finish(victorious::Expected<int>(1))), std::out_of_range);
}

// A short flight as a folder of images, the photo of an object in it, and its model.
class LibraryFlightTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::filesystem::path(::testing::TempDir()) / "library_test";
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "frames");
    victorious::testing::FlightOptions options;
    options.seed = 5;
    options.frames = 8;
    options.width = 256;
    options.height = 192;
    options.object_scale = 0.6;
    options.zoom = 1.0;
    options.path_widths = 0.3;
    const SyntheticFlight flight(options);
    for (int i = 0; i < options.frames; ++i) {
      cv::imwrite((folder_ / "frames" / fmt::format("{:03}.png", i)).string(), flight.Render(i).image);
    }
    truth_ = flight.Truth(0).front();
    cv::imwrite((folder_ / "photo.png").string(), flight.ObjectPhoto(0));
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

  static std::string Frames() { return (folder_ / "frames").string(); }
  static Model MakeModel() {
    return MakeModelFromPhotos(truth_.model, {{(folder_ / "photo.png").string(), std::nullopt}});
  }

  static inline std::filesystem::path folder_;
  static inline victorious::testing::TruthRow truth_;
};

TEST_F(LibraryFlightTest, VideoDeliversFramesInOrder) {
  Video video(Frames());
  EXPECT_EQ(video.info().width, 256);
  std::vector<std::int64_t> indices;
  std::optional<Frame> last;
  while (std::optional<Frame> frame = video.Next()) {
    EXPECT_EQ(frame->image().format, PixelFormat::kBgr);
    indices.push_back(frame->index());
    last = frame;
  }
  EXPECT_THAT(indices, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_NEAR(last->time_s(), 0.7, 1e-9);
  EXPECT_EQ(last->image().height, 192) << "outlives the next call";
  EXPECT_EQ(ErrorOf([] { const Video none("/none.mp4"); }).code(), ErrorCode::kNotFound);
}

TEST_F(LibraryFlightTest, LibraryKeepsWhatWasMade) {
  const Model made = MakeModel();
  const ModelLibrary library((folder_ / "models").string());
  library.Add(made);
  EXPECT_THAT(library.Names(), ElementsAre(truth_.model));
  EXPECT_EQ(library.Load(truth_.model).id(), made.id());
  EXPECT_EQ(made.kind(), ModelKind::kPhotos);
  EXPECT_EQ(ErrorOf([&] { library.Add(made); }).code(), ErrorCode::kAlreadyExists);
  library.Remove(truth_.model);
  EXPECT_THAT(library.LoadAll(), IsEmpty());
}

TEST_F(LibraryFlightTest, RecognizerFindsTheObject) {
  const Recognizer recognizer({MakeModel()});
  const Frame frame = *Video(Frames()).Next();
  const std::vector<Detection> found = recognizer.Recognize(frame.image());
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].name, truth_.model);
  const Box& box = found[0].box;
  EXPECT_GT(victorious::IntersectionOverUnion({box.x, box.y, box.width, box.height}, truth_.box), 0.7);
  EXPECT_EQ(ErrorOf([] { const Recognizer none({}); }).code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(ErrorOf([] { const Recognizer none({MakeModel()}, {"{\"ratio\": 3}"}); }).what(), HasSubstr("ratio"));
}

TEST_F(LibraryFlightTest, TrackerFollowsTheBox) {
  Video video(Frames());
  Tracker tracker;
  const Box drawn = {truth_.box.x, truth_.box.y, truth_.box.width, truth_.box.height};
  EXPECT_EQ(ErrorOf([&] { tracker.Start(drawn); }).code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(tracker.Step(video.Next()->image()), IsEmpty());
  EXPECT_TRUE(tracker.Start(drawn).seen());
  int seen = 0;
  while (const std::optional<Frame> frame = video.Next()) {
    const std::vector<TrackStep> steps = tracker.Step(frame->image());
    ASSERT_EQ(steps.size(), 1);
    seen += steps[0].seen() ? 1 : 0;
  }
  EXPECT_GT(seen, 5);
  const Image small = Image::Read((folder_ / "photo.png").string());
  EXPECT_EQ(ErrorOf([&] { tracker.Step(small.view()); }).code(), ErrorCode::kInvalidArgument);
}

TEST_F(LibraryFlightTest, IndexHoldsWhatWasFound) {
  const std::string db = (folder_ / "index.db").string();
  Indexer indexer({MakeModel()});
  EXPECT_EQ(ErrorOf([&] { indexer.Index("/none.mp4", db); }).code(), ErrorCode::kNotFound);
  EXPECT_FALSE(std::filesystem::exists(db)) << "a wrong name leaves no index";
  const IndexReport report = indexer.Index(Frames(), db);
  EXPECT_GT(report.sightings, 0);
  EXPECT_FALSE(report.has_telemetry);
  EXPECT_EQ(indexer.Index(Frames(), db).frames_searched, 0) << "all was searched before";

  IndexJob failing;
  failing.redo = true;
  failing.progress = [](const Progress&) -> bool { throw std::out_of_range("of the caller"); };
  EXPECT_THROW(indexer.Index(Frames(), db, failing), std::out_of_range);
  failing.progress = [](const Progress&) { return true; };
  EXPECT_GT(indexer.Index(Frames(), db, failing).sightings, 0);

  const Index index(db);
  const std::vector<Object> objects = index.Objects();
  ASSERT_FALSE(objects.empty());
  EXPECT_EQ(objects[0].model, truth_.model);
  EXPECT_EQ(objects[0].rank, 1);
  EXPECT_FALSE(objects[0].place);
  ASSERT_EQ(objects[0].moments.size(), 1);
  EXPECT_EQ(index.Videos().size(), 1);
  EXPECT_EQ(index.Models().at(0).name, truth_.model);

  Filter filter;
  filter.object = objects[0].id;
  const std::vector<Sighting> sightings = index.Sightings(filter);
  EXPECT_EQ(static_cast<std::int64_t>(sightings.size()), objects[0].frames);
  EXPECT_EQ(sightings.at(0).video, objects[0].moments[0].video);
  int visited = 0;
  EXPECT_THROW(index.VisitSightings({},
                                    [&](const Sighting&) -> bool {
                                      if (++visited == 2) throw std::out_of_range("of the caller");
                                      return true;
                                    }),
               std::out_of_range);
  EXPECT_EQ(visited, 2);
  filter.model = "none";
  EXPECT_EQ(ErrorOf([&] { static_cast<void>(index.Objects(filter)); }).code(), ErrorCode::kNotFound);

  const std::string exported = (folder_ / "objects.jsonl").string();
  index.Export("objects", exported);
  EXPECT_GT(std::filesystem::file_size(exported), 100);
  EXPECT_EQ(ErrorOf([&] { index.Export("none", exported); }).code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(ErrorOf([] { const Index none("/none.db"); }).code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace libvictorious
