#include "victorious/search/recognize/model_shape_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/box.h"
#include "victorious/search/recognize/response_map.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMaxEnlargement = 2;  // of the frame: more shows no more
constexpr std::array kFinerSizes_px = {136.0, 192.0};
constexpr double kMaxFinerEnlargement = 4;
// Of the mean response of all sizes over that of the fine one: hardly any match reaches it (docs/adr/0047).
constexpr double kMaxMeanGrowth = 1.4;
constexpr double kContourSurroundings = 1.6;  // side of what is cut around an object, over its size
constexpr double kMinObject_px = 24;          // diagonal of the bounding box in the frame
constexpr double kMinDown = 0.25;             // cosine of the off-nadir angle: views end at 70 degrees
constexpr double kTileOffNadir_rad = RadiansFromDegrees(6);
constexpr int kOffNadirStep_deg = 5;
constexpr int kCoarseOffNadirStep_deg = 10;
constexpr int kSunStep_deg = 30;
constexpr int kGlanceEighthOctaves = 8;  // half of the coarse size
constexpr double kMinGlanceResponse = 2;
constexpr std::size_t kMaxGlances = 40;         // of a model in a tile
constexpr std::size_t kMaxAssumedGlances = 10;  // of a model, in a frame, of one assumed view
constexpr std::size_t kGlanceHeadings = 2;      // on either side of that of a glance, and of the opposite one
constexpr int kGlanceReach = 2;                 // cells
constexpr double kMinCoarseResponse = 3.5;
constexpr double kMinFineResponse = 4.8;         // of the coarse heading
constexpr double kFineReach_px = 8;              // of a fine template around the coarse place
constexpr double kMinAssumedFineResponse = 4.5;  // of the coarse heading, size and off-nadir angle
constexpr double kSizeStep = 0.125;              // octaves: half of the step between assumed sizes
constexpr double kLargestAssumed = 0.8;          // of the frame's shorter side
constexpr double kOffNadirChange_rad = RadiansFromDegrees(10);
constexpr double kLeanChange_rad = RadiansFromDegrees(8);

int Quantised(double angle_rad, int step_deg) {
  return static_cast<int>(std::lround(DegreesFromRadians(angle_rad) / step_deg)) * step_deg;
}

// std::nullopt above the horizon, near it, and for an object as high as the camera.
std::optional<LocalView> ViewAt(const FrameConditions& conditions, const Vector2d& at_px, double centre_height_m) {
  const Vertical& vertical = *conditions.vertical;
  const Vector3d ray = vertical.pinhole.Unproject(at_px);
  const double down = -vertical.up_in_camera.dot(ray);
  const double below_m = *conditions.height_above_ground_m - centre_height_m;
  if (!(down > kMinDown * ray.norm()) || !(below_m > 0)) return std::nullopt;
  LocalView view{.off_nadir_rad = std::acos(std::min(1.0, down / ray.norm())),
                 .lean_rad = vertical.LeanAt(at_px),
                 .pixels_per_m = vertical.pinhole.fx * down / below_m};
  if (conditions.relative_sun) {
    const double azimuth_rad = WrapAngle(conditions.relative_sun->azimuth_rad - vertical.AzimuthAt(at_px));
    view.sun_azimuth_deg = Quantised(azimuth_rad, kSunStep_deg);
    view.sun_elevation_deg = Quantised(conditions.relative_sun->elevation_rad, kSunStep_deg / 2);
  }
  return view;
}

TemplateSize ChooseSize(double object_px, double wanted_px, double max_enlargement = kMaxEnlargement) {
  const double size_px = std::min(wanted_px, max_enlargement * object_px);
  TemplateSize size{.eighth_octaves = static_cast<int>(std::ceil(8 * std::log2(kFineSize_px / size_px) - 1e-9))};
  size.scale = kFineSize_px * std::exp2(-size.eighth_octaves / 8.0) / object_px;
  return size;
}

// The middle of a position's pixel.
Vector2d PixelOf(const cv::Point& position) {
  return {kCellSide_px * position.x + 0.5, kCellSide_px * position.y + 0.5};
}

cv::Point PositionAt(const Vector2d& at_px) {
  return {static_cast<int>(std::lround((at_px.x() - 0.5) / kCellSide_px)),
          static_cast<int>(std::lround((at_px.y() - 0.5) / kCellSide_px))};
}

