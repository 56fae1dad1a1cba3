#include "victorious/show/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/count_text.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/show/choose_moments.h"
#include "victorious/store/catalogue.h"

namespace victorious {

void ContactSheetOptions::ListFields(FieldList& fields) {
  fields.Add("max_tiles", max_tiles, {.min = 1, .max = 1000, .reason = "maximum number of objects shown, best first"});
  fields.Add("columns", columns, {.min = 1, .max = 50, .reason = "tiles in a row"});
  fields.Add("tile_width_px", tile_width_px, {.min = 64, .max = 2000, .unit = "px", .reason = "width of a tile"});
  fields.Add("moments", moments, {.min = 1, .max = 16, .reason = "number of moments at which an object is cut out"});
}

namespace {

constexpr int kCaptionHeightPx = 34;

// A sighting that is shown.
struct Moment {
  std::int64_t video = 0;
  std::int64_t frame = 0;
  double time_s = 0;
  Box box;
  Polygon outline;
  int matches = 0;
  double score = 0;
  cv::Mat cut_out;

  [[nodiscard]] MomentRank Rank() const { return {matches, score}; }
};

struct Tile {
  ObjectRecord object;
  std::string model;
  std::vector<Moment> moments;  // of all sightings, then of those shown
  std::size_t best = 0;         // index of the moment whose whole frame is shown
  cv::Mat frame;
};

void Caption(cv::Mat& image, const std::string& text, const cv::Point& at, double scale = 0.42) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar::all(235), 1, cv::LINE_AA);
}

void SelectMoments(Tile& tile, int count) {
  std::vector<MomentRank> ranks;
  for (const Moment& moment : tile.moments) ranks.push_back(moment.Rank());
  std::vector<Moment> selected;
  for (const std::size_t i : ChooseMoments(ranks, static_cast<std::size_t>(count))) {
    selected.push_back(std::move(tile.moments[i]));
  }
  tile.moments = std::move(selected);
  tile.best =
      static_cast<std::size_t>(std::ranges::max_element(tile.moments, {}, &Moment::Rank) - tile.moments.begin());
}

// The frame, scaled to the tile, with the outline drawn onto it.
cv::Mat DrawFrame(const Tile& tile, const cv::Mat& frame, int width) {
  const double factor = static_cast<double>(width) / frame.cols;
  cv::Mat small;
  cv::resize(frame, small, {width, std::max(1, static_cast<int>(std::lround(frame.rows * factor)))}, 0, 0,
             cv::INTER_AREA);
  const Moment& best = tile.moments[tile.best];
  std::vector<cv::Point> corners;
  for (const Eigen::Vector2d& corner : best.outline.empty() ? BoxCorners(best.box) : best.outline)
    corners.emplace_back(cv::Point2d(corner.x() * factor, corner.y() * factor));
  const cv::Scalar colour = tile.object.rejected.empty() ? cv::Scalar(0, 255, 255) : cv::Scalar(0, 0, 255);
  cv::polylines(small, corners, true, colour, 2, cv::LINE_AA);
  return small;
}

// The place of an interval in a longer one from 0 on: moved inside where it fits.
int MovedInside(int from, int length, int whole) {
  return length <= whole ? std::clamp(from, 0, whole - length) : from;
}

// The object with a quarter of its size around it, as a square of this side. Nothing is drawn on it.
cv::Mat CutOut(const cv::Mat& frame, const Moment& moment, int side) {
  constexpr double kMargin = 1.5;  // side of the cut-out relative to the longer side of the box
  constexpr double kMaxEnlargement = 4;
  const double extent_px = std::max(kMargin * std::max(moment.box.width, moment.box.height), side / kMaxEnlargement);
  const cv::Point2d centre(moment.box.x + moment.box.width / 2, moment.box.y + moment.box.height / 2);
  const auto extent = static_cast<int>(std::lround(std::min(extent_px, 2.0 * std::max(frame.cols, frame.rows))));
  const cv::Rect wanted(MovedInside(cvRound(centre.x - extent / 2.0), extent, frame.cols),
                        MovedInside(cvRound(centre.y - extent / 2.0), extent, frame.rows), extent, extent);
  const cv::Rect inside = wanted & cv::Rect({0, 0}, frame.size());
  cv::Mat cut = cv::Mat::zeros(wanted.size(), CV_8UC3);
  if (!inside.empty()) frame(inside).copyTo(cut(inside - wanted.tl()));
  cv::Mat scaled;
  cv::resize(cut, scaled, {side, side}, 0, 0, extent > side ? cv::INTER_AREA : cv::INTER_CUBIC);
  return scaled;
}

// Times of several videos have nothing in common: the number of videos stands instead.
std::string SeenText(const ObjectRecord& object) {
  const std::string frames = CountText(object.frames, "frame");
  if (object.videos.size() > 1) return fmt::format("{} in {}", frames, CountText(object.videos.size(), "video"));
  return fmt::format("seen {:.1f} to {:.1f} s, {}", object.first_time_s, object.last_time_s, frames);
}

