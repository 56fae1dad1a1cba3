// Test videos, written with FFmpeg in the variants that VideoWriter does not produce: other codecs and containers,
// irregular time stamps, pixel formats, display matrices, audio, data packets, changes of size.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace victorious::testing {

/// Returns a smooth coloured image (BGR) that encodes `number` (0..255) as eight black or white fields along its top
/// edge.
cv::Mat NumberedImage(int number, cv::Size size);

/// Decodes the number of such an image (CV_8UC1 or CV_8UC3); robust to lossy coding.
int DecodeImageNumber(const cv::Mat& image);

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
  std::vector<std::int64_t> pts;  ///< one per frame, increasing
  std::vector<cv::Mat> images;    ///< BGR; empty: NumberedImage of the frame index
  bool full_range = false;
  int color_space = 2;             ///< AVColorSpace: 2 unspecified, 1 BT.709
  int rotation_deg = 0;            ///< rotation of the display matrix, clockwise
  cv::Size pixel_aspect = {0, 1};  ///< sample aspect ratio, width : height; 0: unspecified
  int max_b_frames = 0;
  int key_frame_interval = 12;
  bool audio = false;                      ///< true: adds an audio stream
  bool video = true;                       ///< false: audio only
  bool cover = false;                      ///< true: adds an attached image before the video stream
  std::vector<TestPacket> klv = {};        ///< packets of a KLV stream (mpegts)
  bool names_klv = true;                   ///< false: in a private stream without a descriptor
  std::vector<TestPacket> subtitles = {};  ///< packets of a subtitle stream (matroska, mp4)
};

/// Writes the video; a failed check aborts the test if FFmpeg returns an error.
void WriteTestVideo(const std::filesystem::path& path, const TestVideo& video);

/// Moves the beginning of an MP4 of one stream, with B-frames, to a time: its edit list leaves out what comes before,
/// which a decoder may need. A failed check aborts the test if there is no edit list.
void BeginEditListAt(const std::filesystem::path& path, double begin_s);

/// Returns `count` equidistant time stamps: 0, step, 2 step, …
std::vector<std::int64_t> SteadyTimes(int count, std::int64_t step);

/// Reads a file as bytes, for tests that damage it; WriteBytes writes it back.
std::string ReadBytes(const std::filesystem::path& path);
void WriteBytes(const std::filesystem::path& path, const std::string& bytes);

}  // namespace victorious::testing
