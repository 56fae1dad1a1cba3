#include "victorious/lab/simulate/parcel.h"

#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using std::string_view;

constexpr std::array<string_view, 8> kCars = {"cars/estate_black",    "cars/estate_blue",   "cars/estate_silver",
                                              "cars/hatchback_green", "cars/hatchback_red", "cars/hatchback_white",
                                              "cars/van_white",       "cars/van_yellow"};
constexpr std::array<string_view, 4> kTrees = {"trees/birch", "trees/maple", "trees/oak", "trees/spruce"};
constexpr std::array<string_view, 3> kHouses = {"buildings/house_brown", "buildings/house_grey", "buildings/house_red"};
constexpr std::array<string_view, 2> kContainers = {"props/container_blue", "props/container_red"};
constexpr std::array<string_view, 3> kYardProps = {"props/crates", "props/crates", "props/skip"};
constexpr std::array<string_view, 1> kCrates = {"props/crates"};
constexpr std::array<string_view, 1> kHedge = {"props/hedge"};
constexpr std::array<string_view, 1> kLamp = {"props/lamp_post"};
constexpr std::array<string_view, 4> kYardGround = {"gravel", "concrete", "brick", "dirt"};

constexpr double kBorderM = 10.6;  // distance of the hedges from the centre of a square

void PutTrees(Parcel& parcel, double probability, std::initializer_list<Vector2d> places) {
  for (const Vector2d& place : places) parcel.PutWithProbability(probability, kTrees, place.x(), place.y(), 0, 1.2);
}

// Four rows of parking bays, as painted on the tile.
void FurnishParking(Parcel& parcel) {
  constexpr std::array<double, 4> kRowsM = {9.3, 1.3, -1.7, -9.7};
  constexpr double kFirstBayM = -9.625;
  constexpr double kBayM = 2.75;
  for (const double row : kRowsM) {
    for (int bay = 0; bay < 8; ++bay) {
      parcel.PutWithProbability(0.85, kCars, kFirstBayM + bay * kBayM, row, parcel.DrawBool(0.5) ? 0 : 180, 0.25);
    }
  }
}

void FurnishPark(Parcel& parcel) {
  PutTrees(parcel, 0.9, {{-9, 9}, {-8, -2}, {-9, -9}, {2, -9}, {8, -8}, {7, 1}, {9, 9.5}, {-4, 10}, {4, -3}});
  for (const double y : {-7.0, 0.0, 7.0}) parcel.PutWithProbability(0.5, kHedge, -11.2, y, 0);
}

void FurnishCourt(Parcel& parcel) {
  PutTrees(parcel, 1.2, {{-7.6, 7.6}, {8.4, 7.6}, {-7.6, -8.4}, {8.4, -8.4}});
  for (const double x : {-4.0, 4.6}) parcel.PutWithProbability(0.9, kLamp, x, 0.5, x < 0 ? 90 : 270);
  for (const double y : {-3.0, 3.0}) parcel.PutWithProbability(0.5, kYardProps, 10, y, 20, 0.8);
}

void FurnishSports(Parcel& parcel) {
  for (const double y : {-8.0, -2.0, 4.0}) {
    for (const double x : {-9.6, 9.6}) parcel.Put("props/fence", x, y, 0);
  }
  PutTrees(parcel, 0.8, {{-11, 11}, {11, 11}, {-11, -11}, {11, -11}});
}

void FurnishYard(Parcel& parcel) {
  for (const double x : {-9.0, -6.0, -3.0, 0.0}) parcel.PutWithProbability(0.8, kContainers, x, -7.5, 0, 0.3);
  parcel.PutWithProbability(0.7, kContainers, 8.5, 7, 90, 0.6);
  for (const Vector2d& place : {Vector2d(4, 9), {9, 3}, {6, 0}, {10, -4}, {-10, 0}, {-2, 2}, {3, -9}}) {
    parcel.PutWithProbability(0.6, kYardProps, place.x(), place.y(), parcel.random().Uniform(0, 360), 1.5);
  }
}

void FurnishSite(Parcel& parcel) {
  for (const double x : {-9.0, -3.0, 3.0, 9.0}) parcel.Put("props/fence", x, -11.6, 90);
  for (const Vector2d& place : {Vector2d(-9, 8), {-5, 3}, {0, 9}, {9, -4}, {4, -7}, {-1, -6}, {7, 2}, {-10, -3}}) {
    parcel.PutWithProbability(0.6, kYardProps, place.x(), place.y(), parcel.random().Uniform(0, 360), 1.5);
  }
  parcel.PutWithProbability(0.8, kContainers, -7, -3, 75, 0.5);
}

