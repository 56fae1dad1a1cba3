#include "victorious/lab/evaluate/score.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "testing/data.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using ::testing::DoubleEq;
using ::testing::DoubleNear;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::Optional;

constexpr Box kBox{100, 100, 40, 40};

TruthRow MakeTruthRow(std::int64_t frame, const std::string& object, const Box& box = kBox, double visible = 1.0) {
  return {frame, object, "m", box, visible, {}};
}

ReportedSighting MakeSighting(std::int64_t object, std::int64_t frame, const Box& box = kBox, double score = 0.5) {
  return {object, frame, "m", box, score, {}};
}

/// A flight of one object of model "m" in frames 0 to frames - 1.
std::vector<TruthRow> MakeTruthRows(int frames, const std::string& object = "a", const Box& box = kBox) {
  std::vector<TruthRow> rows;
  for (int frame = 0; frame < frames; ++frame) rows.push_back(MakeTruthRow(frame, object, box));
  return rows;
}

std::vector<ReportedSighting> MakeSightings(std::int64_t object, int first, int end, const Box& box = kBox) {
  std::vector<ReportedSighting> sightings;
  for (int frame = first; frame < end; ++frame) sightings.push_back(MakeSighting(object, frame, box));
  return sightings;
}

std::vector<ReportedObject> ReportedObjects(const std::vector<std::int64_t>& ids) {
  std::vector<ReportedObject> objects;
  for (const std::int64_t id : ids) objects.push_back({.id = id});
  return objects;
}

