// box-peers VIDEO X,Y,W,H NAME [FRAMES]: tracks a box of the first frame by one of OpenCV's trackers, for
// bench/accuracy/box_tracking.py. Prints one line per frame: its number and the box (x y w h) or "none".
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/tracking.hpp>
#include <opencv2/video/tracking.hpp>

#include "victorious/base/error.h"
#include "victorious/input/video/video_reader.h"

namespace victorious::bench {
namespace {

using MakeTracker = std::function<cv::Ptr<cv::Tracker>()>;

const std::map<std::string, MakeTracker>& Peers() {
  static const std::map<std::string, MakeTracker> peers = {
      {"csrt", [] { return cv::TrackerCSRT::create(); }},
      {"kcf", [] { return cv::TrackerKCF::create(); }},
      {"mil", [] { return cv::TrackerMIL::create(); }},
  };
  return peers;
}

Status Run(const std::string& video, const cv::Rect& start, const MakeTracker& make, std::int64_t frames) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(video, {.color = FrameColor::kBgr}));
  const cv::Ptr<cv::Tracker> tracker = make();
  for (std::int64_t i = 0; i < frames; ++i) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Frame> frame, reader->NextFrame());
    if (!frame) break;
    cv::Rect box = start;
    bool found = true;
    if (i == 0) {
      tracker->init(frame->image, start);
    } else {
      found = tracker->update(frame->image, box);
    }
    fmt::print("{} {}\n", i, found ? fmt::format("{} {} {} {}", box.x, box.y, box.width, box.height) : "none");
  }
  return {};
}

}  // namespace
}  // namespace victorious::bench

int main(int argc, char** argv) {
  using victorious::bench::Peers;
  cv::Rect start;
  if (argc < 4 || argc > 5 ||
      std::sscanf(argv[2], "%d,%d,%d,%d", &start.x, &start.y, &start.width, &start.height) != 4 ||
      !Peers().contains(argv[3])) {
    fmt::print(stderr, "usage: box-peers VIDEO X,Y,W,H csrt|kcf|mil [FRAMES]\n");
    return 2;
  }
  const std::int64_t frames = argc == 5 ? std::atoll(argv[4]) : std::numeric_limits<std::int64_t>::max();
  cv::setNumThreads(1);
  const auto done = victorious::bench::Run(argv[1], start, Peers().at(argv[3]), frames);
  if (done) return 0;
  fmt::print(stderr, "{}\n", done.error().message);
  return victorious::ExitStatus(done.error().code);
}
