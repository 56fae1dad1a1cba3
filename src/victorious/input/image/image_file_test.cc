#include "victorious/input/image/image_file.h"

#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "testing/data.h"
#include "testing/video_tools.h"
#include "victorious/base/random.h"
#include "victorious/input/image/image_header.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::span<const std::byte> Bytes(const std::string& text) { return std::as_bytes(std::span(text)); }

std::string Encode(const std::string& extension, const cv::Mat& image, const std::vector<int>& parameters = {}) {
  std::vector<unsigned char> bytes;
  EXPECT_TRUE(cv::imencode(extension, image, bytes, parameters));
  return {bytes.begin(), bytes.end()};
}

std::string BigEndian(std::uint32_t value, int size) {
  std::string bytes;
  for (int i = size - 1; i >= 0; --i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xFF));
  return bytes;
}

// A TIFF structure: one directory with the orientation tag only.
std::string ExifBytes(int orientation) {
  return std::string("MM\0*", 4) + BigEndian(8, 4) + BigEndian(1, 2) + BigEndian(0x0112, 2) + BigEndian(3, 2) +
         BigEndian(1, 4) + BigEndian(static_cast<std::uint32_t>(orientation), 2) + std::string(6, '\0');
}

std::string WithSegment(const std::string& jpeg, const std::string& payload) {
  return jpeg.substr(0, 2) + "\xFF\xE1" + BigEndian(static_cast<std::uint32_t>(payload.size() + 2), 2) + payload +
         jpeg.substr(2);
}

std::string WithExif(const std::string& jpeg, int orientation) {
  return WithSegment(jpeg, std::string("Exif\0\0", 6) + ExifBytes(orientation));
}

std::string TextOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Left half red, right half blue, a green corner at the top left: all eight orientations differ.
cv::Mat Flag() {
  cv::Mat flag(32, 64, CV_8UC3, cv::Scalar(255, 0, 0));
  flag(cv::Rect(0, 0, 32, 32)).setTo(cv::Scalar(0, 0, 255));
  flag(cv::Rect(0, 0, 16, 16)).setTo(cv::Scalar(0, 255, 0));
  return flag;
}

double LargestDifference(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF); }

TEST(ImageFile, LosslessFormatsRoundTrip) {
  for (const std::string extension : {".png", ".tif", ".bmp", ".ppm"}) {
    const auto image = DecodeImage(Bytes(Encode(extension, Flag())), "flag" + extension);
    ASSERT_TRUE(image) << extension << ": " << image.error().message;
    EXPECT_EQ(LargestDifference(image->bgr, Flag()), 0) << extension;
    EXPECT_TRUE(image->alpha.empty()) << extension;
  }
}

TEST(ImageFile, JpegRoundTripIsClose) {
  const auto image = DecodeImage(Bytes(Encode(".jpg", Flag())), "flag.jpg");
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->bgr.size(), Flag().size());
  EXPECT_LT(cv::norm(image->bgr, Flag(), cv::NORM_L1) / static_cast<double>(Flag().total() * 3), 12);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// In a process of its own, whose address space is limited to little more than it has.
TEST(ImageFile, LackOfMemoryIsNoDamage) {
  const std::string png = Encode(".png", cv::Mat(8000, 8000, CV_8UC1, cv::Scalar(0)));
  const auto decode_with_little = [&] {
    std::ifstream statm("/proc/self/statm");
    rlim_t pages = 0;
    statm >> pages;
    const rlim_t bytes = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + (rlim_t{32} << 20);
    const rlimit limit{.rlim_cur = bytes, .rlim_max = bytes};
    if (::setrlimit(RLIMIT_AS, &limit) != 0) std::_Exit(2);
    const auto image = DecodeImage(Bytes(png), "large.png");
    std::_Exit(!image && image.error().code == ErrorCode::kUnavailable ? 0 : 1);
  };
  EXPECT_EXIT(decode_with_little(), ::testing::ExitedWithCode(0), "");
}
#endif

