#include "victorious/show/drawn_video.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/camera_csv.h"
#include "victorious/input/video/frame_loop.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/input/video/video_writer.h"
#include "victorious/place/cameras/video_telemetry.h"
#include "victorious/store/catalogue.h"

namespace victorious {
namespace {

// Bright colours that differ from each other and from the ground.
const std::array kColours = {cv::Scalar(0, 255, 255),   cv::Scalar(255, 255, 0),  cv::Scalar(255, 0, 255),
                             cv::Scalar(80, 255, 80),   cv::Scalar(0, 140, 255),  cv::Scalar(255, 160, 80),
                             cv::Scalar(160, 160, 255), cv::Scalar(255, 255, 255)};

// Sizes of text and lines for a frame of this height.
struct DrawnScale {
  explicit DrawnScale(int height_px)
      : text(std::clamp(height_px / 1100.0, 0.38, 2.0)),
        thickness(std::max(1, height_px / 500)),
        line_px(static_cast<int>(30 * text)) {}
  double text;
  int thickness;
  int line_px;
};

std::string PlaceText(const Geolocation& place) {
  std::string text = fmt::format("{:.6f}, {:.6f}  CE90 {:.1f} m", DegreesFromRadians(place.point.latitude_rad),
                                 DegreesFromRadians(place.point.longitude_rad), place.ce90_m);
  if (place.IsMoving()) text += fmt::format("  {:.1f} m/s", place.velocity_enu->norm());
  return text;
}

// Lines of text on a dark background, moved into the frame.
void WriteLines(cv::Mat& frame, const std::vector<std::string>& lines, cv::Point at, const cv::Scalar& colour,
                const DrawnScale& scale) {
  const int weight = std::max(1, scale.thickness - 1);
  int width = 0;
  for (const std::string& line : lines) {
    int baseline = 0;
    width = std::max(width, cv::getTextSize(line, cv::FONT_HERSHEY_SIMPLEX, scale.text, weight, &baseline).width);
  }
  const cv::Size size(width + 6, static_cast<int>(lines.size()) * scale.line_px + 4);
  at.x = std::clamp(at.x, 0, std::max(0, frame.cols - size.width));
  at.y = std::clamp(at.y, 0, std::max(0, frame.rows - size.height));
  cv::Mat background = frame(cv::Rect(at, size) & cv::Rect({0, 0}, frame.size()));
  background *= 0.35;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const cv::Point origin = at + cv::Point(3, static_cast<int>((static_cast<double>(i) + 0.75) * scale.line_px) + 2);
    cv::putText(frame, lines[i], origin, cv::FONT_HERSHEY_SIMPLEX, scale.text, colour, weight, cv::LINE_AA);
  }
}

void DrawSighting(const DrawnSighting& sighting, const DrawnScale& scale, cv::Mat& frame) {
  const cv::Scalar& colour = kColours[sighting.identity % kColours.size()];
  std::vector<cv::Point> corners;
  for (const Eigen::Vector2d& corner : sighting.outline) corners.emplace_back(cv::Point2d(corner.x(), corner.y()));
  cv::polylines(frame, corners, true, colour, scale.thickness, cv::LINE_AA);
  const Box box = BoundingBox(sighting.outline);
  const int height = static_cast<int>(sighting.lines.size()) * scale.line_px + 4;
  const bool above = box.y >= height + 2;  // else below the object, so that the text does not hide it
  const int y = static_cast<int>(above ? box.y - height - 2 : box.y + box.height + 2);
  WriteLines(frame, sighting.lines, {static_cast<int>(box.x), y}, colour, scale);
}

// The way of each object's middle, from its sightings in the frames up to this one.
class TrackDrawer {
 public:
  explicit TrackDrawer(int frames) : frames_(frames) {}

  void Add(const DrawnSighting& sighting) {
    const Box box = BoundingBox(sighting.outline);
    tracks_[sighting.identity].emplace_back(sighting.frame, cv::Point2d(box.x + box.width / 2, box.y + box.height / 2));
  }

  void Draw(std::int64_t frame, const DrawnScale& scale, cv::Mat& image) {
    for (auto& [identity, track] : tracks_) {
      std::erase_if(track, [&](const auto& one) { return one.first < frame - frames_; });
      std::vector<cv::Point> points;
      for (const auto& [at, middle] : track) points.emplace_back(middle);
      cv::polylines(image, points, false, kColours[identity % kColours.size()], scale.thickness, cv::LINE_AA);
    }
  }

