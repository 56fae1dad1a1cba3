#include "victorious/jobs/model_engine.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

ObjectModel ModelOfEngine(const std::string& name, const std::string& engine) {
  ObjectModel model;
  model.name = name;
  model.engine = engine;
  return model;
}

struct Adopted {
  Status status;
  std::string engine;
  std::vector<std::string> warnings;
};

Adopted Adopt(const std::vector<ObjectModel>& models, const std::string& engine) {
  FeatureOptions features;
  features.engine = engine;
  Adopted adopted;
  adopted.status =
      AdoptEngineOfModels(models, features, [&](const std::string& line) { adopted.warnings.push_back(line); });
  adopted.engine = features.engine;
  return adopted;
}

TEST(ModelEngine, OfTheModelsIsAdoptedWithOneWarning) {
  const Adopted adopted = Adopt({ModelOfEngine("jeep", "opencv"), ModelOfEngine("tank", "opencv")}, "sift");
  EXPECT_TRUE(adopted.status);
  EXPECT_EQ(adopted.engine, "opencv");
  EXPECT_THAT(adopted.warnings, ElementsAre(AllOf(HasSubstr("opencv"), HasSubstr("sift"), Not(HasSubstr("\n")))));
}

TEST(ModelEngine, SameEngineOrNoModelsChangeNothing) {
  for (const std::vector<ObjectModel>& models : {std::vector<ObjectModel>{}, {ModelOfEngine("jeep", "sift")}}) {
    const Adopted adopted = Adopt(models, "sift");
    EXPECT_TRUE(adopted.status);
    EXPECT_EQ(adopted.engine, "sift");
    EXPECT_THAT(adopted.warnings, IsEmpty());
  }
}

TEST(ModelEngine, RefusesModelsOfDifferentEngines) {
  const Adopted adopted = Adopt({ModelOfEngine("jeep", "sift"), ModelOfEngine("tank", "opencv")}, "sift");
  ASSERT_FALSE(adopted.status);
  EXPECT_EQ(adopted.status.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(adopted.status.error().message,
              AllOf(HasSubstr("jeep of sift"), HasSubstr("tank of opencv"), Not(HasSubstr("\n"))));
}

}  // namespace
}  // namespace victorious
