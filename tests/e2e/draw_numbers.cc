// draw_numbers FILE: writes a video whose frames show their own numbers (0 to 89, as black and white fields along the
// upper edge), with B-frames. For the tests that box and frame belong together. FILE.mp4 and FILE.ts have H.264 at a
// varying rate, FILE.mpg MPEG-1 at a steady one. FILE.edit.mp4 has ten more frames, numbered 200 to 209, before them,
// which its edit list leaves out. FILE.one_key.mp4 has 1500 larger frames, of which only the first is a key frame: to
// show the last, a decoder decodes all.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "testing/video_tools.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "draw_numbers: give a file: draw_numbers FILE.mp4|.ts|.mpg\n");
    return 2;
  }
  const std::filesystem::path path = argv[1];
  const std::string ending = path.extension();
  if (path.stem().extension() == ".one_key") {
    constexpr int kFrames = 1500;
    std::vector<cv::Mat> frames;
    for (int number = 0; number < kFrames; ++number) {
      constexpr int kNumbers = 256;
      frames.push_back(number < kNumbers ? victorious::testing::NumberedImage(number, {640, 480})
                                         : frames[static_cast<std::size_t>(number % kNumbers)]);
    }
    victorious::testing::WriteTestVideo(path, {.encoder = "mpeg4",
                                               .size = {640, 480},
                                               .time_base_hz = 25,
                                               .pts = victorious::testing::SteadyTimes(kFrames, 1),
                                               .images = std::move(frames),
                                               .key_frame_interval = kFrames});
    return 0;
  }
  const int left_out = path.stem().extension() == ".edit" ? 10 : 0;
  std::vector<std::int64_t> pts;
  std::vector<cv::Mat> images;
  std::int64_t time = 0;
  std::int64_t begin = 0;
  for (int frame = -left_out; frame < 90; ++frame) {
    if (frame == 0) begin = time;
    pts.push_back(time);
    images.push_back(victorious::testing::NumberedImage(frame < 0 ? 210 + frame : frame, {320, 240}));
    time += 20 + 13 * ((frame + left_out) % 7) + (frame % 30 == 29 ? 400 : 0);
  }
  if (ending == ".mpg") {
    victorious::testing::WriteTestVideo(argv[1], {.muxer = "mpeg",
                                                  .encoder = "mpeg1video",
                                                  .size = {320, 240},
                                                  .time_base_hz = 25,
                                                  .pts = victorious::testing::SteadyTimes(90, 1),
                                                  .max_b_frames = 2});
    return 0;
  }
  victorious::testing::WriteTestVideo(argv[1], {.muxer = ending == ".ts" ? "mpegts" : "mp4",
                                                .size = {320, 240},
                                                .time_base_hz = 1000,
                                                .pts = pts,
                                                .images = images,
                                                .max_b_frames = 3,
                                                .key_frame_interval = 30});
  if (left_out > 0) victorious::testing::BeginEditListAt(path, 1e-3 * static_cast<double>(begin));
  return 0;
}