// The positions around those in a tile.
cv::Rect PositionsOf(const UprightPart& part, const FrameTile& tile) {
  std::vector<cv::Point> corners;
  for (const cv::Point& corner : {tile.part.tl(), tile.part.br(), cv::Point(tile.part.x, tile.part.br().y),
                                  cv::Point(tile.part.br().x, tile.part.y)}) {
    corners.push_back(PositionAt(part.FromFrame({corner.x, corner.y})));
  }
  return cv::boundingRect(corners);
}

}  // namespace

std::vector<FrameTile> DivideFrame(const Vertical& vertical, const cv::Size& size) {
  const auto parts = [&](int length_px) {
    return std::max(1, static_cast<int>(std::ceil(std::atan(length_px / vertical.pinhole.fx) / kTileOffNadir_rad)));
  };
  const auto [rows, columns] = std::pair(parts(size.height), parts(size.width));
  std::vector<FrameTile> tiles;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      tiles.push_back({cv::Rect(cv::Point(size.width * column / columns, size.height * row / rows),
                                cv::Point(size.width * (column + 1) / columns, size.height * (row + 1) / rows))});
    }
  }
  return tiles;
}

std::vector<double> AssumedSizes(const cv::Size& size) {
  std::vector<double> sizes_px;
  for (double size_px = kSmallestAssumed_px; size_px <= kLargestAssumed * std::min(size.width, size.height);
       size_px *= std::exp2(2 * kSizeStep))
    sizes_px.push_back(size_px);
  return sizes_px;
}

GradientCells FilmedCells(const UprightPart& part, const cv::Size& frame,
                          const std::array<float, kCellOrientations>& mean) {
  GradientCells cells = MakeGradientCells(part.grey);
  const Box filmed = FrameBox(frame.width, frame.height);
  const auto is_filmed = [&](const Vector2d& at_px) { return filmed.Contains(at_px.x(), at_px.y()); };
  const Vector2d first_px = part.ToFrame({0.5, 0.5});
  const Vector2d across_px = part.ToFrame({0.5 + kCellStep_px, 0.5}) - first_px;
  const Vector2d down_px = part.ToFrame({0.5, 0.5 + kCellStep_px}) - first_px;
  const Vector2d last_right_px = first_px + (cells.columns - 1) * across_px;
  const Vector2d to_last_row_px = (cells.rows - 1) * down_px;
  if (is_filmed(first_px) && is_filmed(last_right_px) && is_filmed(first_px + to_last_row_px) &&
      is_filmed(last_right_px + to_last_row_px)) {
    return cells;
  }
  const std::array<std::uint8_t, kCellOrientations> mean_codes = CodesOf(mean);
  auto code = cells.codes.begin();
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.columns; ++column, code += kCellOrientations) {
      if (!is_filmed(first_px + row * down_px + column * across_px)) std::ranges::copy(mean_codes, code);
    }
  }
  return cells;
}

PreparedPart PreparePart(const FramePyramid& frame, const FrameTile& tile, double object_px, double lean_rad,
                         const std::array<float, kCellOrientations>& mean) {
  // Objects of the tile reach beyond it; turned, so do its corners.
  const double turned = std::abs(std::sin(lean_rad));
  const cv::Size2d wanted(tile.part.width + object_px + turned * tile.part.height,
                          tile.part.height + object_px + turned * tile.part.width);
  PreparedPart made;
  made.part = CutUpright(frame, tile.centre(), wanted, ChooseSize(object_px, kCoarseSize_px).scale, lean_rad);
  if (made.part.grey.empty()) return made;
  made.half = made.part.AtHalfScale();
  made.half_cells = FilmedCells(made.half, frame.frame().size(), mean);
  return made;
}

