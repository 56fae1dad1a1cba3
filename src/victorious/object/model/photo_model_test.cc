#include "victorious/object/model/photo_model.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "testing/data.h"
#include "testing/drawn_objects.h"
#include "victorious/base/version.h"
#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

using ::testing::AllOf;
using testing::DrawObject;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ObjectKind;
using testing::ScratchFolder;

struct PhotoImage {
  cv::Mat bgr;
  cv::Mat alpha;
};

// A synthetic object in the middle of a larger image, with its alpha channel.
constexpr int kMarginPx = 40;

PhotoImage ObjectOnGround(ObjectKind kind) {
  const testing::SyntheticObject object = DrawObject(kind, 11);
  PhotoImage image;
  cv::Mat channels;
  cv::copyMakeBorder(object.image, channels, kMarginPx, kMarginPx, kMarginPx, kMarginPx, cv::BORDER_CONSTANT,
                     cv::Scalar(90, 140, 110, 0));
  cv::cvtColor(channels, image.bgr, cv::COLOR_BGRA2BGR);
  cv::extractChannel(channels, image.alpha, 3);
  return image;
}

Box ObjectBox(const PhotoImage& image) {
  return {kMarginPx, kMarginPx, image.bgr.cols - 2.0 * kMarginPx, image.bgr.rows - 2.0 * kMarginPx};
}

Photo Prepare(const PhotoImage& image, const std::optional<Box>& box) {
  Expected<Photo> photo = PreparePhoto("object.png", image.bgr, image.alpha, box);
  EXPECT_TRUE(photo) << photo.error().message;
  return photo.value_or(Photo{});
}

ObjectModel MakePhotoModelOf(std::span<const Photo> photos) {
  Expected<ObjectModel> model = MakePhotoModel("object", photos, std::nullopt, {});
  EXPECT_TRUE(model) << model.error().message;
  return model.value_or(ObjectModel{});
}

void ExpectOneLine(const Error& error, ErrorCode code, std::string_view words) {
  EXPECT_EQ(error.code, code);
  EXPECT_THAT(error.message, AllOf(HasSubstr(std::string(words)), Not(HasSubstr("\n"))));
}

TEST(PreparePhoto, WithoutAlphaOrBoxTheWholeImageIsTheObject) {
  const PhotoImage image = ObjectOnGround(ObjectKind::kCrate);
  const Photo photo = Prepare({image.bgr, {}}, std::nullopt);
  EXPECT_EQ(photo.source, "object.png");
  EXPECT_EQ(photo.grey.type(), CV_8UC1);
  EXPECT_TRUE(photo.mask.empty());
  EXPECT_EQ(BoundingBox(photo.outline),
            (Box{0, 0, static_cast<double>(image.bgr.cols), static_cast<double>(image.bgr.rows)}));
}

TEST(PreparePhoto, BoxIsTheOutline) {
  const PhotoImage image = ObjectOnGround(ObjectKind::kCrate);
  const Box box{30.5, 20, 100, 80.25};
  const Photo photo = Prepare({image.bgr, {}}, box);
  EXPECT_EQ(BoundingBox(photo.outline), box);
  EXPECT_TRUE(photo.mask.empty());
}

TEST(PreparePhoto, AlphaChannelGivesTheOutline) {
  for (const ObjectKind kind : {ObjectKind::kCrate, ObjectKind::kTruck, ObjectKind::kAircraft}) {
    const PhotoImage image = ObjectOnGround(kind);
    const Photo photo = Prepare(image, std::nullopt);
    const double opaque = cv::countNonZero(image.alpha >= 128);
    EXPECT_EQ(cv::countNonZero(photo.mask), opaque);
    // The contour passes through the centres of the outermost pixels; the simplification moves it by a few pixels.
    EXPECT_NEAR(SignedArea(photo.outline) / opaque, 1.0, 0.07) << Name(kind);
    const cv::Rect shown = cv::boundingRect(photo.mask);
    const Box bounds = {double(shown.x), double(shown.y), double(shown.width), double(shown.height)};
    EXPECT_GT(IntersectionOverUnion(BoundingBox(photo.outline), bounds), 0.9) << Name(kind);
    // The background is uniform.
    cv::Mat deviation;
    cv::meanStdDev(photo.grey, cv::noArray(), deviation, photo.mask == 0);
    EXPECT_EQ(deviation.at<double>(0), 0.0);
  }
}

// The alpha channel of a screenshot.
TEST(PreparePhoto, OpaqueAlphaChannelChangesNothing) {
  PhotoImage image = ObjectOnGround(ObjectKind::kCrate);
  image.alpha.setTo(255);
  const Photo opaque = Prepare(image, ObjectBox(image));
  image.alpha = cv::Mat();
  const Photo without = Prepare(image, ObjectBox(image));
  EXPECT_EQ(opaque.outline, without.outline);
  EXPECT_EQ(cv::norm(opaque.grey, without.grey, cv::NORM_INF), 0) << "its surroundings are unchanged";
}

