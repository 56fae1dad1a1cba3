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
#include "victorious/detect/detect.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/homography.h"
#include "victorious/geometry/similarity.h"
#include "victorious/kernels/window_products.h"
#include "victorious/recognize/shape_templates.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMaxEnlargement = 2;  // of the frame: more shows no more
constexpr double kMinObject_px = 24;   // diagonal of the bounding box in the frame
constexpr double kMinDown = 0.25;      // cosine of the off-nadir angle: views end at 70 degrees
constexpr double kTileOffNadir_rad = RadiansFromDegrees(6);
constexpr int kHeadings = 36;
constexpr int kHeadingStep_deg = 360 / kHeadings;
constexpr int kFineHeadingStep_deg = 5;
constexpr int kOffNadirStep_deg = 5;
constexpr int kSunStep_deg = 30;
constexpr std::size_t kMaxPlaces = 4;  // of a model in a frame that are searched with fine templates
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
  const double focal_px = vertical.pinhole.fx;
  const auto parts = [&](int length_px) {
    return std::max(1, static_cast<int>(std::ceil(std::atan(length_px / focal_px) / kTileOffNadir_rad)));
  };
  const int rows = parts(size.height);
  const int columns = parts(size.width);
  std::vector<Tile> tiles;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const cv::Point first(size.width * column / columns, size.height * row / rows);
      const cv::Point last(size.width * (column + 1) / columns, size.height * (row + 1) / rows);
      tiles.push_back({cv::Rect(first, last)});
    }
  }
  return tiles;
}

// A part of the frame at another scale, turned so that the vertical points upwards.
struct UprightPart {
  GradientCells cells;
  double scale = 1;  // pixels of the part per pixel of the frame
  double lean_rad = 0;
  Vector2d centre_px;  // in the frame
  Vector2d centre_in_part_px;

  [[nodiscard]] Vector2d ToFrame(const Vector2d& in_part) const {
    const Similarity2 turned{.scale = 1 / scale, .rotation_rad = lean_rad};
    return centre_px + turned.Apply(in_part - centre_in_part_px);
  }
};