// Templates of half the coarse size, and of the coarse size. Without the sun they are the same whichever way the camera
// looks.
std::vector<ShapeBankKey> ModelShapeSearch::PlaceKeys(const LocalView& view) const {
  const double object_px = diagonal_m_ * view.pixels_per_m;
  if (object_px < kMinObject_px) return {};
  const ShapeBankKey coarse{
      .model = model_,
      .azimuth_deg = {},
      .off_nadir_deg = std::max(kOffNadirStep_deg / 2, Quantised(view.off_nadir_rad, kCoarseOffNadirStep_deg)),
      .sun_azimuth_deg = {},
      .eighth_octaves = ChooseSize(object_px, kCoarseSize_px).eighth_octaves};
  ShapeBankKey glance = coarse;
  glance.eighth_octaves += kGlanceEighthOctaves;
  return {glance, coarse};
}

Expected<std::vector<Place>> ModelShapeSearch::FindPlaces(const FramePyramid& frame, const FrameConditions& conditions,
                                                          const FrameTile& tile) const {
  const auto view = ViewAt(conditions, tile.centre(), centre_height_m_);
  if (!view) return std::vector<Place>{};
  const std::vector<ShapeBankKey> keys = PlaceKeys(*view);
  if (keys.empty()) return std::vector<Place>{};
  PreparedPart prepared = PreparePart(frame, tile, diagonal_m_ * view->pixels_per_m, view->lean_rad, templates_.mean());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const ShapeBank> small, templates_.Get(keys[0]));
  const std::vector<Glance> glances = FindGlances(prepared, tile, *small, kMaxGlances);
  if (glances.empty()) return std::vector<Place>{};
  prepared.cells = FilmedCells(prepared.part, frame.frame().size(), templates_.mean());
  return LookCloser(prepared, glances, keys[1]);
}

Expected<std::vector<Place>> ModelShapeSearch::FindAssumedPlaces(const PreparedPart& prepared, const FrameTile& tile,
                                                                 const LocalView& view) const {
  const std::vector<ShapeBankKey> keys = PlaceKeys(view);
  if (keys.empty()) return std::vector<Place>{};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const ShapeBank> small, templates_.Get(keys[0]));
  const std::vector<Glance> glances = FindGlances(prepared, tile, *small, kMaxAssumedGlances);
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<Place> places, LookCloser(prepared, glances, keys[1]));
  for (Place& place : places) place.assumed = view;
  return places;
}

Expected<std::optional<ShapeMatch>> ModelShapeSearch::Refine(const FramePyramid& frame,
                                                             const FrameConditions& conditions,
                                                             const Place& place) const {
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<ShapeMatch> best, Match(frame, conditions, place, 0));
  if (!place.assumed) {
    // The headings around the coarse one if that one promises something.
    if (!best || best->response < kMinFineResponse) return std::optional<ShapeMatch>();
    return Match(frame, conditions, place, kFineHeadings);
  }
  if (!best || best->response < kMinAssumedFineResponse) return std::optional<ShapeMatch>();
  Place tried = place;
  const auto take = [&](const Place& there, const ShapeMatch& match) {
    best = match;
    tried = there;
    tried.at_px = match.centre_px;
    tried.azimuth_deg = Quantised(match.to_camera.azimuth_rad, kFineHeadingStep_deg);
  };
  const auto vary = [&](auto change, int headings) -> Status {
    const Place middle = tried;
    for (const double step : {-1.0, 1.0}) {
      Place other = middle;
      change(*other.assumed, step);
      if (!(std::cos(other.assumed->off_nadir_rad) > kMinDown)) continue;
      VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<ShapeMatch> match, Match(frame, conditions, other, headings));
      if (!match || match->response <= best->response) continue;
      take(other, *match);
    }
    return {};
  };
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<ShapeMatch> turned, Match(frame, conditions, tried, kFineHeadings));
  if (turned && turned->response > best->response) take(tried, *turned);
  for (const double part : {1.0, 0.5}) {
    VICTORIOUS_RETURN_IF_ERROR(
        vary([&](LocalView& view, double step) { view.pixels_per_m *= std::exp2(part * step * kSizeStep); }, 0));
    VICTORIOUS_RETURN_IF_ERROR(
        vary([&](LocalView& view, double step) { view.off_nadir_rad += part * step * kOffNadirChange_rad; }, 1));
    VICTORIOUS_RETURN_IF_ERROR(
        vary([&](LocalView& view, double step) { view.lean_rad += part * step * kLeanChange_rad; }, 1));
  }
  return best;
}

