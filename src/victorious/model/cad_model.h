// A CAD model in, an ObjectModel out: rendered from all sides on the sphere of views, each rendering a view with
// features that know their place on the object (thesis, section 3.5.1: templates at 10 degrees before a plain
// background).
#pragma once

#include <functional>
#include <string>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/render/mesh.h"
#include "victorious/render/renderer.h"
#include "victorious/render/view_sphere.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct CadModelOptions {
  FeatureOptions features = FaintFeatures();
  ViewSphereOptions sphere;
  Light light;
  RenderOptions render;
  double pixels_per_m = 22.0;
  int least_size_px = 180;
  int most_size_px = 400;
  double distance_radii = 12.0;
  double least_mask_share = 0.3;
  int least_features = 4;

  void ListFields(FieldList& fields);
};

/// How large the object's bounding sphere is drawn, px across.
[[nodiscard]] int ObjectSizePx(double diameter_m, const CadModelOptions& options);

/// @param mesh      in the model frame, metres
/// @param source    the CAD file's path as given
/// @param progress  told the number of views done, of all
/// Views with fewer features than options.least_features are kept without features: nothing is found by them.
/// Errors: kInvalidArgument for options out of range or a model none of whose views has enough features; kInternal
/// where nothing can render.
Expected<ObjectModel> MakeCadModel(const std::string& name, const Mesh& mesh, const std::string& source,
                                   const CadModelOptions& options, const std::function<void(int, int)>& progress = {});

}  // namespace victorious
