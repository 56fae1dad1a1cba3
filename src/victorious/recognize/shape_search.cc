#include "victorious/recognize/shape_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"
#include "victorious/base/stage_time.h"
#include "victorious/detect/detect.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/homography.h"
#include "victorious/geometry/similarity.h"
#include "victorious/kernels/window_products.h"
#include "victorious/recognize/shape_templates.h"
#include "victorious/recognize/upright_part.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMaxEnlargement = 2;  // of the frame: more shows no more
constexpr double kMinObject_px = 24;   // diagonal of the bounding box in the frame
constexpr double kMinDown = 0.25;      // cosine of the off-nadir angle: views end at 70 degrees
constexpr double kTileOffNadir_rad = RadiansFromDegrees(6);
constexpr int kFineHeadingStep_deg = 5;
constexpr int kOffNadirStep_deg = 5;
constexpr int kCoarseOffNadirStep_deg = 10;
constexpr int kCellStride = kCellSide_px / kCellStep_px;
constexpr int kSunStep_deg = 30;
constexpr int kGlanceEighthOctaves = 8;  // half of the coarse size
constexpr double kMinGlanceResponse = 3;
constexpr std::size_t kMaxGlances = 40;     // of a model in a tile
constexpr std::size_t kGlanceHeadings = 2;  // on either side of that of a glance, and of the opposite one
constexpr int kGlanceReach = 2;             // cells
constexpr std::size_t kMaxPlaces = 4;       // of a model in a frame that are searched with fine templates
constexpr double kMinCoarseResponse = 5.2;
constexpr double kMinFineResponse = 5.5;  // of the coarse heading
constexpr int kFineHeadings = 2;          // on either side of it
constexpr double kSuppression = 0.4;      // distance of two matches over the smaller one's size
constexpr double kFineReach_px = 8;       // of a fine template around the coarse place

// How an upright object looks in one place of the frame.
struct LocalView {
  double off_nadir_rad = 0;
  double lean_rad = 0;
  double pixels_per_m = 1;                  // of an object whose centre is `centre_height_m` above the ground
  std::optional<int> sun_azimuth_deg = {};  // relative to the line of sight
  int sun_elevation_deg = 0;
};

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

// A part of the frame in which objects look alike but for their heading.
struct Tile {
  cv::Rect part;
  Vector2d centre() const { return {part.x + 0.5 * part.width, part.y + 0.5 * part.height}; }
};

std::vector<Tile> DivideFrame(const Vertical& vertical, const cv::Size& size) {
  const auto parts = [&](int length_px) {
    return std::max(1, static_cast<int>(std::ceil(std::atan(length_px / vertical.pinhole.fx) / kTileOffNadir_rad)));
  };
  const auto [rows, columns] = std::pair(parts(size.height), parts(size.width));
  std::vector<Tile> tiles;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      tiles.push_back({cv::Rect(cv::Point(size.width * column / columns, size.height * row / rows),
                                cv::Point(size.width * (column + 1) / columns, size.height * (row + 1) / rows))});
    }
  }
  return tiles;
}

// Every second cell of a part: what templates are compared with.
struct CodeMap {
  std::vector<std::int16_t> codes;
  int rows = 0;
  int columns = 0;
};

// @param phase  which of the four first cells is the first
// @param area   in every second cell; beyond the part is mean background
CodeMap TakeCells(const GradientCells& cells, const cv::Point& phase, const cv::Rect& area,
                  const std::array<float, kCellOrientations>& mean) {
  CodeMap map{.codes = {}, .rows = area.height, .columns = area.width};
  map.codes.resize(static_cast<std::size_t>(map.rows) * map.columns * kCellOrientations);
  std::array<std::int16_t, kCellOrientations> outside{};
  for (std::size_t k = 0; k < outside.size(); ++k) {
    outside[k] = static_cast<std::int16_t>(std::lround(mean[k] * (kMaxCellCode / kMaxCellValue)));
  }
  std::int16_t* out = map.codes.data();
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const int y = phase.y + kCellStride * (area.y + row);
      const int x = phase.x + kCellStride * (area.x + column);
      if (y < 0 || x < 0 || y >= cells.rows || x >= cells.columns) {
        std::ranges::copy(outside, out);
      } else {
        std::copy_n(cells.at(y, x), kCellOrientations, out);
      }
      out += kCellOrientations;
    }
  }
  return map;
}