void FurnishHomes(Parcel& parcel) {
  if (parcel.DrawBool(0.5)) parcel.LayMaterial(parcel.Pick(kYardGround));
  for (const double x : {-6.0, 6.0}) parcel.PutWithProbability(1.4, kHouses, x, -1.5, 0);
  for (const double x : {-7.8, 7.8}) parcel.PutWithProbability(0.9, kHedge, x, kBorderM, 90);
  parcel.PutWithProbability(0.9, kCars, 0.3, 8.5, 0, 0.4);
  PutTrees(parcel, 0.8, {{-10.5, -10.5}, {0, -10.5}, {10.5, -10.5}, {-3.8, 8.5}, {10.5, 8}, {-10.8, 8}});
  parcel.PutWithProbability(0.3, kYardProps, 3, 8.8, 30, 0.5);
}

// A row of cars in front of the building, and trees beside them.
void FurnishForecourt(Parcel& parcel) {
  for (double x = -8.2; x < 9; x += 2.75)
    parcel.PutWithProbability(0.7, kCars, x, 8, parcel.DrawBool(0.5) ? 0 : 180, 0.3);
  PutTrees(parcel, 0.9, {{-11, 6}, {11, 6}, {-11, -11}, {11, -11}});
  parcel.PutWithProbability(0.9, kLamp, 0, 11, 180);
}

void FurnishFlats(Parcel& parcel) {
  parcel.LayMaterial("concrete");
  parcel.Put("buildings/flats", 0, -4.5, 90);
  FurnishForecourt(parcel);
}

void FurnishOffices(Parcel& parcel) {
  parcel.LayMaterial(parcel.DrawBool(0.5) ? "brick" : "asphalt");
  parcel.Put("buildings/offices", 0, -4, 90);
  FurnishForecourt(parcel);
}

void FurnishShop(Parcel& parcel) {
  parcel.LayMaterial("asphalt");
  parcel.Put("buildings/shop", 0, -3.5, 0);
  for (const double y : {-8.0, 0.0}) parcel.PutWithProbability(0.6, kYardProps, 10, y, 0, 0.5);
  FurnishForecourt(parcel);
}

// The warehouse is longer than a square: it extends over the verge of the street.
void FurnishWarehouse(Parcel& parcel) {
  parcel.LayMaterial("concrete");
  parcel.Put("buildings/warehouse", 0, 2, 0);
  for (const double y : {-7.0, 0.0, 7.0}) parcel.PutWithProbability(0.6, kYardProps, 10.8, y, 0, 0.2);
  for (const double y : {-8.0, 3.0}) parcel.PutWithProbability(0.6, kContainers, -10.8, y, 0, 0.1);
}

void FurnishGarages(Parcel& parcel) {
  parcel.LayMaterial(parcel.DrawBool(0.5) ? "concrete" : "asphalt");
  parcel.Put("buildings/garages", -8.6, -1, 90);
  parcel.Put("buildings/garages", 8.6, -1, 270);
  for (const double y : {-8.0, -2.0, 4.0}) {
    parcel.PutWithProbability(0.4, kCars, -2.5, y, 20, 0.5);
    parcel.PutWithProbability(0.4, kCars, 2.5, y + 2, 170, 0.5);
  }
  for (const double x : {-9.0, -3.0, 3.0, 9.0}) parcel.PutWithProbability(0.8, kHedge, x, -11.4, 90);
}

void FurnishTower(Parcel& parcel) {
  parcel.LayMaterial("gravel");
  parcel.Put("buildings/water_tower", 0, 0, 0);
  for (const double x : {-6.5, 0.0, 6.5}) parcel.Put("props/fence", x, 9.5, 90);
  for (const Vector2d& place : {Vector2d(-7, 6), {7, 6}, {-7, -7}, {7, -5}}) {
    parcel.PutWithProbability(0.6, kCrates, place.x(), place.y(), 0, 1.0);
  }
  PutTrees(parcel, 0.8, {{-10.5, -10.5}, {10.5, -10.5}});
}

void FurnishGreen(Parcel& parcel) {
  for (int i = 0; i < 9; ++i) {
    parcel.PutWithProbability(0.8, kTrees, parcel.random().Uniform(-10, 10), parcel.random().Uniform(-10, 10), 0, 0.5);
  }
}

void FurnishPad(Parcel& parcel) {
  for (const Vector2d& place : {Vector2d(-10.5, -10.5), {10.5, -10.5}, {10.5, 10}, {-10.5, 3}}) {
    parcel.PutWithProbability(0.7, kCrates, place.x(), place.y(), 0, 0.8);
  }
}

}  // namespace

Vector2d Parcel::InTown(double x_m, double y_m) const {
  const double heading = turns_ * kPi / 2;
  return middle_m_ +
         Vector2d(x_m * std::cos(heading) + y_m * std::sin(heading), y_m * std::cos(heading) - x_m * std::sin(heading));
}

void Parcel::Place(const std::string& asset, double x_m, double y_m, double heading_rad) {
  placements_.push_back({.asset = "town/" + asset,
                         .place_m = InTown(x_m, y_m),
                         .bottom_m = 0,
                         .heading_rad = heading_rad + turns_ * kPi / 2});
}