// OpenCV would pass a damaged WebP on to any library that accepts it: here the DICOM library, which terminates the
// program.
TEST(ImageFile, FormatsThatOpenCvDelegatesAreRefused) {
  std::string webp = std::string("RIFF\x84\0\0\0WEBPVP8L", 16) + std::string(112, '\n') + "DICM";
  webp += std::string("\x03\x03\x02\x04OB\x8B\x06", 8);
  for (const std::string& bytes : {webp, std::string(128, '\0') + "DICM", std::string("NITF02.10")}) {
    const auto image = DecodeImage(Bytes(bytes), "strange");
    ASSERT_FALSE(image);
    EXPECT_THAT(image.error().message, HasSubstr("not an image that can be read"));
  }
}

TEST(ImageFile, GreyBecomesBgr) {
  const auto image = DecodeImage(Bytes(Encode(".png", cv::Mat(5, 7, CV_8UC1, cv::Scalar(77)))), "grey.png");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->bgr.type(), CV_8UC3);
  EXPECT_EQ(image->bgr.at<cv::Vec3b>(2, 3), cv::Vec3b(77, 77, 77));
}

TEST(ImageFile, AlphaIsReturnedSeparately) {
  cv::Mat stored(8, 8, CV_8UC4, cv::Scalar(10, 20, 30, 255));
  stored.at<cv::Vec4b>(1, 2)[3] = 0;
  const auto image = DecodeImage(Bytes(Encode(".png", stored)), "alpha.png");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->bgr.at<cv::Vec3b>(1, 2), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(image->alpha.type(), CV_8UC1);
  EXPECT_EQ(image->alpha.at<uchar>(1, 2), 0);
  EXPECT_EQ(image->alpha.at<uchar>(0, 0), 255);
}

TEST(ImageFile, SixteenBitsAreReducedToEight) {
  cv::Mat deep(4, 4, CV_16UC4, cv::Scalar(65535, 257 * 100, 128, 65535));
  for (const std::string extension : {".png", ".tif"}) {
    const auto image = DecodeImage(Bytes(Encode(extension, deep)), "deep" + extension);
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->bgr.at<cv::Vec3b>(0, 0), cv::Vec3b(255, 100, 0)) << extension;
    EXPECT_EQ(image->alpha.at<uchar>(0, 0), 255) << extension;
  }
}

TEST(ImageFile, FloatingPointIsUnsupported) {
  const auto image = DecodeImage(Bytes(Encode(".tif", cv::Mat(4, 4, CV_32FC1, cv::Scalar(0.5)))), "float.tif");
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, ErrorCode::kUnsupported);
}

TEST(ImageFile, ExifOrientationIsApplied) {
  const std::string jpeg = Encode(".jpg", Flag(), {cv::IMWRITE_JPEG_QUALITY, 100});
  const auto upright = DecodeImage(Bytes(jpeg), "flag.jpg");
  ASSERT_TRUE(upright);
  for (int orientation = 1; orientation <= 8; ++orientation) {
    const std::string turned = WithExif(jpeg, orientation);
    const auto image = DecodeImage(Bytes(turned), "turned.jpg");
    ASSERT_TRUE(image) << image.error().message;
    // Reference: OpenCV's own interpretation of the tag.
    const cv::Mat expected = cv::imdecode(std::vector<unsigned char>(turned.begin(), turned.end()), cv::IMREAD_COLOR);
    ASSERT_EQ(image->bgr.size(), expected.size()) << orientation;
    EXPECT_EQ(LargestDifference(image->bgr, expected), 0) << orientation;
  }
}

TEST(ImageFile, ExifAndXmpOfAJpegArePartsOfItsHeader) {
  const std::string jpeg = Encode(".jpg", Flag());
  const std::string photo =
      WithExif(WithSegment(jpeg, std::string("http://ns.adobe.com/xap/1.0/\0", 29) + "<x:xmpmeta/>"), 1);
  const auto header = ReadImageHeader(Bytes(photo));
  ASSERT_TRUE(header);
  EXPECT_EQ(TextOf(header->exif), std::string("Exif\0\0", 6) + ExifBytes(1));
  EXPECT_EQ(TextOf(header->xmp), "<x:xmpmeta/>");
  EXPECT_EQ(header->width, 64U);
  const auto plain = ReadImageHeader(Bytes(jpeg));
  ASSERT_TRUE(plain);
  EXPECT_TRUE(plain->exif.empty() && plain->xmp.empty());
}