// The largest response at each position, and the template that gives it.
struct ResponseMap {
  cv::Mat response;  // CV_32F
  cv::Mat which;     // CV_32S, index into the bank
};

// @param positions_at  of the templates' middles, in every second cell
ResponseMap Respond(const GradientCells& cells, const cv::Point& phase, const ShapeBank& bank,
                    const cv::Rect& positions_at, const std::array<float, kCellOrientations>& mean) {
  if (positions_at.empty()) return {};
  const cv::Point to_corner(bank.window / 2, bank.window / 2);
  const cv::Size reach(bank.window - 1, bank.window - 1);
  const CodeMap map = TakeCells(cells, phase, {positions_at.tl() - to_corner, positions_at.size() + reach}, mean);
  const auto window = static_cast<std::size_t>(bank.window);
  const std::size_t rows = map.rows - window + 1;
  const std::size_t columns = map.columns - window + 1;
  std::vector<std::int32_t> sums(bank.templates.size() * rows * columns);
  kernels::WindowProducts(
      {.values = map.codes.data(),
       .rows = static_cast<std::size_t>(map.rows),
       .cols = static_cast<std::size_t>(map.columns),
       .depth = kCellOrientations},
      {.values = bank.weights.data(), .templates = bank.templates.size(), .height = window, .width = window}, sums);
  ResponseMap made{.response = cv::Mat(static_cast<int>(rows), static_cast<int>(columns), CV_32F, cv::Scalar(-1e9)),
                   .which = cv::Mat::zeros(static_cast<int>(rows), static_cast<int>(columns), CV_32S)};
  const std::size_t positions = rows * columns;
  auto* const response = made.response.ptr<float>();
  auto* const which = made.which.ptr<int>();
  for (std::size_t t = 0; t < bank.templates.size(); ++t) {
    const float scale = bank.templates[t].scale;
    const float offset = bank.templates[t].offset;
    for (std::size_t i = 0; i < positions; ++i) {
      const float here = scale * static_cast<float>(sums[t * positions + i]) - offset;
      if (here <= response[i]) continue;
      response[i] = here;
      which[i] = static_cast<int>(t);
    }
  }
  return made;
}

// Where the maximum of the parabolas through a peak and its neighbours lies, beside the peak: at most half a step.
Vector2d PeakOffset(const cv::Mat& responses, const cv::Point& peak) {
  const auto along = [&](const cv::Point& step) {
    const cv::Rect inside({0, 0}, responses.size());
    if (!inside.contains(peak - step) || !inside.contains(peak + step)) return 0.0;
    const double before = responses.at<float>(peak - step);
    const double here = responses.at<float>(peak);
    const double after = responses.at<float>(peak + step);
    const double bend = before - 2 * here + after;
    return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
  };
  return {along({1, 0}), along({0, 1})};
}

struct Place {
  std::size_t model = 0;
  double response = 0;
  Vector2d at_px;       // of the object's centre, in the frame
  double size_px = 0;   // of the object in the frame
  int azimuth_deg = 0;  // of the camera, in the model frame
};

// The size of a model's templates in a place, and the scale at which the frame is compared with them.
struct TemplateSize {
  int eighth_octaves = 0;
  double scale = 1;  // pixels of the template per pixel of the frame
};

TemplateSize ChooseSize(double object_px, double wanted_px) {
  const double size_px = std::min(wanted_px, kMaxEnlargement * object_px);
  TemplateSize size{.eighth_octaves = static_cast<int>(std::ceil(8 * std::log2(kFineSize_px / size_px) - 1e-9))};
  size.scale = kFineSize_px * std::exp2(-size.eighth_octaves / 8.0) / object_px;
  return size;
}

}  // namespace