Expected<std::optional<ShapeMatch>> ModelShapeSearch::Match(const FramePyramid& frame,
                                                            const FrameConditions& conditions, const Place& place,
                                                            int headings) const {
  const auto view = place.assumed ? place.assumed : ViewAt(conditions, place.at_px, centre_height_m_);
  if (!view) return std::optional<ShapeMatch>();
  return MatchView(frame, *view, place, ChooseSize(diagonal_m_ * view->pixels_per_m, kFineSize_px), headings);
}

// The best match of templates of one size around a place.
Expected<std::optional<ShapeMatch>> ModelShapeSearch::MatchView(const FramePyramid& frame, const LocalView& view,
                                                                const Place& place, const TemplateSize& size,
                                                                int headings) const {
  VICTORIOUS_ASSIGN_OR_RETURN(const ShapeBank bank, FineBank(view, size.eighth_octaves, place.azimuth_deg, headings));
  if (bank.templates.empty()) return std::optional<ShapeMatch>();
  const double side_px = (kCellSide_px * bank.window + 2 * kFineReach_px) / size.scale;
  const UprightPart part = CutUpright(frame, place.at_px, {side_px, side_px}, size.scale, view.lean_rad);
  if (part.grey.empty()) return std::optional<ShapeMatch>();
  const GradientCells cells = MakeGradientCells(part.grey);
  const cv::Size map(cells.columns / kCellStride, cells.rows / kCellStride);
  const cv::Rect inside(bank.window / 2, bank.window / 2, map.width - bank.window + 1, map.height - bank.window + 1);
  // The responses of all four phases, every second pixel.
  cv::Mat responses(2 * inside.height, 2 * inside.width, CV_32F);
  cv::Mat which(responses.size(), CV_32S);
  for (const cv::Point phase : {cv::Point(0, 0), cv::Point(1, 0), cv::Point(0, 1), cv::Point(1, 1)}) {
    const ResponseMap of_phase = Respond(cells, phase, bank, inside, templates_.mean());
    for (int row = 0; row < inside.height; ++row) {
      for (int column = 0; column < inside.width; ++column) {
        responses.at<float>(2 * row + phase.y, 2 * column + phase.x) = of_phase.response.at<float>(row, column);
        which.at<int>(2 * row + phase.y, 2 * column + phase.x) = of_phase.which.at<int>(row, column);
      }
    }
  }
  double highest = 0;
  cv::Point at;
  cv::minMaxLoc(responses, nullptr, &highest, nullptr, &at);
  const ShapeTemplate& found = bank.templates[static_cast<std::size_t>(which.at<int>(at))];
  const Vector2d corner(kCellStep_px * at.x + 0.5, kCellStep_px * at.y + 0.5);
  const Vector2d to_middle = Vector2d::Constant(kCellSide_px * (bank.window / 2));
  std::optional<ShapeMatch> best =
      ShapeMatch{.model_index = model_,
                 .to_camera = {RadiansFromDegrees(found.azimuth_deg), view.off_nadir_rad},
                 .centre_px = part.ToFrame(corner + to_middle + kCellStep_px * PeakOffset(responses, at)),
                 .pixels_per_m = view.pixels_per_m,
                 .lean_rad = view.lean_rad,
                 .paint = found.paint,
                 .response = highest};
  return best;
}

Expected<std::optional<ShapeMatch>> ModelShapeSearch::Examine(const FramePyramid& frame,
                                                              const FrameConditions& conditions,
                                                              const ShapeMatch& match, double min_neg_log10_nfa) const {
  const auto view = ViewAt(conditions, match.centre_px, centre_height_m_);
  if (!view) return std::optional<ShapeMatch>();
  ShapeMatch examined = match;
  examined.to_camera.off_nadir_rad = view->off_nadir_rad;
  examined.pixels_per_m = view->pixels_per_m;
  examined.lean_rad = view->lean_rad;
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<FittedContours> fitted,
                              FitContours(frame, *view, conditions.vertical->pinhole.fx, examined));
  if (!fitted) return std::optional<ShapeMatch>();
  fitted->evidence.response = kMaxMeanGrowth * match.response;
  if (NegLog10NfaOf(fitted->evidence) >= min_neg_log10_nfa) {
    VICTORIOUS_ASSIGN_OR_RETURN(fitted->evidence.response, MeanResponse(frame, *view, examined));
  }
  examined.centre_px = fitted->centre_px;
  examined.pixels_per_m *= std::exp(-fitted->evidence.distance_change);
  examined.to_camera.azimuth_rad = WrapAngle(match.to_camera.azimuth_rad + fitted->azimuth_change_rad);
  examined.neg_log10_nfa = NegLog10NfaOf(fitted->evidence);
  examined.in_frame = fitted->in_frame;
  examined.is_examined = true;
  return std::optional(examined);
}