TEST(ImageFile, ExifOrientationOfPngIsAppliedToAlpha) {
  cv::Mat stored(2, 4, CV_8UC4, cv::Scalar(1, 2, 3, 255));
  stored.at<cv::Vec4b>(0, 0) = {9, 8, 7, 0};
  std::string png = Encode(".png", stored);
  // The checksum of the ancillary chunk is not computed: no decoder checks it. The chunk follows IHDR.
  const std::string chunk = BigEndian(static_cast<std::uint32_t>(ExifBytes(6).size()), 4) + "eXIf" + ExifBytes(6);
  png.insert(33, chunk + BigEndian(0, 4));
  const auto image = DecodeImage(Bytes(png), "turned.png");
  ASSERT_TRUE(image) << image.error().message;
  ASSERT_EQ(image->bgr.size(), cv::Size(2, 4));
  EXPECT_EQ(image->bgr.at<cv::Vec3b>(0, 1), cv::Vec3b(9, 8, 7));  // the top left moves to the top right
  EXPECT_EQ(image->alpha.at<uchar>(0, 1), 0);
}

TEST(ImageFile, BmpPaddingIsNotAlpha) {
  const auto image = DecodeImage(Bytes(Encode(".bmp", cv::Mat(4, 4, CV_8UC4, cv::Scalar(1, 2, 3, 0)))), "pad.bmp");
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_TRUE(image->alpha.empty());
}

TEST(ImageFile, ErrorsAreOneLineWithTheirCode) {
  const testing::ScratchFolder folder;
  testing::WriteBytes(folder / "empty.png", "");
  testing::WriteBytes(folder / "text.png", "this is text, not an image\n");
  const std::string png = Encode(".png", testing::NumberedImage(5, {200, 100}));
  testing::WriteBytes(folder / "head.png", png.substr(0, 40));
  std::string changed = png;
  changed[changed.find("IDAT") + 20] ^= 1;
  testing::WriteBytes(folder / "changed.png", changed);
  const std::string jpeg = Encode(".jpg", testing::NumberedImage(5, {200, 100}));
  testing::WriteBytes(folder / "half.jpg", jpeg.substr(0, jpeg.size() / 2));
  const struct {
    std::string name;
    ErrorCode code;
    std::string words;
  } cases[] = {{"missing.png", ErrorCode::kNotFound, "No such file"},
               {"", ErrorCode::kInvalidArgument, "not a regular file"},
               {"empty.png", ErrorCode::kInvalidArgument, "the file is empty"},
               {"text.png", ErrorCode::kDataLoss, "not an image that can be read"},
               {"head.png", ErrorCode::kDataLoss, "a png image whose end is missing"},
               {"half.jpg", ErrorCode::kDataLoss, "a jpeg image whose end is missing"},
               {"changed.png", ErrorCode::kDataLoss, "a damaged png image"}};
  for (const auto& [name, code, words] : cases) {
    const auto image = ReadImage(folder / name);
    ASSERT_FALSE(image) << name;
    EXPECT_EQ(image.error().code, code) << image.error().message;
    EXPECT_THAT(image.error().message, HasSubstr(words));
    EXPECT_THAT(image.error().message, HasSubstr((folder / name).string()));
    EXPECT_THAT(image.error().message, Not(HasSubstr("\n")));
  }
}

TEST(ImageFile, TooLargeImageIsRefusedBeforeDecoding) {
  std::string png = Encode(".png", Flag());
  png.replace(16, 8, BigEndian(20000, 4) + BigEndian(20000, 4));
  const auto image = DecodeImage(Bytes(png), "huge.png");
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(image.error().message, HasSubstr("20000 x 20000"));
}

