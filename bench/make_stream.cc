// make-stream VIDEO FILE.ts [TIMES]: the frames of a video, TIMES times one after the other, as a camera sends them: an
// MPEG transport stream with a key frame a second and without B-frames. For live_delay.py and real_time.py.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "testing/video_tools.h"
#include "victorious/input/video/video_reader.h"

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "make-stream: give video and stream: make-stream VIDEO FILE.ts [TIMES]\n");
    return 2;
  }
  const int times = argc > 3 ? std::atoi(argv[3]) : 1;
  const auto reader = victorious::VideoReader::Open(argv[1], {.color = victorious::FrameColor::kBgr});
  if (!reader) {
    std::fprintf(stderr, "make-stream: %s\n", reader.error().message.c_str());
    return 1;
  }
  const int rate_hz = static_cast<int>(std::lround((*reader)->info().frame_rate));
  std::vector<cv::Mat> once;
  for (;;) {
    const auto frame = (*reader)->NextFrame();
    if (!frame || !*frame) break;
    once.push_back((*frame)->image);
  }
  std::vector<cv::Mat> images;
  for (int i = 0; i < times; ++i) images.insert(images.end(), once.begin(), once.end());
  const auto count = static_cast<int>(images.size());
  victorious::testing::WriteTestVideo(argv[2], {.muxer = "mpegts",
                                                .size = once.front().size(),
                                                .time_base_hz = rate_hz,
                                                .pts = victorious::testing::SteadyTimes(count, 1),
                                                .images = std::move(images),
                                                .max_b_frames = 0,
                                                .key_frame_interval = rate_hz});
  return 0;
}