// The mean response of templates of the fine size and of larger ones of the same heading. Those of a small object have
// all one size.
Expected<double> ModelShapeSearch::MeanResponse(const FramePyramid& frame, const LocalView& view,
                                                const ShapeMatch& match) const {
  const Place place{.model = model_,
                    .at_px = match.centre_px,
                    .azimuth_deg = Quantised(match.to_camera.azimuth_rad, kFineHeadingStep_deg),
                    .assumed = {}};
  double sum = match.response;
  int count = 1;
  std::optional<TemplateSize> last;
  for (const double size_px : kFinerSizes_px) {
    const TemplateSize size = ChooseSize(diagonal_m_ * view.pixels_per_m, size_px, kMaxFinerEnlargement);
    if (size == last) continue;
    last = size;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<ShapeMatch> finer, MatchView(frame, view, place, size, 0));
    if (!finer) continue;
    sum += finer->response;
    ++count;
  }
  return sum / count;
}

// The pose of a match refined on the edges of the frame, as if it lay on the optical axis. std::nullopt where there are
// no contours, or the object is too small for them.
Expected<std::optional<ModelShapeSearch::FittedContours>> ModelShapeSearch::FitContours(const FramePyramid& frame,
                                                                                        const LocalView& view,
                                                                                        double focal_px,
                                                                                        const ShapeMatch& match) const {
  const double object_px = diagonal_m_ * view.pixels_per_m;
  const double scale = ChooseSize(object_px, kFinerSizes_px.back(), kMaxFinerEnlargement).scale;
  const double side_px = kContourSurroundings * object_px;
  const UprightPart part = CutUpright(frame, match.centre_px, {side_px, side_px}, scale, view.lean_rad);
  if (part.grey.empty()) return std::optional<FittedContours>();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const ContourModel> contours,
                              templates_.GetContours(model_, match.to_camera));
  const ContourImage image(part.grey, kMinEdgeGradient / std::max(1.0, scale));
  const ContourPose start{CameraFromModel(match.to_camera).toRotationMatrix(),
                          Vector3d(0, 0, focal_px / view.pixels_per_m), scale * focal_px};
  const ContourPose refined = RefineContourPose(*contours, image, start, {.free_focal = false});
  // Beyond its border the last pixels of the frame are repeated, and with them every line that leaves it.
  const Box filmed = FrameBox(frame.frame().cols, frame.frame().rows);
  const auto is_seen = [&](const Vector2d& at_px) {
    const Vector2d in_frame = part.ToFrame(at_px);
    return filmed.Contains(in_frame.x(), in_frame.y());
  };
  const ContourEvidence edges = EvidenceOf(*contours, image, refined, is_seen);
  if (edges.decades == 0) return std::optional<FittedContours>();
  const Vector3d& centre = refined.centre_in_camera_m;
  const Eigen::AngleAxisd turn(refined.camera_from_model * start.camera_from_model.transpose());
  return FittedContours{.evidence = {.contour_mean = edges.mean,
                                     .distance_change = std::log(centre.z() / start.centre_in_camera_m.z()),
                                     .step = edges.step,
                                     .turn_rad = turn.angle()},
                        .in_frame = edges.seen,
                        .centre_px = part.ToFrame(image.centre_px() + refined.focal_px * centre.head<2>() / centre.z()),
                        .azimuth_change_rad = turn.angle() * turn.axis().dot(start.camera_from_model.col(2))};
}

