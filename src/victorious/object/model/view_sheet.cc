#include "victorious/object/model/view_sheet.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

constexpr std::int64_t kMaxSheetPixels = 100'000'000;
constexpr std::size_t kMaxViews = 2000;
constexpr int kMaxThumbnailPx = 256;
constexpr int kColumns = 36;
constexpr int kGapPx = 4;
constexpr int kCaptionPx = 18;
constexpr int kLabelPx = 92;  // width of the row labels
constexpr int kTitlePx = 26;

const cv::Scalar kPaper = cv::Scalar::all(40);
const cv::Scalar kInk = cv::Scalar::all(230);
const cv::Scalar kBar(90, 200, 120);

struct Tile {
  std::size_t view;
  cv::Mat image;
};

struct Row {
  std::string label;
  std::vector<Tile> tiles;
};

Expected<cv::Mat> DecodeThumbnail(const ObjectModel& model, std::size_t view) {
  const std::string name = fmt::format("model {}, thumbnail of view {}", model.name, view);
  VICTORIOUS_ASSIGN_OR_RETURN(Image image, DecodeImage(model.views[view].thumbnail, name));
  if (std::max(image.bgr.cols, image.bgr.rows) <= kMaxThumbnailPx) return std::move(image.bgr);
  return Fail(ErrorCode::kDataLoss, fmt::format("{}: {} x {} pixels: must be at most {} a side", name, image.bgr.cols,
                                                image.bgr.rows, kMaxThumbnailPx));
}

// The views in sheet order, keyed by off-nadir angle in degrees (rings), each ring sorted by azimuth; views without
// angles are last.
std::map<double, std::vector<std::size_t>> Rings(const ObjectModel& model) {
  constexpr double kNoAngles = 1e9;
  std::map<double, std::vector<std::size_t>> rings;
  for (std::size_t i = 0; i < model.views.size(); ++i) {
    const auto& angles = model.views[i].angles;
    rings[angles ? std::round(1e3 * DegreesFromRadians(angles->off_nadir_rad)) / 1e3 : kNoAngles].push_back(i);
  }
  for (auto& [off_nadir_deg, views] : rings) {
    if (off_nadir_deg == kNoAngles) continue;
    std::ranges::stable_sort(views, {}, [&](std::size_t i) { return model.views[i].angles->azimuth_rad; });
  }
  return rings;
}

Expected<std::vector<Row>> LayOut(const ObjectModel& model) {
  std::vector<Row> rows;
  for (const auto& [off_nadir_deg, views] : Rings(model)) {
    const bool has_angles = model.views[views.front()].angles.has_value();
    const std::string label = has_angles ? fmt::format("off-nadir {:.4g}", off_nadir_deg) : "photos";
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (i % kColumns == 0) rows.push_back({i == 0 ? label : "", {}});
      if (model.views[views[i]].thumbnail.empty()) continue;
      VICTORIOUS_ASSIGN_OR_RETURN(cv::Mat image, DecodeThumbnail(model, views[i]));
      rows.back().tiles.push_back({views[i], std::move(image)});
    }
  }
  return rows;
}

void Write(cv::Mat& sheet, const std::string& text, cv::Point left_base, double size) {
  cv::putText(sheet, text, left_base, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
}

void DrawTile(const ModelView& view, const cv::Mat& image, std::uint64_t max_features, const cv::Rect& cell,
              cv::Mat& sheet) {
  constexpr int kBarPx = 3;
  const cv::Point inset((cell.width - image.cols) / 2, (cell.height - kCaptionPx - image.rows) / 2);
  image.copyTo(sheet(cv::Rect(cell.tl() + inset, image.size())));
  const std::string azimuth =
      view.angles ? fmt::format("az {:.4g}", std::round(10 * DegreesFromRadians(view.angles->azimuth_rad)) / 10) : "";
  const cv::Point base(cell.x, cell.br().y - kBarPx - 3);
  Write(sheet, azimuth, base, 0.34);
  const std::string features = std::to_string(view.feature_count);
  const int width = cv::getTextSize(features, cv::FONT_HERSHEY_SIMPLEX, 0.34, 1, nullptr).width;
  Write(sheet, features, {cell.br().x - width, base.y}, 0.34);
  const double fraction =
      static_cast<double>(view.feature_count) / static_cast<double>(std::max<std::uint64_t>(1, max_features));
  cv::rectangle(sheet, cv::Rect(cell.x, cell.br().y - kBarPx, cvRound(fraction * cell.width), kBarPx), kBar,
                cv::FILLED);
}

}  // namespace

Expected<cv::Mat> DrawViewSheet(const ObjectModel& model) {
  if (std::ranges::all_of(model.views, [](const ModelView& view) { return view.thumbnail.empty(); })) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("model {}: its file has no thumbnails of its views, because version {} kept none: remove "
                            "the model and add it again",
                            model.name, model.program_version));
  }
  if (model.views.size() > kMaxViews) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("model {}: {} views are too many for one sheet: must be at most {}", model.name,
                            model.views.size(), kMaxViews));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Row> rows, LayOut(model));
  int side = 0;
  std::size_t columns = 0;
  std::uint64_t max_features = 0;
  for (const Row& row : rows) {
    columns = std::max(columns, row.tiles.size());
    for (const Tile& tile : row.tiles) {
      side = std::max({side, tile.image.cols, tile.image.rows});
      max_features = std::max(max_features, model.views[tile.view].feature_count);
    }
  }

  const cv::Size step(side + kGapPx, side + kCaptionPx + kGapPx);
  const std::string title = fmt::format(
      "{}: {} views, {} features. {}Number and bar: features", model.name, model.views.size(), model.features.size(),
      model.kind == ModelKind::kCad ? "az: azimuth in degrees, 0 from behind, 90 from its left. " : "");
  const int title_width = cv::getTextSize(title, cv::FONT_HERSHEY_SIMPLEX, 0.5, 1, nullptr).width + 2 * kGapPx;
  const cv::Size size(std::max(title_width, kLabelPx + static_cast<int>(columns) * step.width),
                      kTitlePx + static_cast<int>(rows.size()) * step.height);
  if (static_cast<std::int64_t>(size.width) * size.height > kMaxSheetPixels) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("model {}: its views make a sheet of {} x {} pixels: must be at most {} in all", model.name,
                            size.width, size.height, kMaxSheetPixels));
  }
  cv::Mat sheet(size, CV_8UC3, kPaper);
  Write(sheet, title, {kGapPx, 18}, 0.5);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const int top = kTitlePx + static_cast<int>(r) * step.height;
    Write(sheet, rows[r].label, {kGapPx, top + side / 2}, 0.4);
    for (std::size_t c = 0; c < rows[r].tiles.size(); ++c) {
      const Tile& tile = rows[r].tiles[c];
      const cv::Rect cell(kLabelPx + static_cast<int>(c) * step.width, top, side, side + kCaptionPx);
      DrawTile(model.views[tile.view], tile.image, max_features, cell, sheet);
    }
  }
  return sheet;
}

}  // namespace victorious