UprightPart CutUpright(const cv::Mat& grey, const Vector2d& centre_px, const cv::Size2d& size_px, double scale,
                       double lean_rad) {
  UprightPart made{.cells = {}, .scale = scale, .lean_rad = lean_rad, .centre_px = centre_px, .centre_in_part_px = {}};
  const cv::Size size(static_cast<int>(std::ceil(size_px.width * scale)),
                      static_cast<int>(std::ceil(size_px.height * scale)));
  made.centre_in_part_px = {0.5 * size.width, 0.5 * size.height};
  // Reduced without aliasing: the frame around the part is averaged first, then turned.
  const double around_px = 0.5 * std::hypot(size_px.width, size_px.height) + 4 / scale;
  const cv::Rect around = cv::Rect(cv::Point(static_cast<int>(std::floor(centre_px.x() - around_px)),
                                             static_cast<int>(std::floor(centre_px.y() - around_px))),
                                   cv::Point(static_cast<int>(std::ceil(centre_px.x() + around_px)),
                                             static_cast<int>(std::ceil(centre_px.y() + around_px)))) &
                          cv::Rect({0, 0}, grey.size());
  if (around.empty()) return made;
  const cv::Size scaled_size(std::max(1, static_cast<int>(std::lround(around.width * scale))),
                             std::max(1, static_cast<int>(std::lround(around.height * scale))));
  cv::Mat scaled;
  cv::resize(grey(around), scaled, scaled_size, 0, 0, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  const Vector2d ratio(static_cast<double>(scaled_size.width) / around.width,
                       static_cast<double>(scaled_size.height) / around.height);
  const double c = std::cos(lean_rad);
  const double s = std::sin(lean_rad);
  // Pixel indices, whose centres lie 0.5 further: scaled = ratio * (centre - corner + R (part - centre) / scale).
  const Eigen::Matrix2d linear = ratio.asDiagonal() * (Eigen::Matrix2d() << c, -s, s, c).finished() / scale;
  const Vector2d corner(around.x, around.y);
  const Vector2d half(0.5, 0.5);
  const Vector2d shift = ratio.cwiseProduct(centre_px - corner) - linear * (made.centre_in_part_px - half) - half;
  const cv::Matx23d scaled_from_part(linear(0, 0), linear(0, 1), shift.x(), linear(1, 0), linear(1, 1), shift.y());
  cv::Mat part;
  cv::warpAffine(scaled, part, scaled_from_part, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  made.cells = MakeGradientCells(part);
  return made;
}

// The cells of a part that templates are compared with: every second one, from one of the four first, within a border
// of mean background, so that templates may reach beyond the part.
struct CodeMap {
  std::vector<std::int16_t> codes;
  int rows = 0;
  int columns = 0;
};

CodeMap TakeCells(const GradientCells& cells, const cv::Point& phase, int border,
                  const std::array<float, kCellOrientations>& mean) {
  constexpr int kStride = kCellSide_px / kCellStep_px;
  const int rows = (cells.rows - phase.y + kStride - 1) / kStride;
  const int columns = (cells.columns - phase.x + kStride - 1) / kStride;
  CodeMap map{.codes = {}, .rows = rows + 2 * border, .columns = columns + 2 * border};
  map.codes.resize(static_cast<std::size_t>(map.rows) * map.columns * kCellOrientations);
  std::array<std::int16_t, kCellOrientations> outside{};
  for (std::size_t k = 0; k < outside.size(); ++k) {
    outside[k] = static_cast<std::int16_t>(std::lround(mean[k] * (kMaxCellCode / kMaxCellValue)));
  }
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      std::int16_t* const out =
          map.codes.data() + (static_cast<std::size_t>(row) * map.columns + column) * kCellOrientations;
      const int y = row - border;
      const int x = column - border;
      if (y < 0 || x < 0 || y >= rows || x >= columns) {
        std::ranges::copy(outside, out);
      } else {
        std::copy_n(cells.at(phase.y + kStride * y, phase.x + kStride * x), kCellOrientations, out);
      }
    }
  }
  return map;
}

// Templates of one size, side by side.
struct Bank {
  std::vector<ShapeTemplateKey> keys;
  std::vector<std::shared_ptr<const ShapeTemplate>> templates;
  std::vector<std::int16_t> weights;
  int window = 0;
};

// The largest response at each position, and the template that gives it.
struct ResponseMap {
  cv::Mat response;  // CV_32F
  cv::Mat which;     // CV_32S, index into the bank
};

