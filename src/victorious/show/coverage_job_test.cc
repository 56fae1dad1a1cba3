#include "victorious/show/coverage_job.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/small_cad_model.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/object/model/model_library.h"

namespace victorious {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A camera that looks straight down from 100 m and flies 10 m/s to the north for 8 s.
class CoverageJobTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const ObjectModel model = testing::SmallCadModel();
    name_ = model.name;
    ASSERT_TRUE(ModelLibrary(folder_ / "models").Add(model));
    store_ = OpenSqliteStore(folder_ / "index.db", StoreMode::kCreate).value();
    model_ = store_->PutModel({.name = name_, .content_id = model.id, .kind = ModelKind::kCad})->id;
    std::string rows = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n";
    for (int i = 0; i <= 16; ++i) rows += fmt::format("{},{:.8f},11,150,0,-90,0,33.4\n", 0.5 * i, 48 + 4.5e-5 * i);
    ASSERT_TRUE(WriteFileAtomically(folder_ / "telemetry.csv", std::string_view(rows)));
    request_.models = folder_ / "models";
    request_.ground = std::make_shared<FlatGround>(50);
    request_.warn = [this](const std::string& line) { warnings_.push_back(line); };
  }

  // @param to_s  the end of the search
  void AddVideo(const std::string& telemetry, double to_s) {
    const VideoRecord video = store_
                                  ->PutVideo({.content_id = "c" + telemetry,
                                              .name = folder_ / (telemetry.empty() ? "other.mp4" : "video.mp4"),
                                              .width = 600,
                                              .height = 400,
                                              .telemetry = telemetry})
                                  .value();
    IndexBatch batch;
    const auto frames = static_cast<std::int64_t>(to_s * 10);
    batch.progress.push_back(
        {{.video = video.id, .model = model_, .next_frame = frames, .finished = true, .options_json = "{}"}, 0});
    batch.parts.push_back({.video = video.id, .model = model_, .from_frame = 0, .to_frame = frames, .to_s = to_s});
    ASSERT_TRUE(store_->Commit(batch));
  }

  Expected<GroundCoverage> Cover() { return CoverIndex(*store_, {}, request_, CancelToken()); }

  testing::ScratchFolder folder_;
  std::unique_ptr<IndexStore> store_;
  std::string name_;
  std::int64_t model_ = 0;
  CoverageRequest request_;
  std::vector<std::string> warnings_;
};

TEST_F(CoverageJobTest, CoversTheStripThatWasSearched) {
  AddVideo(folder_ / "telemetry.csv", 4);
  request_.options.cell_m = 2;
  const auto coverage = Cover();
  ASSERT_TRUE(coverage) << coverage.error().message;
  EXPECT_NEAR(coverage->rows * 2, 40 + 40, 5) << "a frame of 40 m, and 4 s of 10 m/s; not the 8 s of telemetry";
  EXPECT_NEAR(coverage->columns * 2, 60, 5);
  ASSERT_EQ(coverage->models.size(), 1);
  EXPECT_EQ(coverage->models[0].model, name_);
  EXPECT_GT(*std::ranges::max_element(coverage->models[0].probability), 0.3);
  EXPECT_EQ(*std::ranges::max_element(coverage->looks), 8) << "a frame of 40 m each 5 m";
}

TEST_F(CoverageJobTest, LooksFollowTheirInterval) {
  AddVideo(folder_ / "telemetry.csv", 4);
  request_.options.look_interval_s = 2;
  const auto coverage = Cover();
  ASSERT_TRUE(coverage) << coverage.error().message;
  EXPECT_EQ(*std::ranges::max_element(coverage->looks), 2) << "a frame of 40 m each 20 m";
}

TEST_F(CoverageJobTest, NeedsTelemetry) {
  AddVideo("", 4);
  const auto coverage = Cover();
  ASSERT_FALSE(coverage);
  EXPECT_EQ(coverage.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(coverage.error().message, HasSubstr("needs telemetry"));
  EXPECT_THAT(warnings_, IsEmpty()) << "one line says it";
  AddVideo(folder_ / "telemetry.csv", 4);
  EXPECT_TRUE(Cover()) << "the other video has it";
  EXPECT_THAT(warnings_, Contains(HasSubstr("needs telemetry")));
}

TEST_F(CoverageJobTest, NeedsTheHeightOfTheGround) {
  AddVideo(folder_ / "telemetry.csv", 4);
  request_.ground = nullptr;
  const auto coverage = Cover();
  ASSERT_FALSE(coverage);
  EXPECT_THAT(coverage.error().message, HasSubstr("--ground"));
}

TEST_F(CoverageJobTest, ModelsWithoutASizeAreNamed) {
  AddVideo(folder_ / "telemetry.csv", 4);
  ASSERT_TRUE(ModelLibrary(folder_ / "models").Remove(name_));
  const auto coverage = Cover();
  ASSERT_FALSE(coverage);
  EXPECT_THAT(coverage.error().message, HasSubstr(name_));
}

}  // namespace
}  // namespace victorious