template <typename T>
std::vector<T> operator+(std::vector<T> a, const std::vector<T>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(ScoreTest, PerfectIndexScoresOne) {
  const Score score = ScoreIndex(MakeTruthRows(20), ReportedObjects({7}), MakeSightings(7, 0, 20));
  EXPECT_EQ(score.findable, 1);
  EXPECT_EQ(score.found, 1);
  EXPECT_EQ(score.false_objects, 0);
  for (const auto& ratio : {score.recall, score.precision, score.average_precision, score.sighting_recall,
                            score.sighting_precision, score.density_p50, score.ids_per_object}) {
    EXPECT_THAT(ratio, Optional(DoubleEq(1.0)));
  }
  EXPECT_TRUE(score.per_object.at("a").found);
}

TEST(ScoreTest, EmptyTruthAndReportIsUnknown) {
  const Score score = ScoreIndex({}, {}, {});
  EXPECT_EQ(score.findable, 0);
  for (const auto& ratio :
       {score.recall, score.precision, score.average_precision, score.sighting_recall, score.sighting_precision,
        score.density_p25, score.ids_per_object, score.view_error_p50_rad}) {
    EXPECT_FALSE(ratio);
  }
}

TEST(ScoreTest, EmptyReportHasZeroRecall) {
  const Score score = ScoreIndex(MakeTruthRows(10), {}, {});
  EXPECT_THAT(score.recall, Optional(0.0));
  EXPECT_FALSE(score.precision);
  EXPECT_THAT(score.average_precision, Optional(0.0));
  EXPECT_THAT(score.sighting_recall, Optional(0.0));
  EXPECT_THAT(score.density_p50, Optional(0.0));
  EXPECT_FALSE(score.ids_per_object);
  EXPECT_FALSE(score.per_object.at("a").found);
}

TEST(ScoreTest, FindableRequiresTenHalfVisibleRows24PixelsHigh) {
  const auto findable = [](std::vector<TruthRow> rows) { return ScoreIndex(rows, {}, {}).findable; };
  EXPECT_EQ(findable(MakeTruthRows(9)), 0);
  EXPECT_EQ(findable(MakeTruthRows(10)), 1);
  EXPECT_EQ(findable(MakeTruthRows(10, "a", {0, 0, 90, 24})), 1);
  EXPECT_EQ(findable(MakeTruthRows(10, "a", {0, 0, 90, 23.9})), 0);
  auto hidden = MakeTruthRows(10);
  hidden[3].visible = 0.5;
  EXPECT_EQ(findable(hidden), 1);
  hidden[3].visible = 0.49;
  EXPECT_EQ(findable(hidden), 0);
}

TEST(ScoreTest, SightingIsCorrectFromIouOfFourTenths) {
  const auto precision = [](const Box& box) {
    return ScoreIndex(MakeTruthRows(10), {}, std::vector<ReportedSighting>{MakeSighting(1, 0, box)}).sighting_precision;
  };
  EXPECT_THAT(precision({100, 100, 40, 16}), Optional(1.0));  // 640 of 1600: exactly 0.4
  EXPECT_THAT(precision({100, 100, 40, 15.9}), Optional(0.0));
}

TEST(ScoreTest, SightingOfAnotherModelOrFrameIsFalse) {
  auto sightings = MakeSightings(1, 0, 2);
  sightings[1].model = "other";
  sightings.push_back(MakeSighting(1, 10));
  EXPECT_THAT(ScoreIndex(MakeTruthRows(10), {}, sightings).sighting_precision, Optional(DoubleEq(1.0 / 3)));
}

TEST(ScoreTest, OfSeveralSightingsOfOneObjectTheBestScoredIsCorrect) {
  auto truth = MakeTruthRows(10);
  truth[0].view = ViewDirection{0, 0};
  auto better = MakeSighting(2, 0, kBox, 0.9);
  better.view = ViewDirection{0, 0.3};
  auto worse = MakeSighting(1, 0, kBox, 0.8);
  worse.view = ViewDirection{0, 0.7};
  const Score score = ScoreIndex(truth, {}, std::vector<ReportedSighting>{worse, better});
  EXPECT_THAT(score.sighting_precision, Optional(0.5));
  EXPECT_NEAR(*score.view_error_p50_rad, 0.3, 1e-12);  // the sighting with the higher score is paired
}

TEST(ScoreTest, DensityBetweenSpansFirstToLastReport) {
  const Score score =
      ScoreIndex(MakeTruthRows(20), ReportedObjects({1}), MakeSightings(1, 5, 8) + MakeSightings(1, 10, 12));
  EXPECT_DOUBLE_EQ(score.per_object.at("a").density, 5.0 / 20);
  EXPECT_DOUBLE_EQ(score.per_object.at("a").density_between, 5.0 / 7);
}

TEST(ScoreTest, SightingIsMatchedToTheRowOfHighestIou) {
  const Box beside{110, 100, 40, 40};
  const auto truth = MakeTruthRows(10, "a") + MakeTruthRows(10, "b", beside);
  const Score score = ScoreIndex(truth, ReportedObjects({1}), MakeSightings(1, 0, 10, beside));
  EXPECT_FALSE(score.per_object.at("a").found);
  EXPECT_TRUE(score.per_object.at("b").found);
}

TEST(ScoreTest, SecondSightingIsMatchedToTheNextRow) {
  const Box beside{110, 100, 40, 40};  // both overlap each other by 0.6
  const std::vector<TruthRow> truth = {MakeTruthRow(0, "a"), MakeTruthRow(0, "b", beside)};
  EXPECT_THAT(
      ScoreIndex(truth, {}, std::vector<ReportedSighting>{MakeSighting(1, 0), MakeSighting(2, 0), MakeSighting(3, 0)})
          .sighting_precision,
      Optional(DoubleEq(2.0 / 3)));
}

TEST(ScoreTest, SightingOfUnclearRowIsIgnored) {
  const Box small{0, 0, 30, 20};
  const Score score = ScoreIndex(MakeTruthRows(10, "a", small), ReportedObjects({1}), MakeSightings(1, 0, 10, small));
  EXPECT_FALSE(score.sighting_precision);
  EXPECT_EQ(score.found, 0);
  EXPECT_EQ(score.false_objects, 0);  // a true object, but too small to be findable
  EXPECT_FALSE(score.precision);
}

TEST(ScoreTest, SecondObjectForTheSameTruthIsFalse) {
  const auto sightings = MakeSightings(1, 0, 10) + MakeSightings(2, 10, 20);
  const Score score = ScoreIndex(MakeTruthRows(20), ReportedObjects({2, 1}), sightings);
  EXPECT_EQ(score.found, 1);
  EXPECT_EQ(score.false_objects, 1);
  EXPECT_THAT(score.precision, Optional(0.5));
  EXPECT_THAT(score.sighting_precision, Optional(1.0));
  EXPECT_THAT(score.sighting_recall, Optional(1.0));  // counts the sightings of any object
  EXPECT_THAT(score.density_p50, Optional(0.5));      // counts the assigned object's only
  EXPECT_THAT(score.ids_per_object, Optional(2.0));
}

TEST(ScoreTest, SecondObjectForTooSmallTruthIsFalse) {
  const Box small{0, 0, 20, 20};
  const auto sightings = MakeSightings(1, 0, 5, small) + MakeSightings(2, 5, 10, small);
  const Score score = ScoreIndex(MakeTruthRows(10, "a", small), ReportedObjects({1, 2}), sightings);
  EXPECT_EQ(score.found, 0);
  EXPECT_EQ(score.false_objects, 1);
}

TEST(ScoreTest, ObjectMatchRequiresMajorityOfSightings) {
  const Box away{300, 300, 40, 40};
  const auto half = MakeSightings(1, 0, 5) + MakeSightings(1, 0, 5, away);
  EXPECT_EQ(ScoreIndex(MakeTruthRows(10), ReportedObjects({1}), half).found, 0);
  EXPECT_EQ(ScoreIndex(MakeTruthRows(10), ReportedObjects({1}), half).false_objects, 1);
  const auto most = MakeSightings(1, 0, 6) + MakeSightings(1, 0, 5, away);
  EXPECT_EQ(ScoreIndex(MakeTruthRows(10), ReportedObjects({1}), most).found, 1);
}

TEST(ScoreTest, ObjectWithoutSightingsIsFalse) {
  EXPECT_EQ(ScoreIndex(MakeTruthRows(10), ReportedObjects({5}), MakeSightings(1, 0, 10)).false_objects, 1);
}

TEST(ScoreTest, DensityCountsClearRowsOnly) {
  auto truth = MakeTruthRows(20);
  for (int frame = 10; frame < 20; ++frame) truth[frame].visible = 0.3;
  const Score score = ScoreIndex(truth, ReportedObjects({1}), MakeSightings(1, 5, 20));
  EXPECT_THAT(score.density_p50, Optional(0.5));
  EXPECT_THAT(score.sighting_recall, Optional(0.5));
  EXPECT_THAT(score.sighting_precision, Optional(1.0));
}

TEST(ScoreTest, PercentilesAreInterpolated) {
  const Box b{200, 100, 40, 40};
  const Box c{300, 100, 40, 40};
  const auto truth = MakeTruthRows(10, "a") + MakeTruthRows(10, "b", b) + MakeTruthRows(10, "c", c);
  const auto sightings = MakeSightings(1, 0, 2) + MakeSightings(2, 0, 4, b) + MakeSightings(3, 0, 10, c);
  const Score score = ScoreIndex(truth, ReportedObjects({1, 2, 3}), sightings);
  EXPECT_THAT(score.density_p25, Optional(DoubleEq(0.3)));
  EXPECT_THAT(score.density_p50, Optional(DoubleEq(0.4)));
  EXPECT_THAT(score.density_p75, Optional(DoubleEq(0.7)));
}

TEST(ScoreTest, IdsPerObjectExcludesNeverVisibleObjects) {
  const Box b{200, 100, 40, 40};
  const auto sightings = MakeSightings(1, 0, 3) + MakeSightings(2, 3, 6) + MakeSightings(3, 6, 9);
  const Score score = ScoreIndex(MakeTruthRows(10) + MakeTruthRows(10, "b", b), ReportedObjects({1, 2, 3}), sightings);
  EXPECT_THAT(score.ids_per_object, Optional(3.0));
  EXPECT_EQ(score.per_object.at("a").ids, 3);
  EXPECT_EQ(score.per_object.at("b").ids, 0);
}

TEST(ScoreTest, AveragePrecisionFollowsTheRanking) {
  const Box b{200, 100, 40, 40};
  const Box nowhere{500, 500, 40, 40};
  const auto truth = MakeTruthRows(10) + MakeTruthRows(10, "b", b);
  const auto sightings = MakeSightings(1, 0, 10) + MakeSightings(2, 0, 10, b) + MakeSightings(9, 0, 10, nowhere);
  const auto ap = [&](const std::vector<std::int64_t>& ranked) {
    return ScoreIndex(truth, ReportedObjects(ranked), sightings).average_precision;
  };
  EXPECT_THAT(ap({1, 2, 9}), Optional(DoubleNear(1.0, 1e-12)));
  // Recall 0 to 0.5 at precision 1 (51 levels), beyond it 2/3 (50 levels).
  EXPECT_THAT(ap({1, 9, 2}), Optional(DoubleNear((51 + 50 * 2.0 / 3) / 101, 1e-12)));
  EXPECT_THAT(ap({9, 1, 2}), Optional(DoubleNear(2.0 / 3, 1e-12)));  // the best precision at that recall or more
  EXPECT_THAT(ap({1}), Optional(DoubleNear(51.0 / 101, 1e-12)));
}

TEST(ScoreTest, ViewErrorsAreAnglesOnTheSphere) {
  auto truth = MakeTruthRows(10);
  auto sightings = MakeSightings(1, 0, 3);
  truth[0].view = ViewDirection{0, kPi / 2};
  sightings[0].view = ViewDirection{kPi / 2, kPi / 2};  // a quarter turn at the horizon
  truth[1].view = ViewDirection{0, 0};
  sightings[1].view = ViewDirection{2, 0};  // straight above, azimuth has no meaning
  sightings[2].view = ViewDirection{0, 0};  // no truth to compare with
  const Score score = ScoreIndex(truth, {}, sightings);
  EXPECT_NEAR(*score.view_error_p50_rad, kPi / 4, 1e-9);
  EXPECT_NEAR(*score.view_error_p90_rad, 0.9 * kPi / 2, 1e-9);
  EXPECT_NEAR(ToJson(score)["view_error_p50_deg"], 45.0, 1e-6);
}

TEST(ScoreTest, ReportKeysAreInOrder) {
  const Score score = ScoreIndex(MakeTruthRows(16), ReportedObjects({1}), MakeSightings(1, 0, 1));
  const nlohmann::ordered_json json = ToJson(score);
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  EXPECT_THAT(keys, ElementsAreArray({"findable",
                                      "found",
                                      "false_objects",
                                      "recall",
                                      "precision",
                                      "average_precision",
                                      "sighting_recall",
                                      "sighting_precision",
                                      "density_p25",
                                      "density_p50",
                                      "density_p75",
                                      "ids_per_object",
                                      "located",
                                      "cep50_m",
                                      "cep75_m",
                                      "cep90_m",
                                      "error3d_p50_m",
                                      "inside_90_ellipsoid",
                                      "inside_ce90",
                                      "heading_error_p50_deg",
                                      "view_error_p50_deg",
                                      "view_error_p90_deg",
                                      "per_object"}));
  EXPECT_EQ(json["located"], 0);
  EXPECT_TRUE(json["cep50_m"].is_null());
  EXPECT_EQ(json["per_object"]["a"].dump(), R"({"found":true,"density":0.062,"ids":1,"error_m":null})");
  EXPECT_THAT(ToText(score), HasSubstr("recall                     1.0000\n"));
  EXPECT_THAT(ToText(score), HasSubstr("cep50_m                         -\n"));
}

/// A random flight and index with all kinds of errors: misses, false positives, duplicates, splits, jitter, small and
/// occluded objects.
struct RandomCase {
  std::vector<TruthRow> truth;
  std::vector<ReportedObject> objects;
  std::vector<ReportedSighting> sightings;

  explicit RandomCase(std::uint64_t seed) {
    Random random(seed);
    const int frames = 5 + static_cast<int>(random.Below(40));
    const int count = static_cast<int>(random.Below(6));
    for (int k = 0; k < count; ++k) {
      const std::string object = fmt::format("object \"{}\" \u00e9", random.Below(9));
      const std::string model = fmt::format("m{}", random.Below(2));
      const double side = random.Uniform(18, 60);
      const double x = random.Uniform(0, 200);
      const double step = random.Uniform(-3, 3);
      const double quality = random.Uniform(0, 1);
      for (int frame = 0; frame < frames; ++frame) {
        TruthRow row{frame, object, model, {x + frame * step, 50, side, side * 1.2}, random.Uniform(0.3, 1.3), {}};
        if (random.Uniform() < 0.7) row.view = ViewDirection{random.Uniform(-3, 3), random.Uniform(0, 1.5)};
        truth.push_back(row);
        for (int repeat = 0; repeat < 2; ++repeat) {
          if (random.Uniform() > quality) continue;
          const Box box{row.box.x + random.Normal() * 4, 50 + random.Normal() * 4, side, side};
          const auto id = static_cast<std::int64_t>(10 * k + random.Below(2 + frame / 20));
          ReportedSighting sighting{id, frame, random.Uniform() < 0.95 ? model : "m9", box, random.Below(20) / 20.0,
                                    {}};
          if (random.Uniform() < 0.7) sighting.view = ViewDirection{random.Uniform(-3, 3), random.Uniform(0, 1.5)};
          sightings.push_back(sighting);
        }
      }
    }
    for (std::int64_t id = 0; id < 10 * count; ++id) {
      if (random.Uniform() < 0.5) objects.insert(objects.begin() + random.Below(objects.size() + 1), {.id = id});
    }
    PutPlaces(random);
  }

  // Places objects around a point, and reports them within some metres of it.
  void PutPlaces(Random& random) {
    const GeodeticPoint middle{-0.6, 2.6, 40};
    const TangentPlane plane(middle);
    const auto within = [&](double metres) {
      return plane.GeodeticFromEnu({metres * random.Normal(), metres * random.Normal(), metres * random.Normal()});
    };
    for (TruthRow& row : truth) {
      row.time_s = static_cast<double>(row.frame) / 10;
      row.place = within(1);
      row.heading_rad = random.Uniform(0, 2 * kPi);
    }
    for (ReportedObject& object : objects) {
      if (random.Uniform() < 0.7) object.heading_rad = random.Uniform(0, 2 * kPi);
      if (random.Uniform() < 0.2) continue;
      Geolocation place{.point = within(1), .time_s = random.Uniform(0, 5), .ce90_m = random.Uniform(0, 6)};
      Eigen::Matrix3d root;
      for (double& number : root.reshaped()) number = random.Normal();
      place.covariance_enu_m2 = root * root.transpose();
      object.place = place;
    }
  }

  void Write(const std::filesystem::path& folder) const {
    const auto box = [](const Box& b) { return nlohmann::json{b.x, b.y, b.width, b.height}; };
    const auto view = [](const std::optional<ViewDirection>& v) {
      return v ? nlohmann::json{{"azimuth_deg", DegreesFromRadians(v->azimuth_rad)},
                                {"off_nadir_deg", DegreesFromRadians(v->off_nadir_rad)}}
               : nlohmann::json();
    };
    std::ofstream truth_file(folder / "truth.jsonl");
    for (const TruthRow& row : truth) {
      truth_file << nlohmann::json{{"frame", row.frame},
                                   {"time_s", row.frame / 10.0},
                                   {"object", row.object},
                                   {"model", row.model},
                                   {"box", box(row.box)},
                                   {"visible", row.visible},
                                   {"view", view(row.view)},
                                   {"heading_deg", DegreesFromRadians(*row.heading_rad)},
                                   {"latitude_deg", DegreesFromRadians(row.place->latitude_rad)},
                                   {"longitude_deg", DegreesFromRadians(row.place->longitude_rad)},
                                   {"altitude_m", row.place->altitude_m}}
                 << "\n";
    }
    std::ofstream objects_file(folder / "objects.jsonl");
    for (const ReportedObject& object : objects) {
      nlohmann::json line{{"object_id", object.id}, {"model", "m"}, {"latitude_deg", nullptr}};
      if (object.heading_rad) line["heading_deg"] = DegreesFromRadians(*object.heading_rad);
      if (object.place) {
        line["place_time_s"] = object.place->time_s;
        line["latitude_deg"] = DegreesFromRadians(object.place->point.latitude_rad);
        line["longitude_deg"] = DegreesFromRadians(object.place->point.longitude_rad);
        line["altitude_m"] = object.place->point.altitude_m;
        line["ce90_m"] = object.place->ce90_m;
        line["covariance_enu_m2"] = nlohmann::json::array();
        for (const auto& row : object.place->covariance_enu_m2.rowwise()) {
          line["covariance_enu_m2"].push_back({row.x(), row.y(), row.z()});
        }
      }
      objects_file << line << "\n";
    }
    std::ofstream sightings_file(folder / "sightings.jsonl");
    for (const ReportedSighting& s : sightings) {
      sightings_file << nlohmann::json{{"object_id", s.object}, {"frame", s.frame}, {"model", s.model},
                                       {"box", box(s.box)},     {"score", s.score}, {"video", "a.mp4"},
                                       {"view", view(s.view)}}
                     << "\n";
    }
  }
};

void ExpectSame(const nlohmann::json& ours, const nlohmann::json& theirs, const std::string& where) {
  if (theirs.is_object()) {
    ASSERT_EQ(ours.size(), theirs.size()) << where;
    for (const auto& [key, value] : theirs.items()) {
      ASSERT_TRUE(ours.contains(key)) << where << key;
      ExpectSame(ours[key], value, where + key + " ");
    }
  } else if (theirs.is_number_float()) {
    ASSERT_TRUE(ours.is_number()) << where;
    EXPECT_NEAR(ours.get<double>(), theirs.get<double>(), 1e-6) << where;
  } else {
    EXPECT_EQ(ours, theirs) << where;
  }
}

TEST(ScoreTest, AgreesWithTheAcceptanceScorerOnRandomInput) {
  VICTORIOUS_DATA_OR_SKIP(scorer, "../tools/score.py");
  if (std::system("python3 -c pass 2>/dev/null") != 0) GTEST_SKIP() << "SKIPPED: no python3";
  const testing::ScratchFolder folder;
  const std::filesystem::path result = folder / "score.json";
  const std::string command =
      fmt::format("python3 '{}' --truth '{}' --objects '{}' --sightings '{}' --json > '{}'", scorer.string(),
                  (folder / "truth.jsonl").string(), (folder / "objects.jsonl").string(),
                  (folder / "sightings.jsonl").string(), result.string());
  int found = 0;
  int located = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RandomCase input(seed);
    input.Write(folder.path());
    ASSERT_EQ(std::system(command.c_str()), 0) << "seed " << seed;
    std::ifstream file(result);
    const auto truth = ReadTruth(folder / "truth.jsonl");
    ASSERT_TRUE(truth) << truth.error().message;
    const Score score = ScoreIndex(*truth, input.objects, input.sightings);
    ExpectSame(ToJson(score), nlohmann::json::parse(file), fmt::format("seed {}: ", seed));
    found += score.found;
    located += score.located;
  }
  EXPECT_GT(found, 8);  // the cases are not all empty
  EXPECT_GT(located, 4);
}

TEST(ScoreTest, ScoresAMillionSightings) {
  std::vector<TruthRow> truth;
  std::vector<ReportedSighting> sightings;
  std::vector<ReportedObject> objects;
  constexpr int kFrames = 20000;
  constexpr int kObjects = 10;
  for (int k = 0; k < kObjects; ++k) {
    const Box box{100.0 * k, 0, 50, 50};
    truth = std::move(truth) + MakeTruthRows(kFrames, std::to_string(k), box);
    for (int part = 0; part < 5; ++part) {
      objects.push_back({.id = 5 * k + part});
      sightings = std::move(sightings) + MakeSightings(5 * k + part, 0, kFrames, box);
    }
  }
  ASSERT_EQ(sightings.size(), 1000000U);
  const Score score = ScoreIndex(truth, objects, sightings);
  EXPECT_EQ(score.found, kObjects);
  EXPECT_THAT(score.sighting_precision, Optional(DoubleEq(0.2)));
}

}  // namespace
}  // namespace victorious
