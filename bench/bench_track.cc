#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/tracking.hpp>
#include <opencv2/video/tracking.hpp>

#include "bench/benchmarks.h"
#include "bench/workloads.h"
#include "victorious/track/box_tracker.h"
#include "victorious/track/region_tracker.h"

namespace victorious::bench {
namespace {

std::vector<Frame> RenderFrames(const testing::SyntheticFlight& flight, int count) {
  std::vector<Frame> frames;
  for (int i = 0; i < count; ++i) frames.push_back(flight.Render(i));
  return frames;
}

/// Frames per second; the first frame is not tracked.
void AddRate(std::size_t frames, Result& result) {
  result.figures = {{"frames_per_s", 1000 * static_cast<double>(frames - 1) / result.median_ms}};
}

Result TimeRegions(const std::vector<Frame>& frames, const Settings& settings) {
  constexpr int kPoints = 50;  // per region
  const std::vector<Box> boxes = {{60, 60, 120, 100}, {300, 80, 140, 120}, {80, 280, 130, 110}, {400, 300, 120, 120}};
  const auto follow = [&] {
    RegionTracker tracker = RegionTracker::Create({}).value();
    tracker.Step(frames.front());
    cv::Mat grey;
    cv::extractChannel(frames.front().image, grey, 1);
    for (const Box& box : boxes) {
      std::vector<TrackPoint> points;
      for (const Eigen::Vector2d& place : DetectCorners(grey, BoxCorners(box), kPoints)) points.push_back({place, {}});
      tracker.Start(BoxCorners(box), points);
    }
    double seen = 0;
    for (std::size_t i = 1; i < frames.size(); ++i) {
      for (const TrackStep& step : tracker.Step(frames[i])) seen += step.seen() ? 1 : 0;
    }
    return seen;
  };
  Result result = Compare("track_4_regions", {"victorious", follow}, {}, settings.effort());
  AddRate(frames.size(), result);
  result.figures.emplace_back("seen", follow());
  return result;
}

Implementation Peer(const std::string& name, std::function<cv::Ptr<cv::Tracker>()> make,
                    const std::vector<Frame>& frames, const cv::Rect& start) {
  return {name, [&frames, start, make = std::move(make)] {
            const cv::Ptr<cv::Tracker> tracker = make();
            tracker->init(frames.front().image, start);
            cv::Rect box = start;
            for (std::size_t i = 1; i < frames.size(); ++i) tracker->update(frames[i].image, box);
            return static_cast<double>(box.x);
          }};
}

Result TimeBox(const std::vector<Frame>& frames, const Box& box, const Settings& settings) {
  const auto follow = [&] {
    BoxTracker tracker = BoxTracker::Create({}).value();
    tracker.Step(frames.front());
    tracker.Start(box).value();
    double seen = 0;
    for (std::size_t i = 1; i < frames.size(); ++i) seen += tracker.Step(frames[i]).front().seen() ? 1 : 0;
    return seen;
  };
  const cv::Rect start(static_cast<int>(box.x), static_cast<int>(box.y), static_cast<int>(box.width),
                       static_cast<int>(box.height));
  Result result = Compare("track_box", {"victorious", follow},
                          {Peer(
                               "csrt", [] { return cv::TrackerCSRT::create(); }, frames, start),
                           Peer(
                               "kcf", [] { return cv::TrackerKCF::create(); }, frames, start),
                           Peer(
                               "mil", [] { return cv::TrackerMIL::create(); }, frames, start)},
                          settings.effort());
  AddRate(frames.size(), result);
  result.figures.emplace_back("seen", follow());
  return result;
}

}  // namespace

std::vector<Result> BenchTrack(const Settings& settings) {
  const testing::SyntheticFlight flight = MakeSyntheticFlight();
  const std::vector<Frame> frames = RenderFrames(flight, settings.quick ? 3 : 16);
  return {TimeRegions(frames, settings), TimeBox(frames, flight.Truth(0).front().box, settings)};
}

}  // namespace victorious::bench