void Parcel::LayTile(string_view tile) { Place(fmt::format("tiles/{}", tile), 0, 0, 0); }

void Parcel::LayMaterial(string_view material) {
  constexpr double kLotSideM = 20;
  placements_.push_back({.asset = fmt::format("town/ground/{}", material), .place_m = middle_m_, .side_m = kLotSideM});
}

void Parcel::Put(string_view asset, double x_m, double y_m, double heading_deg, double jitter_m) {
  const double x = x_m + jitter_m * random_.Uniform(-1, 1);
  const double y = y_m + jitter_m * random_.Uniform(-1, 1);
  constexpr double kJitterRadPerM = 0.12;  // maximum change of heading per metre of position jitter
  double heading = RadiansFromDegrees(heading_deg) + jitter_m * kJitterRadPerM * random_.Uniform(-1, 1);
  if (asset.starts_with("trees/")) heading = random_.Uniform(0, 2 * kPi);
  Place(std::string(asset), x, y, heading);
}

void Parcel::PutWithProbability(double probability, std::span<const string_view> assets, double x_m, double y_m,
                                double heading_deg, double jitter_m) {
  // Draws all random numbers in either case: a lower density removes placements but does not change the others.
  const bool stands = random_.Uniform() < probability * density_;
  const string_view asset = Pick(assets);
  if (stands) Put(asset, x_m, y_m, heading_deg, jitter_m);
}

void FurnishStreet(Parcel& parcel) {
  const double kind = parcel.random().Uniform();
  parcel.LayTile(kind < 0.2 ? "road_crossing" : kind < 0.35 ? "road_bus" : "road_straight");
  const bool parked = kind >= 0.2;
  for (const double y : {-9.0, -3.0, 3.0, 9.0}) {
    if (parked && kind >= 0.35) parcel.PutWithProbability(0.55, kCars, -3.4, y, 180, 0.2);
    if (parked) parcel.PutWithProbability(0.55, kCars, 3.4, y, 0, 0.2);
    PutTrees(parcel, 0.45, {{-9.5, y}, {9.5, y}});
  }
  if (kind < 0.2) parcel.PutWithProbability(0.8, kCars, 2.1, -7, 0, 0.2);  // a car waiting at the crossing
  if (!parked || kind >= 0.35) parcel.PutWithProbability(0.6, kLamp, 6.4, -6, 270);
  if (parked && kind < 0.35) parcel.Put("props/bus_stop", -6.2, 1, 0);
  parcel.PutWithProbability(0.6, kLamp, -6.4, 6, 90);
  parcel.PutWithProbability(0.4, kHedge, 11, 0, 0);
}

void FurnishJunction(Parcel& parcel) {
  parcel.LayTile("road_junction");
  parcel.PutWithProbability(0.6, kCars, 2.1, -10, 0, 0.2);
  parcel.PutWithProbability(0.6, kCars, -2.1, 10, 180, 0.2);
  parcel.PutWithProbability(0.5, kCars, -10, -2.1, 90, 0.2);
  PutTrees(parcel, 0.7, {{-10, 10}, {10, 10}, {-10, -10}, {10, -10}});
}

void FurnishTile(Parcel& parcel, string_view tile) {
  using Furnish = void (*)(Parcel&);
  constexpr std::array<std::pair<string_view, Furnish>, 8> kFurnished = {{{"parking", &FurnishParking},
                                                                          {"park", &FurnishPark},
                                                                          {"court", &FurnishCourt},
                                                                          {"sports", &FurnishSports},
                                                                          {"yard", &FurnishYard},
                                                                          {"site", &FurnishSite},
                                                                          {"apron", &FurnishPad},
                                                                          {"helipad", &FurnishPad}}};
  parcel.LayTile(tile);
  for (const auto& [name, furnish] : kFurnished) {
    if (tile == name) furnish(parcel);
  }
}

void FurnishSquare(Parcel& parcel, bool at_street) {
  constexpr std::array<string_view, 12> kTiles = {"parking", "parking", "parking", "park", "park",  "court",
                                                  "sports",  "yard",    "yard",    "site", "apron", "helipad"};
  constexpr std::array kBuilt = {&FurnishHomes,   &FurnishHomes,   &FurnishHomes,    &FurnishFlats, &FurnishFlats,
                                 &FurnishOffices, &FurnishOffices, &FurnishShop,     &FurnishShop,  &FurnishGarages,
                                 &FurnishTower,   &FurnishGreen,   &FurnishWarehouse};
  if (parcel.DrawBool(0.4)) return FurnishTile(parcel, parcel.Pick(kTiles));
  const auto last = static_cast<std::uint32_t>(kBuilt.size() - (at_street ? 0 : 1));  // the last needs a street
  kBuilt[parcel.random().Below(last)](parcel);
}

}  // namespace victorious