// The best places of templates of half the coarse size, as many as `most`.
std::vector<ModelShapeSearch::Glance> ModelShapeSearch::FindGlances(const PreparedPart& prepared, const FrameTile& tile,
                                                                    const ShapeBank& bank, std::size_t most) const {
  const UprightPart& part = prepared.half;
  if (part.grey.empty() || bank.templates.empty()) return {};
  const cv::Rect positions = PositionsOf(part, tile);
  const ResponseMap map = Respond(prepared.half_cells, {0, 0}, bank, positions, templates_.mean());
  std::vector<Glance> found;
  if (map.response.empty()) return found;
  cv::Mat highest;
  cv::dilate(map.response, highest, cv::Mat::ones(3, 3, CV_8U));
  for (int row = 0; row < positions.height; ++row) {
    for (int column = 0; column < positions.width; ++column) {
      const float response = map.response.at<float>(row, column);
      if (response < kMinGlanceResponse || response < highest.at<float>(row, column)) continue;
      const Vector2d at_px = part.ToFrame(PixelOf(positions.tl() + cv::Point(column, row)));
      if (!tile.part.contains(
              cv::Point(static_cast<int>(std::floor(at_px.x())), static_cast<int>(std::floor(at_px.y()))))) {
        continue;
      }
      found.push_back({.response = response,
                       .at_px = at_px,
                       .heading_number = static_cast<std::size_t>(map.which.at<int>(row, column))});
    }
  }
  std::ranges::stable_sort(found, std::greater{}, &Glance::response);
  if (found.size() > most) found.resize(most);
  return found;
}

// The largest response of coarse templates around each glance, of the headings about its own and the opposite one.
Expected<std::vector<Place>> ModelShapeSearch::LookCloser(const PreparedPart& prepared,
                                                          const std::vector<Glance>& glances,
                                                          const ShapeBankKey& key) const {
  std::vector<Place> places;
  if (glances.empty()) return places;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const ShapeBank> bank, templates_.Get(key));
  const std::size_t count = bank->templates.size();
  const UprightPart& part = prepared.part;
  for (const Glance& glance : glances) {
    ShapeBank near{.window = bank->window, .templates = {}, .weights = {}};
    for (const std::size_t middle : {glance.heading_number, glance.heading_number + count / 2}) {
      for (std::size_t i = 0; i <= 2 * kGlanceHeadings && count > 0; ++i) {
        const std::size_t number = (middle + count - kGlanceHeadings + i) % count;
        near.Add(bank->templates[number], bank->WeightsOf(number));
      }
    }
    const cv::Point middle = PositionAt(part.FromFrame(glance.at_px));
    const cv::Rect positions(middle - cv::Point(kGlanceReach, kGlanceReach),
                             cv::Size(2 * kGlanceReach + 1, 2 * kGlanceReach + 1));
    const ResponseMap map = Respond(prepared.cells, {0, 0}, near, positions, templates_.mean());
    double highest = 0;
    cv::Point at;
    cv::minMaxLoc(map.response, nullptr, &highest, nullptr, &at);
    if (highest < kMinCoarseResponse) continue;
    places.push_back({.model = model_,
                      .response = highest,
                      .at_px = part.ToFrame(PixelOf(positions.tl() + at)),
                      .size_px = kCoarseSize_px / part.scale,
                      .azimuth_deg = near.templates[static_cast<std::size_t>(map.which.at<int>(at))].azimuth_deg,
                      .assumed = {}});
  }
  return places;
}

// The templates of headings around one, 5 degrees apart.
Expected<ShapeBank> ModelShapeSearch::FineBank(const LocalView& view, int eighth_octaves, int azimuth_deg,
                                               int headings) const {
  ShapeBankKey key{.model = model_,
                   .azimuth_deg = {},
                   .off_nadir_deg = std::max(kOffNadirStep_deg / 2, Quantised(view.off_nadir_rad, kOffNadirStep_deg)),
                   .sun_azimuth_deg = view.sun_azimuth_deg,
                   .sun_elevation_deg = view.sun_elevation_deg,
                   .eighth_octaves = eighth_octaves};
  ShapeBank bank{.window = key.window(), .templates = {}, .weights = {}};
  for (int i = -headings; i <= headings; ++i) {
    key.azimuth_deg = (azimuth_deg + i * kFineHeadingStep_deg + 360) % 360;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const ShapeBank> one, templates_.Get(key));
    for (std::size_t t = 0; t < one->templates.size(); ++t) bank.Add(one->templates[t], one->WeightsOf(t));
  }
  return bank;
}

}  // namespace victorious
