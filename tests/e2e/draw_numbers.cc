// draw_numbers FILE.mp4: writes a video whose frames show their own numbers (0 to 89, as black and white fields along
// the upper edge), at a varying rate and with B-frames. For the test that box and frame belong together.
#include <cstdint>
#include <cstdio>
#include <vector>

#include "testing/video_tools.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "draw_numbers: give a file: draw_numbers FILE.mp4\n");
    return 2;
  }
  std::vector<std::int64_t> pts;
  std::int64_t time = 0;
  for (int frame = 0; frame < 90; ++frame) {
    pts.push_back(time);
    time += 20 + 13 * (frame % 7) + (frame % 30 == 29 ? 400 : 0);
  }
  victorious::testing::WriteTestVideo(
      argv[1], {.size = {320, 240}, .time_base_hz = 1000, .pts = pts, .max_b_frames = 3, .key_frame_interval = 30});
  return 0;
}
