#include "testing/drawn_town.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "testing/drawing.h"
#include "testing/town_pieces.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious::testing {
namespace {

constexpr double kCarLength = 84;
constexpr double kCarBreadth = 38;
constexpr double kPavement = 22;  // between the carriageway and the block

const Colour kWhitePaint(205, 210, 212);
const Colour kGrass(62, 112, 92);
const Colour kSand(135, 172, 190);

class Town {
 public:
  Town(cv::Size size, std::uint64_t seed)
      : random_(seed), size_(size), colour_(size, CV_8UC3, kGrass), texture_(size, CV_8U, Colour::all(28)) {}

  cv::Mat Draw() {
    const std::vector<Street> columns = LayOut(size_.width);
    const std::vector<Street> rows = LayOut(size_.height);
    PaintStreets(columns, rows);
    for (std::size_t r = 0; r + 1 < rows.size(); ++r) {
      for (std::size_t c = 0; c + 1 < columns.size(); ++c)
        PaintBlock(Between(columns[c], columns[c + 1], rows[r], rows[r + 1]));
    }
    PaintShadows();
    for (const TownPiece& piece : pieces_) PaintPiece(colour_, texture_, piece, random_);
    Weather();
    return colour_;
  }

 private:
  struct Street {
    double middle;
    double width;
  };

  /// Streets along one axis; the first and the last are outside the image.
  std::vector<Street> LayOut(double length) {
    std::vector<Street> streets;
    for (double at = random_.Uniform(-420, -60); at < length + 700; at += random_.Uniform(520, 760)) {
      streets.push_back({at, random_.Uniform(96, 132)});
    }
    return streets;
  }

  static cv::Rect2d Between(const Street& left, const Street& right, const Street& above, const Street& below) {
    const double x0 = left.middle + left.width / 2;
    const double y0 = above.middle + above.width / 2;
    return {x0, y0, right.middle - right.width / 2 - x0, below.middle - below.width / 2 - y0};
  }

  Pencil Plain() { return {colour_, {0, 0}}; }

  /// A uniform area of one material.
  void Surface(const cv::Rect2d& area, const Colour& colour, double strength) {
    const double x = area.x + area.width / 2;
    const double y = area.y + area.height / 2;
    Plain().Box(x, y, area.width, area.height, colour);
    Plain().On(texture_).Box(x, y, area.width, area.height, Colour::all(strength));
  }

  cv::Point2d Somewhere(const cv::Rect2d& area, double space = 0) {
    const auto [x, y] =
        Uniforms(random_, {{0, std::max(0.0, area.width - 2 * space)}, {0, std::max(0.0, area.height - 2 * space)}});
    return {area.x + space + x, area.y + space + y};
  }

  void PaintStreets(const std::vector<Street>& columns, const std::vector<Street>& rows) {
    for (const Street& street : columns) {
      Surface({street.middle - street.width / 2, 0, street.width, double(size_.height)}, Asphalt(), 20);
    }
    for (const Street& street : rows) {
      Surface({0, street.middle - street.width / 2, double(size_.width), street.width}, Asphalt(), 20);
    }
    for (const Street& street : columns) MarkStreet(street, rows, size_.height, true);
    for (const Street& street : rows) MarkStreet(street, columns, size_.width, false);
  }

  Colour Asphalt() { return PickColour({{92, 90, 88}, {106, 102, 100}, {98, 100, 100}}, random_); }