 private:
  int frames_;
  std::map<std::uint64_t, std::vector<std::pair<std::int64_t, cv::Point2d>>> tracks_;
};

// Exported times are rounded.
constexpr double kRounding_s = 1e-4;

// The encoder takes even sizes only.
cv::Mat MakeEven(const cv::Mat& image) {
  if (image.cols % 2 == 0 && image.rows % 2 == 0) return image;
  cv::Mat even;
  cv::copyMakeBorder(image, even, 0, image.rows % 2, 0, image.cols % 2, cv::BORDER_REPLICATE);
  return even;
}

}  // namespace

Expected<VideoSpan> DrawVideo(const std::string& video, std::span<const DrawnSighting> sightings,
                              const DrawOptions& options, const std::filesystem::path& path,
                              const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      const auto reader,
      VideoReader::Open(video, {.color = FrameColor::kBgr, .folder_frame_rate = options.folder_frame_rate}));
  const VideoInfo& info = reader->info();
  if (info.live) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: a live source is over once it was read: record it, then draw the recording", video));
  }
  // A reader that has sought knows the times of its frames, but not their numbers. If it cannot, the frames are read
  // from the beginning.
  const bool has_sought = options.clip && reader->SeekTo(options.clip->from_s);
  std::multimap<double, const DrawnSighting*> by_place;
  for (const DrawnSighting& sighting : sightings) {
    by_place.emplace(has_sought ? sighting.time_s : static_cast<double>(sighting.frame), &sighting);
  }
  constexpr double kDefaultRate = 25;
  constexpr int kCrf = 20;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto writer,
                              VideoWriter::Create(path, {.width = info.width + info.width % 2,
                                                         .height = info.height + info.height % 2,
                                                         .fps = info.frame_rate > 0 ? info.frame_rate : kDefaultRate,
                                                         .crf = kCrf,
                                                         .timed = true}));
  const DrawnScale scale(info.height);
  TrackDrawer tracks(options.track_frames);
  std::optional<VideoSpan> written;
  FrameLoop loop(*reader, cancel, {.label = path.filename().string()});
  VICTORIOUS_ASSIGN_OR_RETURN(const FrameLoopEnd end, loop.ForEach([&](Frame& frame) -> Status {
    if (options.clip && frame.time_s < options.clip->from_s - kRounding_s) return {};
    if (options.clip && frame.time_s > options.clip->to_s + kRounding_s) {
      loop.Stop();
      return {};
    }
    const double place = has_sought ? frame.time_s : static_cast<double>(frame.index);
    const auto first = by_place.lower_bound(place - kRounding_s);
    const auto last = by_place.upper_bound(place + kRounding_s);
    for (auto one = first; one != last; ++one) tracks.Add(*one->second);
    if (options.track_frames > 0 && first != last) tracks.Draw(first->second->frame, scale, frame.image);
    for (auto one = first; one != last; ++one) DrawSighting(*one->second, scale, frame.image);
    const std::string label = options.clip ? fmt::format("{:.2f} s", frame.time_s)
                                           : fmt::format("frame {}  {:.2f} s", frame.index, frame.time_s);
    WriteLines(frame.image, {label}, {0, frame.image.rows}, cv::Scalar::all(255), scale);
    if (!written) written = VideoSpan{.from_s = frame.time_s, .to_s = frame.time_s};
    written->to_s = frame.time_s;
    return writer->WriteAt(MakeEven(frame.image), frame.time_s - (options.clip ? written->from_s : 0));
  }));
  if (end == FrameLoopEnd::kCancelled) {
    return Fail(ErrorCode::kCancelled, fmt::format("{}: stopped; no video was written", path.string()));
  }
  if (options.clip && !written) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: no frame from {:.2f} s to {:.2f} s", video, options.clip->from_s, options.clip->to_s));
  }
  VICTORIOUS_RETURN_IF_ERROR(writer->Finish());
  return written.value_or(VideoSpan());
}

std::filesystem::path ClipTelemetryPath(const std::filesystem::path& clip) {
  return std::filesystem::path(clip).replace_extension(".telemetry.csv");
}