std::vector<GradientCells> BackgroundCells(const cv::Mat& grey) {
  std::vector<GradientCells> cells;
  for (const double scale : {0.35, 0.5, 0.7, 1.0}) {
    cv::Mat scaled;
    cv::resize(grey, scaled, {}, scale, scale, cv::INTER_AREA);
    cells.push_back(MakeGradientCells(scaled));
  }
  return cells;
}

ShapeSearch::ShapeSearch(std::span<const ObjectModel> models,
                         std::span<const std::shared_ptr<const RelitTemplateSource>> surfaces,
                         std::span<const GradientCells> background)
    : models_(models), templates_(std::make_unique<Templates>(models, surfaces, background)) {}

ShapeSearch::~ShapeSearch() = default;

namespace {

// The search for one model.
class ModelShapeSearch {
 public:
  using GetBank = std::function<Expected<std::shared_ptr<const ShapeBank>>(const ShapeBankKey&)>;

  ModelShapeSearch(std::size_t model, double diagonal_m, double centre_height_m, const GetBank& get_bank,
                   const std::array<float, kCellOrientations>& mean)
      : model_(model), diagonal_m_(diagonal_m), centre_height_m_(centre_height_m), get_bank_(get_bank), mean_(mean) {}

  // What FindPlaces needs in a tile: templates of half the coarse size, and of the coarse size. Empty if the model
  // cannot be seen there.
  [[nodiscard]] std::vector<ShapeBankKey> PlaceKeys(const FrameConditions& conditions, const Tile& tile) const {
    const auto view = ViewAt(conditions, tile.centre(), centre_height_m_);
    if (!view) return {};
    const double object_px = diagonal_m_ * view->pixels_per_m;
    if (object_px < kMinObject_px) return {};
    // Without the sun, the templates are the same whichever way the camera looks.
    const ShapeBankKey coarse{
        .model = model_,
        .azimuth_deg = {},
        .off_nadir_deg = std::max(kOffNadirStep_deg / 2, Quantised(view->off_nadir_rad, kCoarseOffNadirStep_deg)),
        .sun_azimuth_deg = {},
        .eighth_octaves = ChooseSize(object_px, kCoarseSize_px).eighth_octaves};
    ShapeBankKey glance = coarse;
    glance.eighth_octaves += kGlanceEighthOctaves;
    return {glance, coarse};
  }