  /// Draws in street coordinates: u along the street, v across, from its middle.
  void MarkStreet(const Street& street, const std::vector<Street>& across, double length, bool upright) {
    Pencil pencil(colour_, upright ? cv::Point2d(street.middle, 0) : cv::Point2d(0, street.middle),
                  upright ? kPi / 2 : 0);
    const auto crossing = [&](double u, double space) {
      return std::any_of(across.begin(), across.end(),
                         [&](const Street& other) { return std::abs(u - other.middle) < other.width / 2 + space; });
    };
    RepairStreet(pencil, street, length);
    for (double u = 0; u < length; u += 44) {
      if (!crossing(u, 50)) pencil.Box(u, 0, 24, 4, kWhitePaint);
    }
    const double kerb = street.width / 2 - 2;
    for (double u = 0; u < length; u += 16) {
      if (crossing(u, 6)) continue;
      for (const double side : {-1.0, 1.0})
        pencil.Box(u, side * kerb, 15, 4, Shade(Colour(170, 172, 172), random_.Uniform(0.85, 1.05)));
    }
    for (const Street& other : across) {
      for (const double side : {-1.0, 1.0}) {
        if (random_.Uniform() < 0.6) Zebra(pencil, other.middle + side * (other.width / 2 + 26), street.width);
      }
    }
    for (double u = random_.Uniform(0, 300); u < length; u += random_.Uniform(130, 420)) {
      if (crossing(u, 90)) continue;
      const double side = random_.Uniform() < 0.5 ? -1 : 1;
      const bool parked = random_.Uniform() < 0.7;
      const double v = side * (parked ? street.width / 2 - 26 : street.width / 4);
      AddCar(pencil.ToImage({u, v}), (upright ? kPi / 2 : 0) + (side < 0 ? kPi : 0) + random_.Uniform(-0.04, 0.04));
    }
  }

  /// Repaired patches, cracks, manholes and stains.
  void RepairStreet(Pencil& pencil, const Street& street, double length) {
    const double edge = street.width / 2 - 8;
    for (double u = 0; u < length; u += random_.Uniform(50, 130)) {
      const auto [v, l, w, shade] = Uniforms(random_, {{-edge, edge}, {5, 16}, {3, 8}, {0.72, 0.92}});
      switch (random_.Below(5)) {
        case 0:
          pencil.Box(u, v * 0.6, 5 * l, 4 * w, Shade(Asphalt(), shade));
          break;
        case 1:
          pencil.Disc(u, v * 0.8, 9, Colour(58, 58, 60));
          pencil.Ring(u, v * 0.8, 8, Colour(120, 120, 122), 2);
          pencil.Line({u - 5, v * 0.8}, {u + 5, v * 0.8}, Colour(105, 105, 108), 2);
          break;
        case 2:
          pencil.Oval(u, v, l, w, Colour(72, 70, 68));
          break;
        default: {
          cv::Point2d at(u, v);
          for (int i = 0; i < 6; ++i) {
            const auto [along, aside] = Uniforms(random_, {{4, 18}, {-9, 9}});
            const cv::Point2d next = at + cv::Point2d(along, aside);
            if (std::abs(next.y) > edge) break;
            pencil.Line(at, next, Colour(66, 64, 62), 1);
            at = next;
          }
        }
      }
    }
  }

  static void Zebra(Pencil& pencil, double u, double width) {
    for (double v = -width / 2 + 12; v < width / 2 - 8; v += 15) pencil.Box(u, v, 30, 8, kWhitePaint);
  }

  void PaintBlock(const cv::Rect2d& block) {
    PaveAround(block);
    const cv::Rect2d inside(block.x + kPavement, block.y + kPavement, block.width - 2 * kPavement,
                            block.height - 2 * kPavement);
    const double choice = random_.Uniform();
    if (choice < 0.5) {
      PaintGardens(inside);
    } else if (choice < 0.72) {
      PaintYard(inside);
    } else if (choice < 0.9) {
      PaintPark(inside);
    } else {
      PaintAllotments(inside);
    }
  }

  void PaveAround(const cv::Rect2d& block) {
    Surface(block, Colour(140, 146, 150), 14);
    Pencil pencil = Plain();
    for (double x = block.x; x < block.x + block.width; x += 22) {
      pencil.Line({x, block.y}, {x, block.y + block.height}, Colour(118, 124, 128), 1);
    }
    for (double y = block.y; y < block.y + block.height; y += 22) {
      pencil.Line({block.x, y}, {block.x + block.width, y}, Colour(118, 124, 128), 1);
    }
  }

