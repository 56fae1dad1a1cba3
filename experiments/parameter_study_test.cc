#include "experiments/parameter_study.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/base/program_id.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST(StudySettings, VaryEachParameterDownAndUp) {
  const std::vector<StudySetting> settings = StudySettings();
  ASSERT_GE(VariedParameters().size(), 14U);
  ASSERT_EQ(settings.size(), 2 * VariedParameters().size() + 1);
  const std::string usual = OptionsToJsonText(TrackingIndexOptions());
  EXPECT_EQ(OptionsToJsonText(settings[0].options), usual);
  std::set<std::string> names;
  std::set<std::string> parts;
  for (const StudySetting& setting : settings) {
    EXPECT_TRUE(ValidateOptions(setting.options)) << setting.name;
    names.insert(setting.name);
    parts.insert(setting.of);
  }
  EXPECT_THAT(names, SizeIs(settings.size()));
  EXPECT_THAT(parts, ::testing::ElementsAre("", "association", "geolocation", "recogniser", "tracker"));
  for (std::size_t i = 1; i < settings.size(); ++i) {
    IndexOptions before = TrackingIndexOptions();
    IndexOptions now = settings[i].options;
    const auto fields_before = CollectFields(before);
    const auto fields_now = CollectFields(now);
    const char* const parameter = VariedParameters()[(i - 1) / 2].name;
    for (std::size_t f = 0; f < fields_before.size(); ++f) {
      if (fields_now[f].name != parameter) {
        EXPECT_EQ(ToJsonText({fields_before[f]}), ToJsonText({fields_now[f]})) << settings[i].name;
      } else if (const auto* const real = std::get_if<double*>(&fields_before[f].value)) {
        EXPECT_DOUBLE_EQ(*std::get<double*>(fields_now[f].value), **real * (i % 2 == 1 ? 0.75 : 1.25)) << parameter;
      } else {
        const int change = *std::get<int*>(fields_now[f].value) - *std::get<int*>(fields_before[f].value);
        EXPECT_TRUE(i % 2 == 1 ? change <= -1 : change >= 1) << parameter;
      }
    }
  }
}

TEST(SettingResult, SumsOverItsObjects) {
  const SettingResult setting{.name = "default",
                              .of = {},
                              .findable = 4,
                              .found = 3,
                              .false_objects = 1,
                              .objects = {{.movie = "m", .name = "a", .model = "jeep", .ids = 1},
                                          {.movie = "m", .name = "b", .model = "jeep", .ids = 2},
                                          {.movie = "m", .name = "c", .model = "jeep", .ids = 0}}};
  EXPECT_EQ(setting.Recall(), 0.75);
  EXPECT_EQ(setting.Precision(), 0.75);
  EXPECT_EQ(setting.IdsPerObject(), 1.5) << "of the visible ones";
  EXPECT_EQ(SettingResult{}.Recall(), 0);
}

// A single jeep on the ground, in 14 small frames, in place of whole flights.
class TinyFlight : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new testing::ScratchFolder;
    const fs::path assets = fs::path(VICTORIOUS_SCENES) / ".." / "assets";
    std::ofstream(*folder_ / "tiny.json") << fmt::format(
        R"({{"assets": "{}", "seed": 2,
             "video": {{"frames": 14, "fps": 10, "width": 320, "height": 240, "hfov_deg": 8}},
             "origin": {{"latitude_deg": 48, "longitude_deg": 11, "altitude_m": 500, "heading_deg": 20}},
             "camera": {{"aim_m": [[2, 22], [-2, 23]], "from_deg": [150, 165], "off_nadir_deg": 40, "range_m": 110}},
             "objects": [{{"id": "jeep-1", "model": "jeep", "x_m": 0, "y_m": 22, "heading_deg": 60}}]}})",
        fs::absolute(assets).string());
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  // The output folder is shared, so that later tests reuse its cache.
  ExperimentSettings Settings() {
    return {.data = {},
            .scenes = folder_->path(),
            .out = *folder_ / "out",
            .movies = {"tiny"},
            .progress = [this](std::string_view what) { progress_.emplace_back(what); }};
  }

  Report Run(const std::string& name) {
    Expected<Report> report = RunExperiment(name, Settings());
    EXPECT_TRUE(report.has_value()) << report.error().message;
    return report.value_or(Report{});
  }

  static double NumberAt(const Report& report, std::size_t row, std::string_view column) {
    const auto at = std::ranges::find(report.columns, column);
    EXPECT_NE(at, report.columns.end()) << column;
    return std::get<double>(report.rows.at(row).at(static_cast<std::size_t>(at - report.columns.begin())));
  }

  static testing::ScratchFolder* folder_;
  std::vector<std::string> progress_;
};

