#include "victorious/pipeline/contact_sheet.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "victorious/store/catalogue.h"
#include "victorious/video/video_reader.h"

namespace victorious {

void ContactSheetOptions::ListFields(FieldList& fields) {
  fields.Add("max_tiles", max_tiles, {.min = 1, .max = 1000, .reason = "maximum number of objects shown, best first"});
  fields.Add("columns", columns, {.min = 1, .max = 50, .reason = "tiles in a row"});
  fields.Add("tile_width_px", tile_width_px, {.min = 64, .max = 2000, .unit = "px", .reason = "width of a tile"});
}

namespace {

constexpr int kCaptionHeightPx = 34;

struct Tile {
  ObjectRecord object;
  std::string model;
  SightingRecord best;
  cv::Mat image;
};

std::vector<cv::Point> Corners(const Polygon& outline, double factor) {
  std::vector<cv::Point> corners;
  for (const Eigen::Vector2d& corner : outline)
    corners.emplace_back(cv::Point2d(corner.x() * factor, corner.y() * factor));
  return corners;
}

// The frame, scaled to the tile, with the outline drawn onto it.
cv::Mat DrawTile(const Tile& tile, const cv::Mat& frame, const cv::Size& size) {
  cv::Mat image(size.height + kCaptionHeightPx, size.width, CV_8UC3, cv::Scalar::all(24));
  const double factor =
      std::min(static_cast<double>(size.width) / frame.cols, static_cast<double>(size.height) / frame.rows);
  cv::Mat small;
  cv::resize(frame, small, {}, factor, factor, cv::INTER_AREA);
  const Polygon outline = tile.best.outline.empty() ? BoxCorners(tile.best.box) : tile.best.outline;
  const bool rejected = !tile.object.rejected.empty();
  const cv::Scalar colour = rejected ? cv::Scalar(0, 0, 255) : cv::Scalar(0, 255, 255);
  cv::polylines(small, Corners(outline, factor), true, colour, 2, cv::LINE_AA);
  small.copyTo(image(cv::Rect({0, 0}, small.size())));
  const auto caption = [&](const std::string& text, int line) {
    cv::putText(image, text, {4, size.height + 13 + 15 * line}, cv::FONT_HERSHEY_SIMPLEX, 0.42, cv::Scalar::all(235), 1,
                cv::LINE_AA);
  };
  caption(fmt::format("{}  score {:.2f}  object {}", tile.model, tile.object.score, tile.object.id), 0);
  caption(rejected ? "rejected: " + tile.object.rejected
                   : fmt::format("{:.2f} s (seen {:.1f} to {:.1f} s, {} frames)", tile.best.time_s,
                                 tile.object.first_time_s, tile.object.last_time_s, tile.object.frames),
          1);
  return image;
}

// Reads one video once and draws the tiles whose best sighting is in it.
Status DrawTilesOf(const VideoRecord& video, const std::vector<Tile*>& tiles, int tile_width) {
  std::map<std::int64_t, std::vector<Tile*>> by_frame;
  for (Tile* tile : tiles) by_frame[tile->best.frame].push_back(tile);
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(video.name, {.color = FrameColor::kBgr}));
  const cv::Size size(tile_width, std::max(1, tile_width * video.height / std::max(1, video.width)));
  while (!by_frame.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Frame> frame, reader->NextFrame());
    if (!frame) break;
    const auto found = by_frame.find(frame->index);
    if (found == by_frame.end()) continue;
    for (Tile* tile : found->second) tile->image = DrawTile(*tile, frame->image, size);
    by_frame.erase(found);
  }
  return {};
}

cv::Mat Compose(const std::vector<Tile>& tiles, const ContactSheetOptions& options) {
  constexpr int kGapPx = 6;
  int height = 0;
  for (const Tile& tile : tiles) height = std::max(height, tile.image.rows);
  const int columns = std::min(options.columns, static_cast<int>(tiles.size()));
  const int rows = (static_cast<int>(tiles.size()) + columns - 1) / columns;
  cv::Mat sheet(rows * (height + kGapPx) + kGapPx, columns * (options.tile_width_px + kGapPx) + kGapPx, CV_8UC3,
                cv::Scalar::all(60));
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const auto column = static_cast<int>(i) % columns;
    const auto row = static_cast<int>(i) / columns;
    const cv::Point corner(kGapPx + column * (options.tile_width_px + kGapPx), kGapPx + row * (height + kGapPx));
    tiles[i].image.copyTo(sheet(cv::Rect(corner, tiles[i].image.size())));
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
    tiles.push_back({.object = object, .model = model->name, .best = {.matches = -1}, .image = {}});
  }
  VICTORIOUS_RETURN_IF_ERROR(store.VisitSightings(filter, [&](SightingRecord&& sighting) {
    const auto found = tile_of.find(sighting.object);
    if (found != tile_of.end() && catalogue.Video(sighting.video) != nullptr) {
      Tile& tile = tiles[found->second];
      const auto rank = [](const SightingRecord& one) { return std::pair(one.matches, one.score); };
      if (rank(sighting) > rank(tile.best)) tile.best = std::move(sighting);
    }
    return true;
  }));
  // The time interval of an object may overlap the requested one without a sighting in it.
  std::erase_if(tiles, [](const Tile& tile) { return tile.best.matches < 0; });

  std::map<std::int64_t, std::vector<Tile*>> by_video;
  for (Tile& tile : tiles) by_video[tile.best.video].push_back(&tile);
  for (const auto& [video, of_video] : by_video) {
    VICTORIOUS_RETURN_IF_ERROR(DrawTilesOf(*catalogue.Video(video), of_video, options.tile_width_px));
  }
  std::erase_if(tiles, [](const Tile& tile) { return tile.image.empty(); });
  if (tiles.empty())
    return Fail(ErrorCode::kInvalidArgument,
                "no object in the index passes the filter: widen --video, --from, --to, or index a video first");
  return Compose(tiles, options);
}

}  // namespace victorious