  /// Houses with gardens, two rows back to back.
  void PaintGardens(const cv::Rect2d& block) {
    const int columns = std::max(1, static_cast<int>(block.width / 240));
    const int rows = std::max(1, static_cast<int>(block.height / 240));
    const double w = block.width / columns;
    const double h = block.height / rows;
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) PaintGarden({block.x + c * w, block.y + r * h, w, h});
    }
  }

  void PaintGarden(const cv::Rect2d& lot) {
    Surface(lot, PickColour({kGrass, {70, 125, 105}, {60, 105, 80}, {80, 130, 125}}, random_), 32);
    Pencil pencil = Plain();
    pencil.Frame(lot.x + lot.width / 2, lot.y + lot.height / 2, lot.width, lot.height,
                 PickColour({{45, 75, 50}, {110, 140, 160}}, random_), 4);
    const auto [length, breadth, turn, drive_x, across, down, parked] =
        Uniforms(random_, {{140, 172}, {96, 124}, {-0.07, 0.07}, {8, 20}, {0, 1}, {0, 1}, {0.25, 0.6}});
    const bool upright = random_.Uniform() < 0.5;
    const double drive = lot.x + drive_x;
    Surface({drive, lot.y + 2, 46, lot.height * 0.8}, Colour(130, 136, 142), 22);
    if (random_.Uniform() < 0.7) AddCar({drive + 23, lot.y + lot.height * parked}, kPi / 2);
    PaintFlowers(lot, 26);
    if (random_.Uniform() < 0.3) {
      const cv::Point2d pool = Somewhere(lot, 46);
      pencil.Oval(pool.x, pool.y, 42, 27, Colour(190, 200, 205));
      pencil.Oval(pool.x, pool.y, 36, 22, Colour(200, 170, 90));
    }
    const cv::Size2d house = upright ? cv::Size2d(breadth, length) : cv::Size2d(length, breadth);
    const double left = drive + 60;  // beside the drive, and inside the fence
    const cv::Point2d at(left + house.width / 2 + across * std::max(0.0, lot.x + lot.width - 12 - left - house.width),
                         lot.y + 16 + house.height / 2 + down * std::max(0.0, lot.height - 32 - house.height));
    AddPiece({TownPiece::Kind::kHouse, at, length, breadth, turn + (upright ? kPi / 2 : 0), 26});
    const int trees = static_cast<int>(random_.Below(4));
    for (int i = 0; i < trees; ++i) {
      const double breadth_px = random_.Uniform(34, 72);
      AddTree(Somewhere(lot, 24), breadth_px);
    }
  }

  void PaintFlowers(const cv::Rect2d& area, int count) {
    Pencil pencil = Plain();
    for (int i = 0; i < count; ++i) {
      const cv::Point2d at = Somewhere(area, 6);
      const Colour petal =
          PickColour({{60, 60, 200}, {90, 200, 230}, {200, 110, 170}, {225, 225, 230}, {40, 80, 45}}, random_);
      pencil.Disc(at.x, at.y, random_.Uniform(1.5, 4.5), petal);
    }
  }

  /// A hall, and a car park beside it.
  void PaintYard(const cv::Rect2d& block) {
    Surface(block, Shade(Asphalt(), 1.15), 24);
    const double share = random_.Uniform(0.45, 0.65);
    AddPiece({TownPiece::Kind::kHall,
              {block.x + block.width * share / 2, block.y + block.height / 2},
              block.width * share - 20,
              block.height - 40,
              0,
              36});
    Pencil pencil = Plain();
    const double left = block.x + block.width * share + 24;
    const double right = block.x + block.width - 8;
    for (double y = block.y + 20; y + 48 < block.y + block.height; y += 48) {
      for (double x = left; x + 96 < right + 2; x += 128) {
        pencil.Line({x, y}, {x + 92, y}, kWhitePaint, 3);
        pencil.Line({x, y + 48}, {x + 92, y + 48}, kWhitePaint, 3);
        const auto [taken, way, askew] = Uniforms(random_, {{0, 1}, {0, 1}, {-0.05, 0.05}});
        if (taken < 0.55) AddCar({x + 46, y + 24}, (way < 0.5 ? 0 : kPi) + askew);
      }
    }
    AddTree({right - 16, block.y + block.height - 22}, 44);
  }

  void PaintPark(const cv::Rect2d& block) {
    Surface(block, PickColour({kGrass, {66, 120, 98}}, random_), 34);
    Pencil pencil = Plain();
    for (double x = block.x; x < block.x + block.width - 20; x += 40) {  // mown stripes
      Plain().Box(x + 10, block.y + block.height / 2, 20, block.height, Shade(kGrass, 1.08));
    }
    const cv::Point2d middle = Somewhere(block, block.width * 0.35);
    for (int i = 0; i < 4; ++i) {
      const cv::Point2d gate(i % 2 == 0 ? block.x : block.x + block.width, i < 2 ? block.y : block.y + block.height);
      pencil.Line(gate, middle, Shade(kSand, 0.8), 26);
      pencil.Line(gate, middle, kSand, 21);
    }
    pencil.Disc(middle.x, middle.y, 58, Shade(kSand, 0.9));
    pencil.Disc(middle.x, middle.y, 42, Colour(150, 155, 160));
    pencil.Disc(middle.x, middle.y, 35, Colour(150, 125, 75));
    for (int i = 0; i < 16; ++i) {
      pencil.Disc(middle.x + 42 * std::cos(i * kPi / 8), middle.y + 42 * std::sin(i * kPi / 8), 3.5,
                  Colour(195, 200, 205));
    }
    PaintFlowers(block, 160);
    const int trees = 12 + static_cast<int>(random_.Below(14));
    for (int i = 0; i < trees; ++i) {
      const cv::Point2d at = Somewhere(block, 30);
      if (cv::norm(at - middle) > 100) AddTree(at, random_.Uniform(44, 104));
    }
  }

  /// Strips of beds with their plants in rows.
  void PaintAllotments(const cv::Rect2d& block) {
    Surface(block, Colour(75, 105, 125), 40);
    Pencil pencil = Plain();
    for (double y = block.y + 8; y + 60 < block.y + block.height; y += 76) {
      for (double x = block.x + 8; x + 80 < block.x + block.width;) {
        const double w = random_.Uniform(70, 150);
        const cv::Rect2d bed(x, y, std::min(w, block.x + block.width - 8 - x), 64);
        Surface(bed, PickColour({{50, 70, 95}, {60, 85, 110}, {55, 100, 80}}, random_), 46);
        const Colour plant = PickColour({{50, 130, 80}, {60, 150, 130}, {80, 110, 60}, {60, 90, 160}}, random_);
        const double gap = random_.Uniform(9, 16);
        for (double v = gap / 2; v < 64; v += gap) {
          for (double u = gap / 2; u < bed.width; u += gap) {
            const auto [grown, along, across, shade] = Uniforms(random_, {{0, 1}, {-2, 2}, {-2, 2}, {0.75, 1.2}});
            if (grown < 0.85) pencil.Disc(x + u + along, y + v + across, gap * 0.32, Shade(plant, shade));
          }
        }
        x += w + 12;
      }
    }
    const double turn = random_.Uniform(-0.3, 0.3);
    AddPiece({TownPiece::Kind::kHouse, Somewhere(block, 70), 84, 60, turn, 16});
  }

  void AddPiece(const TownPiece& piece) { pieces_.push_back(piece); }
  void AddTree(cv::Point2d at, double breadth) {
    AddPiece({TownPiece::Kind::kTree, at, breadth, breadth, 0, breadth * 0.35});
  }
  void AddCar(cv::Point2d at, double angle_rad) {
    AddPiece({TownPiece::Kind::kCar, at, kCarLength * random_.Uniform(0.9, 1.08), kCarBreadth, angle_rad, 7});
  }

  void PaintShadows() {
    cv::Mat mask = cv::Mat::zeros(size_, CV_8U);
    for (const TownPiece& piece : pieces_) PaintShadow(mask, piece, Colour::all(120));
    cv::GaussianBlur(mask, mask, {}, 1.5);
    const cv::Mat darker(size_, CV_32F, cv::Scalar(-1));
    ApplyTexture(colour_, darker, mask);
  }

  /// Noise texture at scales of 2 to 150 px, and lens blur.
  void Weather() {
    cv::Mat noise = SmoothNoise(size_, 2.2, random_);
    noise += 0.9 * SmoothNoise(size_, 5, random_);
    noise += 0.8 * SmoothNoise(size_, 14, random_);
    noise += 0.7 * SmoothNoise(size_, 45, random_);
    noise += 0.5 * SmoothNoise(size_, 150, random_);
    ApplyTexture(colour_, noise, texture_);
    cv::GaussianBlur(colour_, colour_, {}, 0.6);
  }

  Random random_;
  cv::Size size_;
  cv::Mat colour_;
  cv::Mat texture_;
  std::vector<TownPiece> pieces_;
};

}  // namespace

cv::Mat DrawTown(cv::Size size, std::uint64_t seed) { return Town(size, seed).Draw(); }

}  // namespace victorious::testing