TEST(PreparePhoto, BoxAndAlphaAreIntersected) {
  const PhotoImage image = ObjectOnGround(ObjectKind::kCrate);
  const Box left_half{0, 0, image.bgr.cols / 2.0, static_cast<double>(image.bgr.rows)};
  const Photo photo = Prepare(image, left_half);
  const Box outline = BoundingBox(photo.outline);
  EXPECT_GE(outline.x, kMarginPx);
  EXPECT_LE(outline.x + outline.width, left_half.width);
  EXPECT_EQ(cv::countNonZero(photo.mask.colRange(image.bgr.cols / 2 + 1, image.bgr.cols)), 0);
  EXPECT_GT(cv::countNonZero(photo.mask), 0);
}

TEST(PreparePhoto, BoxOutsideThePhotoIsRefused) {
  const PhotoImage image = ObjectOnGround(ObjectKind::kCrate);
  const double width = image.bgr.cols;
  const double height = image.bgr.rows;
  for (const Box& box : {Box{-1, 0, 20, 20}, Box{0, -0.5, 20, 20}, Box{width - 10, 0, 11, 20},
                         Box{0, height - 10, 20, 10.5}, Box{width + 5, 5, 20, 20}, Box{5, 5, 0, 20}, Box{5, 5, 20, -3},
                         Box{5, 5, NAN, 20}, Box{NAN, 5, 20, 20}, Box{5, 5, INFINITY, 20}}) {
    for (const cv::Mat& alpha : {cv::Mat(), image.alpha}) {
      const Expected<Photo> photo = PreparePhoto("object.png", image.bgr, alpha, box);
      ASSERT_FALSE(photo) << box.x << ',' << box.y << ',' << box.width << ',' << box.height;
      ExpectOneLine(photo.error(), ErrorCode::kInvalidArgument, "inside the photo");
      EXPECT_THAT(photo.error().message, HasSubstr("object.png"));
    }
  }
  EXPECT_TRUE(PreparePhoto("object.png", image.bgr, {}, Box{0, 0, width, height}));
}

TEST(PreparePhoto, TransparentPhotoIsRefused) {
  const PhotoImage image = ObjectOnGround(ObjectKind::kCrate);
  const cv::Mat nothing = cv::Mat::zeros(image.alpha.size(), CV_8UC1);
  Expected<Photo> photo = PreparePhoto("object.png", image.bgr, nothing, std::nullopt);
  ASSERT_FALSE(photo);
  ExpectOneLine(photo.error(), ErrorCode::kInvalidArgument, "transparent everywhere");
  photo = PreparePhoto("object.png", image.bgr, image.alpha, Box{0, 0, 10, 10});
  ASSERT_FALSE(photo);
  ExpectOneLine(photo.error(), ErrorCode::kInvalidArgument, "transparent in the box");
  cv::Mat speck = nothing.clone();
  speck.at<std::uint8_t>(20, 20) = 255;
  photo = PreparePhoto("object.png", image.bgr, speck, std::nullopt);
  ASSERT_FALSE(photo);
  ExpectOneLine(photo.error(), ErrorCode::kInvalidArgument, "no area");
}

TEST(LoadPhoto, ReadsFilesAndNamesUnreadableOnes) {
  const ScratchFolder folder;
  const PhotoImage image = ObjectOnGround(ObjectKind::kSign);
  ASSERT_TRUE(WriteImage(folder / "sign.png", image.bgr));
  const Expected<Photo> photo = LoadPhoto(folder / "sign.png", ObjectBox(image));
  ASSERT_TRUE(photo) << photo.error().message;
  EXPECT_EQ(photo->source, (folder / "sign.png").string());
  EXPECT_EQ(photo->grey.size(), image.bgr.size());
  const Expected<Photo> missing = LoadPhoto(folder / "none.png", std::nullopt);
  ASSERT_FALSE(missing);
  ExpectOneLine(missing.error(), ErrorCode::kNotFound, "none.png");
}

TEST(MakePhotoModel, StoresEngineAndOptions) {
  const PhotoImage crate = ObjectOnGround(ObjectKind::kCrate);
  const PhotoImage truck = ObjectOnGround(ObjectKind::kTruck);
  const std::vector<Photo> photos = {Prepare(crate, std::nullopt), Prepare({truck.bgr, {}}, ObjectBox(truck))};
  const Expected<ObjectModel> model = MakePhotoModel("object", photos, 2.5, {});
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->name, "object");
  EXPECT_EQ(model->kind, ModelKind::kPhotos);
  EXPECT_EQ(model->engine, "sift");
  EXPECT_EQ(model->program_version, kVersion);
  EXPECT_EQ(model->length_m, 2.5);
  EXPECT_EQ(nlohmann::json::parse(model->options_json)["features"]["engine"], "sift");
  ASSERT_EQ(model->views.size(), 2U);
  EXPECT_EQ(model->views[0].first_feature, 0U);
  EXPECT_EQ(model->views[1].first_feature, model->views[0].feature_count);
  EXPECT_EQ(model->views[0].feature_count + model->views[1].feature_count, model->features.size());
  EXPECT_EQ(model->features.descriptors.size(), model->features.size() * kDescriptorSize);
  EXPECT_FALSE(model->views[0].angles);
  EXPECT_EQ(model->views[1].width, truck.bgr.cols);
  EXPECT_EQ(model->views[1].height, truck.bgr.rows);
}