testing::ScratchFolder* TinyFlight::folder_ = nullptr;

TEST_F(TinyFlight, SettingsWithEqualSearchShareIt) {
  std::vector<StudySetting> wanted;
  for (const StudySetting& setting : StudySettings()) {
    if (setting.name == "default" || setting.name == "every = 4" || setting.of == "geolocation") {
      wanted.push_back(setting);
    }
  }
  auto movies = SimulateScenes({}, Settings());
  ASSERT_TRUE(movies.has_value()) << movies.error().message;
  const auto study = StudyMovies(*std::move(movies), wanted, Settings());
  ASSERT_TRUE(study.has_value()) << study.error().message;
  ASSERT_EQ(study->settings.size(), wanted.size());
  for (const SettingResult& setting : study->settings) {
    EXPECT_EQ(setting.findable, 1) << setting.name;
    EXPECT_EQ(setting.found, 1) << setting.name;
    EXPECT_EQ(setting.false_objects, 0) << setting.name;
    ASSERT_THAT(setting.objects, SizeIs(1));
    EXPECT_GE(setting.objects[0].density, 0.9) << setting.name;
    EXPECT_LE(setting.objects[0].density, setting.objects[0].density_between);
    ASSERT_TRUE(setting.objects[0].error_m.has_value());
    EXPECT_LT(*setting.objects[0].error_m, 0.5) << setting.name;
    if (setting.of == "geolocation") {
      EXPECT_EQ(setting.changed_sightings, 0) << setting.name;
    }
  }
  EXPECT_GT(study->settings[1].changed_sightings, 0) << "other frames were searched as a whole";
  const auto files = [&](const char* folder) {
    int count = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(*folder_ / "out" / folder)) {
      count += entry.path().extension() == ".db" || entry.path().filename() == "video.mp4" ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(files("indexes"), 2) << "the default is used after the search";
  EXPECT_EQ(files("flights"), 1);
}

TEST_F(TinyFlight, AnotherBuildSearchesAgain) {
  const auto movie = SimulateScene("tiny", Settings());
  ASSERT_TRUE(movie.has_value()) << movie.error().message;
  ExperimentSettings settings = Settings();
  settings.out = *folder_ / "builds";
  for (const auto& [program, indexes] : {std::pair("a", 1), std::pair("b", 2), std::pair("a", 2)}) {
    settings.program = program;
    EXPECT_TRUE(IndexMovie(*movie, TrackingIndexOptions(), settings).has_value());
    const fs::directory_iterator kept(settings.out / "indexes" / movie->folder.filename());
    EXPECT_EQ(std::ranges::count_if(kept, [](const auto& entry) { return entry.path().extension() == ".db"; }), indexes)
        << program;
  }
}

TEST(ExperimentSettings, CacheKeyDependsOnContentAndBuild) {
  ExperimentSettings settings{.data = {}, .scenes = {}, .out = {}};
  const std::string own = settings.CacheKey("x").value();
  EXPECT_EQ(settings.CacheKey("x").value(), own);
  EXPECT_NE(settings.CacheKey("y").value(), own);
  settings.program = ProgramId().value();
  EXPECT_EQ(settings.CacheKey("x").value(), own);
  settings.program = "0.0.1-0123456789abcdef";
  EXPECT_NE(settings.CacheKey("x").value(), own);
}

TEST_F(TinyFlight, FewerFramesSpanTheSameTime) {
  ExperimentSettings settings = Settings();
  settings.frames = 4;
  const auto few = SimulateScene("tiny", settings);
  const auto all = SimulateScene("tiny", Settings());
  ASSERT_TRUE(few.has_value() && all.has_value());
  EXPECT_EQ(few->truth.back().frame, 3);
  EXPECT_EQ(all->truth.back().frame, 13);
  EXPECT_NEAR(few->truth.back().time_s, all->truth.back().time_s, 1e-3);
}

TEST_F(TinyFlight, RegionCostsAFractionOfAFrame) {
  const Report report = Run("figure4.1");
  EXPECT_GT(NumberAt(report, 2, "pixels"), 2);
  EXPECT_GT(NumberAt(report, 2, "descriptors compared"), 20);
  EXPECT_THAT(report.notes[1], HasSubstr("it is found, its box overlapping"));
  EXPECT_TRUE(fs::exists(*folder_ / "out" / "figure4.1.png"));
}

TEST_F(TinyFlight, TimesOfTheStepsAddUpToTheTotal) {
  const Report report = Run("table5.1");
  const std::size_t total = report.rows.size() - 1;
  EXPECT_NEAR(NumberAt(report, total, "thesis"), 11.3253, 1e-4) << "as printed";
  for (const char* column : {"ours: votes", "ours: shortlist"}) {
    EXPECT_GT(NumberAt(report, 0, column), 0) << column;
    EXPECT_GT(NumberAt(report, total, column), NumberAt(report, 0, column) + 25 * NumberAt(report, 1, column));
  }
}

TEST_F(TinyFlight, RecognizerKeepsTheLock) {
  const Report report = Run("figure4.2");
  ASSERT_THAT(report.rows, SizeIs(1));
  EXPECT_GE(NumberAt(report, 0, "with recogniser: locked"), 0.9);
  EXPECT_TRUE(fs::exists(*folder_ / "out" / "figure4.2.png"));
}

TEST_F(TinyFlight, FrustumContainsTruthAndIntersectionShrinks) {
  const Report one = Run("figure4.3");
  ASSERT_THAT(one.rows, SizeIs(1));
  EXPECT_LT(NumberAt(one, 0, "truth to line, m"), 0.5);
  EXPECT_NEAR(NumberAt(one, 0, "range from size, m"), NumberAt(one, 0, "true distance, m"), 8);
  const Report many = Run("figure4.4");
  ASSERT_GE(many.rows.size(), 4U);
  for (std::size_t row = 1; row < many.rows.size(); ++row) {
    EXPECT_LT(NumberAt(many, row, "common volume, m3"), NumberAt(many, 0, "common volume, m3"));
    EXPECT_EQ(std::get<std::string>(many.rows[row][4]), "yes");
  }
}

TEST_F(TinyFlight, ObjectListSeparatesFullFrameAndRegionSightings) {
  const Report report = Run("figure4.5");
  ASSERT_THAT(report.rows, SizeIs(1));
  EXPECT_EQ(NumberAt(report, 0, "in whole-frame searches"), 3) << "frames 0, 5, 10";
  EXPECT_GE(NumberAt(report, 0, "in tracked region") + NumberAt(report, 0, "by the tracker alone"), 9);
}

TEST_F(TinyFlight, ErrorNamesUnknownScene) {
  ExperimentSettings settings = Settings();
  settings.movies = {"nowhere"};
  EXPECT_THAT(RunExperiment("figure5.2", settings).error().message, HasSubstr("nowhere.json"));
}

}  // namespace
}  // namespace victorious