  // The best places of coarse templates in a tile.
  Expected<std::vector<Place>> FindPlaces(const cv::Mat& grey, const FrameConditions& conditions,
                                          const Tile& tile) const {
    const std::vector<ShapeBankKey> keys = PlaceKeys(conditions, tile);
    if (keys.empty()) return std::vector<Place>{};
    const LocalView view = *ViewAt(conditions, tile.centre(), centre_height_m_);
    const double object_px = diagonal_m_ * view.pixels_per_m;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const ShapeBank> glances, get_bank_(keys[0]));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const ShapeBank> bank, get_bank_(keys[1]));
    if (glances->templates.empty() || bank->templates.empty()) return std::vector<Place>{};
    // Objects of the tile reach beyond it; turned, so do its corners.
    const double turned = std::abs(std::sin(view.lean_rad));
    const cv::Size2d wanted(tile.part.width + object_px + turned * tile.part.height,
                            tile.part.height + object_px + turned * tile.part.width);
    const UprightPart part =
        CutUpright(grey, tile.centre(), wanted, ChooseSize(object_px, kCoarseSize_px).scale, view.lean_rad);
    if (part.grey.empty()) return std::vector<Place>{};
    const std::vector<Glance> best = FindGlances(part.AtHalfScale(), tile, *glances);
    if (best.empty()) return std::vector<Place>{};
    const GradientCells cells = MakeGradientCells(part.grey);
    std::vector<Place> places;
    for (const Glance& glance : best) {
      if (const std::optional<Place> place = LookCloser(part, cells, glance, *bank)) places.push_back(*place);
    }
    return places;
  }

  // The best match of fine templates around a place, of the headings around the coarse one if that one promises
  // something.
  Expected<std::optional<ShapeMatch>> Refine(const cv::Mat& grey, const FrameConditions& conditions,
                                             const Place& place) const {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<ShapeMatch> first, Match(grey, conditions, place, 0));
    if (!first || first->response < kMinFineResponse) return std::optional<ShapeMatch>();
    return Match(grey, conditions, place, kFineHeadings);
  }

  // @param headings  on either side of that of the place, 5 degrees apart
  Expected<std::optional<ShapeMatch>> Match(const cv::Mat& grey, const FrameConditions& conditions, const Place& place,
                                            int headings) const {
    const auto view = ViewAt(conditions, place.at_px, centre_height_m_);
    if (!view) return std::optional<ShapeMatch>();
    const double object_px = diagonal_m_ * view->pixels_per_m;
    const TemplateSize size = ChooseSize(object_px, kFineSize_px);
    VICTORIOUS_ASSIGN_OR_RETURN(const ShapeBank bank, FineBank(*view, size, place.azimuth_deg, headings));
    if (bank.templates.empty()) return std::optional<ShapeMatch>();
    const double side_px = (kCellSide_px * bank.window + 2 * kFineReach_px) / size.scale;
    const UprightPart part = CutUpright(grey, place.at_px, {side_px, side_px}, size.scale, view->lean_rad);
    if (part.grey.empty()) return std::optional<ShapeMatch>();
    const GradientCells cells = MakeGradientCells(part.grey);
    const cv::Size map(cells.columns / kCellStride, cells.rows / kCellStride);
    const cv::Rect inside(bank.window / 2, bank.window / 2, map.width - bank.window + 1, map.height - bank.window + 1);
    // The responses of all four phases, every second pixel.
    cv::Mat responses(2 * inside.height, 2 * inside.width, CV_32F);
    cv::Mat which(responses.size(), CV_32S);
    for (const cv::Point phase : {cv::Point(0, 0), cv::Point(1, 0), cv::Point(0, 1), cv::Point(1, 1)}) {
      const ResponseMap of_phase = Respond(cells, phase, bank, inside, mean_);
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
                   .to_camera = {RadiansFromDegrees(found.azimuth_deg), view->off_nadir_rad},
                   .centre_px = part.ToFrame(corner + to_middle + kCellStep_px * PeakOffset(responses, at)),
                   .pixels_per_m = view->pixels_per_m,
                   .lean_rad = view->lean_rad,
                   .paint = found.paint,
                   .response = highest};
    return best;
  }

 private:
  // A place that may be worth a closer look.
  struct Glance {
    double response = 0;
    Vector2d at_px;                  // in the frame
    std::size_t heading_number = 0;  // of the best template
  };

  // The best places of templates of half the coarse size, as many as kMaxGlances.
  std::vector<Glance> FindGlances(const UprightPart& part, const Tile& tile, const ShapeBank& bank) const {
    const GradientCells cells = MakeGradientCells(part.grey);
    const cv::Rect positions = PositionsOf(part, tile);
    const ResponseMap map = Respond(cells, {0, 0}, bank, positions, mean_);
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
    if (found.size() > kMaxGlances) found.resize(kMaxGlances);
    return found;
  }

  // The largest response of coarse templates around a glance, of the headings about its own and the opposite one.
  std::optional<Place> LookCloser(const UprightPart& part, const GradientCells& cells, const Glance& glance,
                                  const ShapeBank& bank) const {
    ShapeBank near{.window = bank.window, .templates = {}, .weights = {}};
    const std::size_t count = bank.templates.size();
    for (const std::size_t middle : {glance.heading_number, glance.heading_number + count / 2}) {
      for (std::size_t i = 0; i <= 2 * kGlanceHeadings; ++i) {
        const std::size_t number = (middle + count - kGlanceHeadings + i) % count;
        near.Add(bank.templates[number], bank.WeightsOf(number));
      }
    }
    const cv::Point middle = PositionAt(part.FromFrame(glance.at_px));
    const cv::Rect positions(middle - cv::Point(kGlanceReach, kGlanceReach),
                             cv::Size(2 * kGlanceReach + 1, 2 * kGlanceReach + 1));
    const ResponseMap map = Respond(cells, {0, 0}, near, positions, mean_);
    double highest = 0;
    cv::Point at;
    cv::minMaxLoc(map.response, nullptr, &highest, nullptr, &at);
    if (highest < kMinCoarseResponse) return std::nullopt;
    return Place{.model = model_,
                 .response = highest,
                 .at_px = part.ToFrame(PixelOf(positions.tl() + at)),
                 .size_px = kCoarseSize_px / part.scale,
                 .azimuth_deg = near.templates[static_cast<std::size_t>(map.which.at<int>(at))].azimuth_deg};
  }

  // The middle of a position's pixel.
  static Vector2d PixelOf(const cv::Point& position) {
    return {kCellSide_px * position.x + 0.5, kCellSide_px * position.y + 0.5};
  }
  static cv::Point PositionAt(const Vector2d& at_px) {
    return {static_cast<int>(std::lround((at_px.x() - 0.5) / kCellSide_px)),
            static_cast<int>(std::lround((at_px.y() - 0.5) / kCellSide_px))};
  }

  // The positions around those in a tile.
  static cv::Rect PositionsOf(const UprightPart& part, const Tile& tile) {
    std::vector<cv::Point> corners;
    for (const cv::Point& corner : {tile.part.tl(), tile.part.br(), cv::Point(tile.part.x, tile.part.br().y),
                                    cv::Point(tile.part.br().x, tile.part.y)}) {
      corners.push_back(PositionAt(part.FromFrame({corner.x, corner.y})));
    }
    return cv::boundingRect(corners);
  }

  // The templates of headings around one, 5 degrees apart.
  Expected<ShapeBank> FineBank(const LocalView& view, const TemplateSize& size, int azimuth_deg, int headings) const {
    ShapeBankKey key{.model = model_,
                     .azimuth_deg = {},
                     .off_nadir_deg = std::max(kOffNadirStep_deg / 2, Quantised(view.off_nadir_rad, kOffNadirStep_deg)),
                     .sun_azimuth_deg = view.sun_azimuth_deg,
                     .sun_elevation_deg = view.sun_elevation_deg,
                     .eighth_octaves = size.eighth_octaves};
    ShapeBank bank{.window = key.window(), .templates = {}, .weights = {}};
    for (int i = -headings; i <= headings; ++i) {
      key.azimuth_deg = (azimuth_deg + i * kFineHeadingStep_deg + 360) % 360;
      VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const ShapeBank> one, get_bank_(key));
      for (std::size_t t = 0; t < one->templates.size(); ++t) bank.Add(one->templates[t], one->WeightsOf(t));
    }
    return bank;
  }

  std::size_t model_;
  double diagonal_m_;
  double centre_height_m_;
  const GetBank& get_bank_;
  const std::array<float, kCellOrientations>& mean_;
};