// The frame, below it the cut-outs side by side with their times, and the caption.
cv::Mat DrawTile(const Tile& tile, const ContactSheetOptions& options) {
  const int side = options.tile_width_px / options.moments;
  const int below = tile.frame.rows + side;
  cv::Mat image(below + kCaptionHeightPx, options.tile_width_px, CV_8UC3, cv::Scalar::all(24));
  tile.frame.copyTo(image(cv::Rect({0, 0}, tile.frame.size())));
  for (std::size_t i = 0; i < tile.moments.size(); ++i) {
    const cv::Rect place(static_cast<int>(i) * side, tile.frame.rows, side, side);
    const Moment& moment = tile.moments[i];
    if (moment.cut_out.empty()) continue;
    moment.cut_out.copyTo(image(place));
    image(cv::Rect(place.x, place.y, 1, side)) = cv::Scalar::all(24);
    cv::Mat strip = image(cv::Rect(place.x, place.y + side - 12, side, 12));
    strip *= 0.4;
    Caption(image, fmt::format("{:.1f} s", moment.time_s), {place.x + 3, place.y + side - 3}, 0.32);
  }
  const ObjectRecord& object = tile.object;
  Caption(image, fmt::format("{}  score {:.2f}  object {}", tile.model, object.score, object.id), {4, below + 13});
  Caption(image,
          object.rejected.empty() ? fmt::format("{:.2f} s ({})", tile.moments[tile.best].time_s, SeenText(object))
                                  : "rejected: " + object.rejected,
          {4, below + 28});
  return image;
}

// Reads one video once and cuts out the moments that are in it.
Status DrawMomentsOf(const VideoRecord& video, std::vector<Tile>& tiles, const ContactSheetOptions& options) {
  std::multimap<std::int64_t, std::pair<Tile*, Moment*>> by_frame;
  for (Tile& tile : tiles) {
    for (Moment& moment : tile.moments) {
      if (moment.video == video.id) by_frame.emplace(moment.frame, std::pair(&tile, &moment));
    }
  }
  if (by_frame.empty()) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(FindVideoFile(video), {.color = FrameColor::kBgr}));
  while (!by_frame.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Frame> frame, reader->NextFrame());
    if (!frame) break;
    const auto [first, last] = by_frame.equal_range(frame->index);
    for (auto one = first; one != last; ++one) {
      const auto [tile, moment] = one->second;
      moment->cut_out = CutOut(frame->image, *moment, options.tile_width_px / options.moments);
      if (moment == &tile->moments[tile->best]) tile->frame = DrawFrame(*tile, frame->image, options.tile_width_px);
    }
    by_frame.erase(first, last);
  }
  return {};
}

cv::Mat Compose(const std::vector<cv::Mat>& tiles, const ContactSheetOptions& options) {
  constexpr int kGapPx = 6;
  int height = 0;
  for (const cv::Mat& tile : tiles) height = std::max(height, tile.rows);
  const int columns = std::min(options.columns, static_cast<int>(tiles.size()));
  const int rows = (static_cast<int>(tiles.size()) + columns - 1) / columns;
  cv::Mat sheet(rows * (height + kGapPx) + kGapPx, columns * (options.tile_width_px + kGapPx) + kGapPx, CV_8UC3,
                cv::Scalar::all(60));
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const auto column = static_cast<int>(i) % columns;
    const auto row = static_cast<int>(i) / columns;
    const cv::Point corner(kGapPx + column * (options.tile_width_px + kGapPx), kGapPx + row * (height + kGapPx));
    tiles[i].copyTo(sheet(cv::Rect(corner, tiles[i].size())));
  }
  return sheet;
}

}  // namespace

Expected<cv::Mat> DrawContactSheet(const SightingFilter& filter, const ContactSheetOptions& options,
                                   IndexStore& store) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue catalogue, Catalogue::Read(store, filter));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, store.Objects(filter));
  std::vector<Tile> tiles;
  std::map<std::int64_t, std::size_t> tile_of;  // object id -> tile index
  for (const ObjectRecord& object : objects) {
    if (tiles.size() == static_cast<std::size_t>(options.max_tiles)) break;
    const ModelRecord* model = catalogue.Model(object.model);
    if (model == nullptr) continue;
    tile_of[object.id] = tiles.size();
    tiles.push_back({.object = object, .model = model->name, .moments = {}, .best = 0, .frame = {}});
  }
  VICTORIOUS_RETURN_IF_ERROR(store.VisitSightings(filter, [&](SightingRecord&& sighting) {
    const auto found = tile_of.find(sighting.object);
    if (found != tile_of.end() && catalogue.Video(sighting.video) != nullptr) {
      tiles[found->second].moments.push_back({.video = sighting.video,
                                              .frame = sighting.frame,
                                              .time_s = sighting.time_s,
                                              .box = sighting.box,
                                              .outline = std::move(sighting.outline),
                                              .matches = sighting.matches,
                                              .score = sighting.score,
                                              .cut_out = {}});
    }
    return true;
  }));
  // The time interval of an object may overlap the requested one without a sighting in it.
  std::erase_if(tiles, [](const Tile& tile) { return tile.moments.empty(); });
  for (Tile& tile : tiles) SelectMoments(tile, options.moments);
  for (const VideoRecord& video : catalogue.videos()) {
    VICTORIOUS_RETURN_IF_ERROR(DrawMomentsOf(video, tiles, options));
  }
  std::erase_if(tiles, [](const Tile& tile) { return tile.frame.empty(); });
  if (tiles.empty())
    return Fail(ErrorCode::kInvalidArgument,
                "no object in the index passes the filter: widen --video, --from, --to, or index a video first");
  std::vector<cv::Mat> images;
  for (const Tile& tile : tiles) images.push_back(DrawTile(tile, options));
  return Compose(images, options);
}

}  // namespace victorious
