// Makes an ObjectModel from a CAD model: renders it from every direction of the view sphere; each rendering becomes a
// view (template) whose features have 3D points on the object (thesis, section 3.5.1: templates every 10 degrees before
// a plain background).
#pragma once

#include <functional>
#include <string>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/view_sphere.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/object/render/renderer.h"
#include "victorious/types/mesh.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// From the camera to the object's centre, in radii of its bounding sphere: far, so that perspective is weak.
inline constexpr double kTemplateDistanceRadii = 12.0;

struct CadModelOptions {
  FeatureOptions features = LowContrastFeatureOptions();
  ViewSphereOptions sphere;
  Light light;
  RenderOptions render;
  double pixels_per_m = 22.0;
  double min_mask_fraction = 0.3;
  int min_features = 4;
  // Not user parameters from here on: the tests vary them. The bounds of the diameter of the object's bounding sphere,
  // px: smaller ones have too few keypoints, larger ones cost time without finding more (docs/adr/0008).
  int min_size_px = 180;
  int max_size_px = 400;

  void ListFields(FieldList& fields);
};

/// Diameter of the object's bounding sphere in the renderings, px: diameter_m * pixels_per_m, clamped to
/// [min_size_px, max_size_px].
[[nodiscard]] int ObjectSizePx(double diameter_m, const CadModelOptions& options);

/// @param mesh      in the model frame, metres
/// @param source    path of the CAD file as given
/// @param progress  called with the number of finished views and the number of all views
/// @param cancel    asked before each view is rendered; null: it is made to the end
/// Views with fewer features than options.min_features are stored without features; a search cannot match them.
/// Errors: kInvalidArgument for options out of range, or if no view has enough features; kInternal if no device can
/// render; kCancelled.
[[nodiscard]] Expected<ObjectModel> MakeCadModel(const std::string& name, const Mesh& mesh, const std::string& source,
                                                 const CadModelOptions& options,
                                                 const std::function<void(int, int)>& progress = {},
                                                 const CancelToken* cancel = nullptr);

}  // namespace victorious