// The best places of each model over all tiles. Error: the first one.
Expected<std::vector<Place>> BestOfEachModel(std::vector<Expected<std::vector<Place>>>& found, std::size_t tiles) {
  std::vector<Place> best;
  for (std::size_t first = 0; first < found.size(); first += tiles) {
    std::vector<Place> of_model;
    for (std::size_t i = first; i < first + tiles; ++i) {
      if (!found[i]) return std::unexpected(std::move(found[i]).error());
      of_model.insert(of_model.end(), found[i]->begin(), found[i]->end());
    }
    std::ranges::stable_sort(of_model, std::greater{}, &Place::response);
    std::vector<Place> apart;
    for (const Place& place : of_model) {
      if (apart.size() == kMaxPlaces) break;
      const auto is_near = [&](const Place& other) {
        return (other.at_px - place.at_px).norm() < kSuppression / 2 * place.size_px;
      };
      if (std::ranges::none_of(apart, is_near)) apart.push_back(place);
    }
    best.insert(best.end(), apart.begin(), apart.end());
  }
  return best;
}

void ParallelFor(std::size_t count, const std::function<void(std::size_t)>& work) {
  oneapi::tbb::this_task_arena::isolate([&] {  // else a waiting thread could start on another frame
    oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      const StageScope scope(Stage::kShape);
      work(i);
    });
  });
}

