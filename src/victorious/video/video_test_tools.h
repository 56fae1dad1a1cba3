// Videos for the tests, written with FFmpeg in all the shapes that VideoWriter does not make: other codecs and
// containers, irregular times, pixel formats, display matrices, sound, data packets, changes of size.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace victorious::testing {

/// A smooth coloured picture that carries `number` (0..255) as eight black or white fields along its top.
cv::Mat NumberedPicture(int number, cv::Size size);

/// The number of such a picture (CV_8UC1 or CV_8UC3), which survives lossy coding.
int PictureNumber(const cv::Mat& picture);

struct TestPacket {
  std::int64_t pts = 0;
  std::string bytes;
};

struct TestVideo {
  std::string muxer = "mp4";
  std::string encoder = "libx264";
  std::string pixel_format = "yuv420p";
  cv::Size size = {96, 64};
  int time_base_hz = 1000;        ///< ticks/s of the times below
  std::vector<std::int64_t> pts;  ///< one a frame, increasing
  std::vector<cv::Mat> pictures;  ///< BGR; empty: NumberedPicture of its place
  bool full_range = false;
  int color_space = 2;             ///< AVColorSpace: 2 unspecified, 1 BT.709
  int rotation_deg = 0;            ///< of the display matrix, clockwise
  cv::Size pixel_aspect = {0, 1};  ///< a pixel's width to its height; 0: not told
  int max_b_frames = 0;
  int key_frame_interval = 12;
  bool audio = false;                      ///< a second stream of sound
  bool video = true;                       ///< false: sound only
  bool cover = false;                      ///< an attached picture in front of the video
  std::vector<TestPacket> klv = {};        ///< a KLV stream (mpegts), or …
  std::vector<TestPacket> subtitles = {};  ///< … a text stream (matroska, mp4)
};

/// Writes it; the test fails (by a check) if FFmpeg cannot.
void WriteTestVideo(const std::filesystem::path& path, const TestVideo& video);

/// n times at a steady rate.
std::vector<std::int64_t> SteadyTimes(int count, std::int64_t step);

/// The file's bytes with some changed; and back.
std::string ReadBytes(const std::filesystem::path& path);
void WriteBytes(const std::filesystem::path& path, const std::string& bytes);

}  // namespace victorious::testing
