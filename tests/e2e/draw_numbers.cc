// draw_numbers FILE: writes a video whose frames show their own numbers (0 to 89, as black and white fields along the
// upper edge), with B-frames. For the tests that box and frame belong together. FILE.mp4 and FILE.ts have H.264 at a
// varying rate, FILE.mpg MPEG-1 at a steady one.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "testing/video_tools.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "draw_numbers: give a file: draw_numbers FILE.mp4|.ts|.mpg\n");
    return 2;
  }
  std::vector<std::int64_t> pts;
  std::int64_t time = 0;
  for (int frame = 0; frame < 90; ++frame) {
    pts.push_back(time);
    time += 20 + 13 * (frame % 7) + (frame % 30 == 29 ? 400 : 0);
  }
  const std::string ending = std::filesystem::path(argv[1]).extension();
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
                                                .max_b_frames = 3,
                                                .key_frame_interval = 30});
  return 0;
}
