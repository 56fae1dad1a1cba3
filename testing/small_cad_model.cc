#include "testing/small_cad_model.h"

#include <gtest/gtest.h>

#include "testing/cad_tools.h"
#include "victorious/base/random.h"
#include "victorious/object/model/cad_model.h"

namespace victorious::testing {
namespace {

Mesh Slab() {
  Mesh mesh = Box({-2, -1.5F, -0.3F}, {2, 1.5F, 0});
  Random random(7);
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3f at(static_cast<float>(random.Uniform(-2, 1.7)), static_cast<float>(random.Uniform(-1.5, 1.2)),
                             0);
    const double width_m = random.Uniform(0.1, 0.4);
    const double depth_m = random.Uniform(0.1, 0.4);
    const double height_m = random.Uniform(0.1, 0.5);
    const Eigen::Vector3f size(static_cast<float>(width_m), static_cast<float>(depth_m), static_cast<float>(height_m));
    Append(Box(at, at + size), mesh);
  }
  return mesh;
}

}  // namespace

ObjectModel MakeSmallCadModel(const ViewSphereOptions& sphere) {
  CadModelOptions options;
  options.sphere = sphere;
  auto made = MakeCadModel("slab", Slab(), "slab.glb", options);
  EXPECT_TRUE(made) << made.error().message;
  return made.value_or(ObjectModel{});
}

const ObjectModel& SmallCadModel() {
  static const ObjectModel model = MakeSmallCadModel({.step_deg = 30, .max_off_nadir_deg = 60});
  return model;
}

}  // namespace victorious::testing