Expected<std::size_t> WriteClipTelemetry(const std::string& video, const std::optional<std::string>& file,
                                         const VideoSpan& span, const std::filesystem::path& clip,
                                         const std::function<void(const std::string&)>& warn) {
  std::optional<Telemetry> telemetry;
  if (file) {
    VICTORIOUS_ASSIGN_OR_RETURN(telemetry, ReadTelemetry(*file, {}));
  } else {
    VICTORIOUS_ASSIGN_OR_RETURN(telemetry, FindTelemetry(video, {}, warn));
  }
  if (!telemetry) return 0;
  std::vector<CameraState>& states = telemetry->states;
  const auto time_of = [](const CameraState& state) { return state.time_s; };
  std::ranges::stable_sort(states, {}, time_of);
  // With the states before and after, so that those in between can be interpolated.
  auto first = std::ranges::lower_bound(states, span.from_s, {}, time_of);
  auto last = std::ranges::upper_bound(states, span.to_s, {}, time_of);
  if (first != states.begin() && first != states.end() && first->time_s > span.from_s) --first;
  if (last != states.end() && last != states.begin()) ++last;
  if (first >= last) return 0;
  std::vector<CameraState> kept(first, last);
  for (CameraState& state : kept) state.time_s -= span.from_s;
  const std::string text = FormatCameraCsv(kept);
  VICTORIOUS_RETURN_IF_ERROR(WriteFileAtomically(ClipTelemetryPath(clip), text));
  return kept.size();
}

Expected<IndexedDrawing> ListIndexedDrawing(const SightingFilter& filter, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue catalogue, Catalogue::Read(store, filter));
  if (catalogue.videos().size() != 1) {
    std::vector<std::string> names;
    for (const VideoRecord& video : catalogue.videos()) names.push_back(ShownName(video));
    return Fail(ErrorCode::kInvalidArgument,
                names.empty() ? "no video in the index to draw: index one first"
                              : fmt::format("a single video can be drawn, but these match: {}: select one with --video",
                                            fmt::join(names, ", ")));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, store.Objects(filter));
  std::map<std::int64_t, const ObjectRecord*> by_id;
  for (const ObjectRecord& object : objects) by_id[object.id] = &object;
  const VideoRecord& video = catalogue.videos().front();
  IndexedDrawing drawing{.video = FindVideoFile(video), .telemetry = video.telemetry, .sightings = {}};
  VICTORIOUS_RETURN_IF_ERROR(store.VisitSightings(filter, [&](SightingRecord&& sighting) {
    const ModelRecord* model = catalogue.Model(sighting.model);
    const auto object = by_id.find(sighting.object);
    if (model == nullptr || object == by_id.end()) return true;
    DrawnSighting drawn{.frame = sighting.frame,
                        .time_s = sighting.time_s,
                        .outline = sighting.outline.empty() ? BoxCorners(sighting.box) : sighting.outline,
                        .lines = {fmt::format("{} {}  score {:.2f}", model->name, sighting.object, sighting.score)},
                        .identity = static_cast<std::uint64_t>(sighting.object)};
    if (sighting.source == SightingSource::kTracked) drawn.lines.front() += "  tracked";
    const ObjectRecord& record = *object->second;
    if (record.place) drawn.lines.push_back(PlaceText(*record.place));
    if (!record.rejected.empty()) drawn.lines.push_back("rejected: " + record.rejected);
    drawing.sightings.push_back(std::move(drawn));
    return true;
  }));
  return drawing;
}

std::vector<DrawnSighting> ListBoxDrawing(std::span<const BoxSighting> sightings, std::span<const UserBox> boxes) {
  std::vector<DrawnSighting> drawn;
  for (const BoxSighting& sighting : sightings) {
    if (sighting.video != 0) continue;
    const std::string& type = boxes[sighting.box_index].type;
    DrawnSighting one{.frame = sighting.frame,
                      .time_s = sighting.time_s,
                      .outline = BoxCorners(sighting.box),
                      .lines = {fmt::format("{}{}  score {:.2f}", BoxName(sighting.box_index),
                                            type.empty() ? "" : " " + type, sighting.score)},
                      .identity = sighting.box_index};
    if (sighting.place) one.lines.push_back(PlaceText(*sighting.place));
    drawn.push_back(std::move(one));
  }
  return drawn;
}

}  // namespace victorious