// OpenCV skips to the next digit and would read 888888 x 880 pixels.
TEST(ImageFile, AmbiguousImageSizeIsRefused) {
  for (const std::string text : {"P6\n888888r880 255 ", "P5\n0 10 255\n", "P5\n"}) {
    const auto image = DecodeImage(Bytes(text), "strange.ppm");
    ASSERT_FALSE(image) << text;
    EXPECT_EQ(image.error().code, ErrorCode::kDataLoss);
    EXPECT_THAT(image.error().message, HasSubstr("without a size"));
  }
}

TEST(ImageFile, DamagedBytesNeverCrash) {
  constexpr std::uint64_t kSeed = 20240601;
  Random random(kSeed);
  for (const std::string extension : {".png", ".jpg", ".tif", ".bmp", ".pgm"}) {
    const std::string whole = Encode(extension, extension == ".pgm" ? GreyFromBgr(Flag()) : Flag());
    for (int round = 0; round < 60; ++round) {
      std::string bytes = whole;
      const auto size = static_cast<std::uint32_t>(bytes.size());
      for (int i = 0; i < 4; ++i) bytes[random.Below(std::min(size, 200U))] ^= static_cast<char>(random.Next());
      if (round % 3 == 0) bytes.resize(random.Below(size) + 1);
      if (const auto image = DecodeImage(Bytes(bytes), "damaged")) {
        EXPECT_FALSE(image->bgr.empty()) << "seed " << kSeed;
      }
    }
  }
}

TEST(ImageHeader, SizeOfEveryFormat) {
  for (const std::string extension : {".png", ".jpg", ".tif", ".bmp", ".ppm"}) {
    const std::string bytes = Encode(extension, cv::Mat(31, 57, CV_8UC3, cv::Scalar(1, 2, 3)));
    const auto header = ReadImageHeader(Bytes(bytes));
    ASSERT_TRUE(header) << extension;
    EXPECT_EQ(header->width, 57U) << extension;
    EXPECT_EQ(header->height, 31U) << extension;
  }
}

TEST(ImageHeader, PnmComments) {
  const std::string bytes = "P5 # a comment\n# another\n57\t31\n255\n";
  const auto header = ReadImageHeader(Bytes(bytes));
  ASSERT_TRUE(header);
  EXPECT_EQ(header->width, 57U);
  EXPECT_EQ(header->height, 31U);
}

TEST(ImageFile, GreyWeights) {
  const cv::Mat bgr = (cv::Mat_<cv::Vec3b>(1, 3) << cv::Vec3b(255, 0, 0), cv::Vec3b(0, 255, 0), cv::Vec3b(0, 0, 255));
  const cv::Mat grey = GreyFromBgr(bgr);
  EXPECT_EQ(grey.at<uchar>(0), 29);
  EXPECT_EQ(grey.at<uchar>(1), 150);
  EXPECT_EQ(grey.at<uchar>(2), 76);
}

TEST(WriteImage, NamesThatNoFormatHasAreRefused) {
  const testing::ScratchFolder folder;
  const cv::Mat colours(2, 3, CV_8UC3, cv::Scalar(10, 20, 30));
  for (const char* name : {"a.exr", "a.hdr", ".png", "png", "a.png/b"}) {
    const Status written = WriteImage(folder.path() / name, colours);
    ASSERT_FALSE(written) << name;
    EXPECT_EQ(written.error().code, ErrorCode::kInvalidArgument) << name;
    EXPECT_TRUE(written.error().message.contains("must end in .png or .jpg")) << written.error().message;
  }
  EXPECT_TRUE(CheckImageName("a/b.JPG"));
}

TEST(WriteImage, AnImageThatTheFormatCannotHoldIsRefusedByName) {
  const testing::ScratchFolder folder;
  const Status written = WriteImage(folder.path() / "wide.jpg", cv::Mat::zeros(1, 70'000, CV_8UC1));
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(written.error().message.contains("wide.jpg: an image of 70000 x 1 pixels")) << written.error().message;
}

}  // namespace
}  // namespace victorious