TEST(MakePhotoModel, KeypointsLieOnTheObjectInPixelsOfThePhoto) {
  const PhotoImage image = ObjectOnGround(ObjectKind::kAircraft);
  const Photo photo = Prepare(image, std::nullopt);
  const ObjectModel model = MakePhotoModelOf(std::span(&photo, 1));
  ASSERT_GT(model.features.size(), 20U);
  for (const Keypoint& keypoint : model.features.keypoints) {
    EXPECT_NE(photo.mask.at<std::uint8_t>(static_cast<int>(keypoint.y), static_cast<int>(keypoint.x)), 0)
        << keypoint.x << ',' << keypoint.y;
  }
  const Photo boxed = Prepare({image.bgr, {}}, Box{60, 60, 90, 100});
  const ObjectModel of_box = MakePhotoModelOf(std::span(&boxed, 1));
  for (const Keypoint& keypoint : of_box.features.keypoints) {
    EXPECT_TRUE((Box{60, 60, 90, 100}).Contains(keypoint.x, keypoint.y));
  }
}

// An image that is all object has keypoints up to its edges, at the same positions as in a larger image.
TEST(MakePhotoModel, MarginDoesNotShiftKeypoints) {
  const PhotoImage image = ObjectOnGround(ObjectKind::kCrate);
  const Photo whole = Prepare({image.bgr, {}}, std::nullopt);
  std::vector<std::vector<Keypoint>> keypoints;
  for (const int margin_px : {0, 24}) {
    const Expected<ObjectModel> model =
        MakePhotoModel("object", std::span(&whole, 1), std::nullopt, {.margin_px = margin_px});
    ASSERT_TRUE(model) << model.error().message;
    keypoints.emplace_back(model->features.keypoints.begin(), model->features.keypoints.end());
  }
  int same = 0;
  for (const Keypoint& a : keypoints[0]) {
    for (const Keypoint& b : keypoints[1]) {
      if (std::hypot(a.x - b.x, a.y - b.y) < 0.5 && std::abs(a.scale_px / b.scale_px - 1) < 0.1) {
        ++same;
        break;
      }
    }
  }
  EXPECT_GT(same, 0.8 * static_cast<double>(keypoints[0].size()));
}

TEST(MakePhotoModel, RefusesPhotosWithTooFewFeatures) {
  const cv::Mat grey(200, 300, CV_8UC3, cv::Scalar(128, 128, 128));
  const PhotoImage crate = ObjectOnGround(ObjectKind::kCrate);
  const std::vector<Photo> photos = {Prepare(crate, std::nullopt),
                                     PreparePhoto("plain.png", grey, {}, std::nullopt).value()};
  const Expected<ObjectModel> model = MakePhotoModel("object", photos, std::nullopt, {});
  ASSERT_FALSE(model);
  ExpectOneLine(model.error(), ErrorCode::kInvalidArgument, "plain.png: 0 features");
  EXPECT_THAT(model.error().message, HasSubstr("at least 4"));
  const Expected<ObjectModel> none = MakePhotoModel("object", {}, std::nullopt, {});
  ASSERT_FALSE(none);
  ExpectOneLine(none.error(), ErrorCode::kInvalidArgument, "at least one photo");
}

TEST(MakePhotoModel, RefusesOptionsOutOfRange) {
  const Photo photo = Prepare(ObjectOnGround(ObjectKind::kCrate), std::nullopt);
  PhotoModelOptions options;
  options.margin_px = -1;
  options.features.max_side_px = 0;
  const Expected<ObjectModel> model = MakePhotoModel("object", std::span(&photo, 1), std::nullopt, options);
  ASSERT_FALSE(model);
  ExpectOneLine(model.error(), ErrorCode::kInvalidArgument, "margin_px = -1");
  EXPECT_THAT(model.error().message, HasSubstr("features.max_side_px = 0"));
}

TEST(OptionsOf, RefusesModelsThatAreNotOfPhotosOrOfOtherOptions) {
  const Photo photo = Prepare(ObjectOnGround(ObjectKind::kCrate), std::nullopt);
  ObjectModel model = MakePhotoModel("object", std::span(&photo, 1), std::nullopt, {}).value();
  EXPECT_EQ(OptionsOf(model).value().margin_px, PhotoModelOptions().margin_px);
  ObjectModel cad = model;
  cad.kind = ModelKind::kCad;
  ExpectOneLine(OptionsOf(cad).error(), ErrorCode::kInvalidArgument, "it is of a CAD file");
  ObjectModel unknown = model;
  unknown.options_json = R"({"of_another_program": 1})";
  ExpectOneLine(OptionsOf(unknown).error(), ErrorCode::kInvalidArgument,
                "made with options that this program does not know");
}

}  // namespace
}  // namespace victorious