double NegLog10Nfa(const ShapeMatch& match) {
  const double of_paint =
      match.paint == TemplatePaint::kPlain ? kResponseOfOneFalseAlarmPlain : kResponseOfOneFalseAlarm;
  return kDecadesPerResponse * (match.response - of_paint);
}

}  // namespace

Expected<std::vector<ShapeMatch>> ShapeSearch::Find(const cv::Mat& grey, const FrameConditions& conditions,
                                                    double min_neg_log10_nfa) const {
  VICTORIOUS_CHECK(grey.type() == CV_8UC1);
  if (!conditions.vertical || !conditions.height_above_ground_m) return std::vector<ShapeMatch>{};
  const std::vector<Tile> tiles = DivideFrame(*conditions.vertical, grey.size());
  const ModelShapeSearch::GetBank get_bank = [this](const ShapeBankKey& key) { return templates_->Get(key); };
  const auto search_for = [&](std::size_t m) {
    return ModelShapeSearch(m, templates_->diagonal_m(m), models_[m].box_m->sizes().z() / 2, get_bank,
                            templates_->mean());
  };
  std::vector<Expected<std::vector<Place>>> found(models_.size() * tiles.size());
  ParallelFor(found.size(), [&](std::size_t i) {
    const std::size_t m = i / tiles.size();
    if (templates_->surfaces(m) != nullptr)
      found[i] = search_for(m).FindPlaces(grey, conditions, tiles[i % tiles.size()]);
  });
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Place> places, BestOfEachModel(found, tiles.size()));
  std::vector<Expected<std::optional<ShapeMatch>>> refined(places.size());
  ParallelFor(places.size(),
              [&](std::size_t i) { refined[i] = search_for(places[i].model).Refine(grey, conditions, places[i]); });
  std::vector<ShapeMatch> all;
  for (Expected<std::optional<ShapeMatch>>& one : refined) {
    if (!one) return std::unexpected(std::move(one).error());
    if (*one) all.push_back(**one);
  }
  std::ranges::stable_sort(all, std::greater{}, &ShapeMatch::response);
  std::vector<ShapeMatch> kept;
  for (ShapeMatch& match : all) {
    const double size_px = templates_->diagonal_m(match.model_index) * match.pixels_per_m;
    const bool is_explained = std::ranges::any_of(kept, [&](const ShapeMatch& better) {
      const double other_px = templates_->diagonal_m(better.model_index) * better.pixels_per_m;
      return (better.centre_px - match.centre_px).norm() < kSuppression * std::min(size_px, other_px);
    });
    if (is_explained) continue;
    match.neg_log10_nfa = NegLog10Nfa(match);
    kept.push_back(match);
  }
  std::erase_if(kept, [&](const ShapeMatch& match) { return match.neg_log10_nfa < min_neg_log10_nfa; });
  return kept;
}