// @param border  cells of mean background around; a template's position is then that of its middle, else of its corner
ResponseMap Respond(const GradientCells& cells, const cv::Point& phase, const Bank& bank, int border,
                    const std::array<float, kCellOrientations>& mean) {
  const CodeMap map = TakeCells(cells, phase, border, mean);
  const auto window = static_cast<std::size_t>(bank.window);
  if (map.rows < bank.window || map.columns < bank.window) return {};
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
    const float scale = bank.templates[t]->scale;
    const float offset = bank.templates[t]->offset;
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
  using GetTemplate = std::function<Expected<std::shared_ptr<const ShapeTemplate>>(const ShapeTemplateKey&)>;

  ModelShapeSearch(std::size_t model, double diagonal_m, double centre_height_m, const GetTemplate& get_template,
                   const std::array<float, kCellOrientations>& mean)
      : model_(model),
        diagonal_m_(diagonal_m),
        centre_height_m_(centre_height_m),
        get_template_(get_template),
        mean_(mean) {}

  // The best places of coarse templates in a tile.
  Expected<std::vector<Place>> FindPlaces(const cv::Mat& grey, const FrameConditions& conditions,
                                          const Tile& tile) const {
    const auto view = ViewAt(conditions, tile.centre(), centre_height_m_);
    if (!view) return std::vector<Place>{};
    const double object_px = diagonal_m_ * view->pixels_per_m;
    if (object_px < kMinObject_px) return std::vector<Place>{};
    const TemplateSize size = ChooseSize(object_px, kCoarseSize_px);
    std::array<int, kHeadings> azimuths_deg{};
    for (int i = 0; i < kHeadings; ++i) azimuths_deg[static_cast<std::size_t>(i)] = kHeadingStep_deg * i;
    // Without the sun, the templates are the same whichever way the camera looks.
    ShapeTemplateKey key = KeyFor(*view, size);
    key.sun_azimuth_deg.reset();
    key.sun_elevation_deg = 0;
    VICTORIOUS_ASSIGN_OR_RETURN(const Bank bank, MakeBank(key, azimuths_deg));
    if (bank.templates.empty()) return std::vector<Place>{};
    // Objects of the tile reach beyond it; turned, so do its corners.
    const double margin_px = object_px;
    const double turned = std::abs(std::sin(view->lean_rad));
    const cv::Size2d wanted(tile.part.width + margin_px + turned * tile.part.height,
                            tile.part.height + margin_px + turned * tile.part.width);
    const UprightPart part = CutUpright(grey, tile.centre(), wanted, size.scale, view->lean_rad);
    std::vector<Place> places;
    const ResponseMap map = Respond(part.cells, {0, 0}, bank, bank.window / 2, mean_);
    if (map.response.empty()) return places;
    const int reach = std::max(1, static_cast<int>(kSuppression * kCoarseSize_px / 2 / kCellSide_px));
    cv::Mat highest;
    cv::dilate(map.response, highest, cv::Mat::ones(2 * reach + 1, 2 * reach + 1, CV_8U));
    for (int row = 0; row < map.response.rows; ++row) {
      for (int column = 0; column < map.response.cols; ++column) {
        const float response = map.response.at<float>(row, column);
        if (response < kMinCoarseResponse || response < highest.at<float>(row, column)) continue;
        const Vector2d at_px = part.ToFrame({kCellSide_px * column + 0.5, kCellSide_px * row + 0.5});
        if (!tile.part.contains(
                cv::Point(static_cast<int>(std::floor(at_px.x())), static_cast<int>(std::floor(at_px.y())))))
          continue;
        const ShapeTemplateKey& found = bank.keys[static_cast<std::size_t>(map.which.at<int>(row, column))];
        places.push_back({.model = model_, .response = response, .at_px = at_px, .azimuth_deg = found.azimuth_deg});
      }
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
    std::vector<int> azimuths_deg;
    for (int i = -headings; i <= headings; ++i) azimuths_deg.push_back(place.azimuth_deg + i * kFineHeadingStep_deg);
    VICTORIOUS_ASSIGN_OR_RETURN(const Bank bank, MakeBank(KeyFor(*view, size), azimuths_deg));
    if (bank.templates.empty()) return std::optional<ShapeMatch>();
    const double side_px = (kCellSide_px * bank.window + 2 * kFineReach_px) / size.scale;
    const UprightPart part = CutUpright(grey, place.at_px, {side_px, side_px}, size.scale, view->lean_rad);
    // The responses of all four phases, every second pixel.
    cv::Mat responses;
    cv::Mat which;
    for (const cv::Point phase : {cv::Point(0, 0), cv::Point(1, 0), cv::Point(0, 1), cv::Point(1, 1)}) {
      const ResponseMap map = Respond(part.cells, phase, bank, 0, mean_);
      if (responses.empty()) {
        responses = cv::Mat(2 * map.response.rows, 2 * map.response.cols, CV_32F, cv::Scalar(-1e9));
        which = cv::Mat::zeros(responses.size(), CV_32S);
      }
      for (int row = 0; row < std::min(map.response.rows, responses.rows / 2); ++row) {
        for (int column = 0; column < std::min(map.response.cols, responses.cols / 2); ++column) {
          responses.at<float>(2 * row + phase.y, 2 * column + phase.x) = map.response.at<float>(row, column);
          which.at<int>(2 * row + phase.y, 2 * column + phase.x) = map.which.at<int>(row, column);
        }
      }
    }
    if (responses.empty()) return std::optional<ShapeMatch>();
    double highest = 0;
    cv::Point at;
    cv::minMaxLoc(responses, nullptr, &highest, nullptr, &at);
    const ShapeTemplateKey& key = bank.keys[static_cast<std::size_t>(which.at<int>(at))];
    const Vector2d corner(kCellStep_px * at.x + 0.5, kCellStep_px * at.y + 0.5);
    const Vector2d to_middle = Vector2d::Constant(kCellSide_px * (bank.window / 2));
    std::optional<ShapeMatch> best =
        ShapeMatch{.model_index = model_,
                   .to_camera = {RadiansFromDegrees(key.azimuth_deg), view->off_nadir_rad},
                   .centre_px = part.ToFrame(corner + to_middle + kCellStep_px * PeakOffset(responses, at)),
                   .pixels_per_m = view->pixels_per_m,
                   .lean_rad = view->lean_rad,
                   .paint = key.paint,
                   .response = highest};
    return best;
  }

 private:
  [[nodiscard]] ShapeTemplateKey KeyFor(const LocalView& view, const TemplateSize& size) const {
    return {.model = model_,
            .off_nadir_deg = std::max(kOffNadirStep_deg / 2, Quantised(view.off_nadir_rad, kOffNadirStep_deg)),
            .sun_azimuth_deg = view.sun_azimuth_deg,
            .sun_elevation_deg = view.sun_elevation_deg,
            .eighth_octaves = size.eighth_octaves};
  }

  Expected<Bank> MakeBank(ShapeTemplateKey key, std::span<const int> azimuths_deg) const {
    Bank bank{.keys = {}, .templates = {}, .weights = {}, .window = key.window()};
    for (const TemplatePaint paint : {TemplatePaint::kPlain, TemplatePaint::kOwn}) {
      for (const int azimuth_deg : azimuths_deg) {
        key.paint = paint;
        key.azimuth_deg = (azimuth_deg + 360) % 360;
        VICTORIOUS_ASSIGN_OR_RETURN(std::shared_ptr<const ShapeTemplate> one, get_template_(key));
        if (one->weights.empty()) continue;
        bank.keys.push_back(key);
        bank.weights.insert(bank.weights.end(), one->weights.begin(), one->weights.end());
        bank.templates.push_back(std::move(one));
      }
    }
    return bank;
  }

  std::size_t model_;
  double diagonal_m_;
  double centre_height_m_;
  const GetTemplate& get_template_;
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
    if (of_model.size() > kMaxPlaces) of_model.resize(kMaxPlaces);
    best.insert(best.end(), of_model.begin(), of_model.end());
  }
  return best;
}

void ParallelFor(std::size_t count, const std::function<void(std::size_t)>& work) {
  oneapi::tbb::this_task_arena::isolate([&] {  // else a waiting thread could start on another frame
    oneapi::tbb::parallel_for(std::size_t{0}, count, work);
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
  const ModelShapeSearch::GetTemplate get_template = [this](const ShapeTemplateKey& key) {
    return templates_->Get(key);
  };
  const auto search_for = [&](std::size_t m) {
    return ModelShapeSearch(m, templates_->diagonal_m(m), models_[m].box_m->sizes().z() / 2, get_template,
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
  const ModelShapeSearch::GetTemplate get_template = [this](const ShapeTemplateKey& key) {
    return templates_->Get(key);
  };
  const ModelShapeSearch search(m, templates_->diagonal_m(m), models_[m].box_m->sizes().z() / 2, get_template,
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