Expected<std::optional<ShapeMatch>> ShapeSearch::FindAgain(const cv::Mat& grey, const FrameConditions& conditions,
                                                           const Detection& last, const Vector2d& shift_px,
                                                           double min_neg_log10_nfa) const {
  const std::size_t m = last.model_index;
  if (!conditions.vertical || !conditions.height_above_ground_m || templates_->surfaces(m) == nullptr) {
    return std::optional<ShapeMatch>();
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const RenderedSurface rendered, templates_->surfaces(m)->GetSurface(last.view));
  const double azimuth_rad = models_[m].views[last.view].angles->azimuth_rad;
  const Place place{.model = m,
                    .at_px = last.fit.scene_from_template.Apply(rendered.centre_px) + shift_px,
                    .azimuth_deg = Quantised(azimuth_rad, kFineHeadingStep_deg)};
  const ModelShapeSearch::GetBank get_bank = [this](const ShapeBankKey& key) { return templates_->Get(key); };
  const ModelShapeSearch search(m, templates_->diagonal_m(m), models_[m].box_m->sizes().z() / 2, get_bank,
                                templates_->mean());
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<ShapeMatch> match, search.Match(grey, conditions, place, kFineHeadings));
  if (!match) return match;
  match->neg_log10_nfa = NegLog10Nfa(*match) + kDecadesOfOnePlace;
  if (match->neg_log10_nfa < min_neg_log10_nfa) match.reset();
  return match;
}

Expected<Detection> ShapeSearch::MakeDetection(const ShapeMatch& match, FeatureSet& features) const {
  const ObjectModel& model = models_[match.model_index];
  const std::size_t view = templates_->NearestView(match.model_index, match.to_camera);
  VICTORIOUS_ASSIGN_OR_RETURN(const RenderedSurface rendered,
                              templates_->surfaces(match.model_index)->GetSurface(view));
  const Eigen::Matrix3d camera_from_model = CameraFromModel(match.to_camera).toRotationMatrix();
  const Eigen::Matrix3d camera_from_view =
      camera_from_model * CameraFromModel(*model.views[view].angles).toRotationMatrix().transpose();
  Similarity2 scene_from_view{
      .scale = match.pixels_per_m / rendered.pixels_per_m,
      .rotation_rad = WrapAngle(match.lean_rad + std::atan2(camera_from_view(1, 0), camera_from_view(0, 0)))};
  scene_from_view.translation = match.centre_px - scene_from_view.Linear() * rendered.centre_px;

  Detection detection{.model_index = match.model_index, .view = view, .cue = DetectionCue::kShape};
  detection.neg_log10_nfa = match.neg_log10_nfa;
  PlanarFit& fit = detection.fit;
  fit.scene_from_template = scene_from_view;
  fit.scene_from_template_plane = scene_from_view.Matrix();
  fit.extent = 1;
  fit.neg_log10_nfa = match.neg_log10_nfa;
  fit.sigma_px = 1;
  const Similarity2 turned{.scale = match.pixels_per_m, .rotation_rad = match.lean_rad};
  const FeatureView keypoints = model.ViewFeatures(view);
  const std::span<const Point3> points = model.ViewPoints(view);
  const Box frame = FrameBox(features.image_width, features.image_height);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d from_centre =
        Eigen::Vector3d(points[i].x, points[i].y, points[i].z) - rendered.centre_in_model_m;
    const Eigen::Vector3d in_camera = camera_from_model * from_centre;
    const Vector2d at_px = match.centre_px + turned.Apply(in_camera.head<2>());
    if (at_px.x() < frame.x || at_px.y() < frame.y || at_px.x() >= frame.x + frame.width ||
        at_px.y() >= frame.y + frame.height) {
      continue;
    }
    Keypoint keypoint = keypoints.keypoints[i];
    fit.inliers.push_back({.scene_keypoint = static_cast<std::uint32_t>(features.size()),
                           .keypoint_in_template = keypoint,
                           .point_in_model = points[i]});
    keypoint.x = static_cast<float>(at_px.x());
    keypoint.y = static_cast<float>(at_px.y());
    keypoint.scale_px *= static_cast<float>(scene_from_view.scale);
    features.keypoints.push_back(keypoint);
    features.descriptors.resize(features.descriptors.size() + kDescriptorSize);
  }
  fit.distinct_inliers = fit.inliers.size();
  detection.outline = ProjectPolygon(fit.scene_from_template_plane, model.views[view].outline);
  detection.box = BoundingBox(ClipToBox(detection.outline, frame));
  detection.score = ComputeScore(detection.neg_log10_nfa);
  return detection;
}

}  // namespace victorious
