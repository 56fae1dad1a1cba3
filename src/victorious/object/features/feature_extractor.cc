#include "victorious/object/features/feature_extractor.h"

#include "victorious/object/features/opencv_sift.h"
#include "victorious/object/features/sift.h"

namespace victorious {

void FeatureOptions::ListFields(FieldList& fields) {
  fields.Add(
      "engine", engine,
      {.choices = FeatureEngines(),
       .reason = "feature extractor; features of different engines cannot be matched, so a search for stored models "
                 "takes the engine of the models"});
  fields.Add(
      "contrast_threshold", contrast_threshold,
      {.min = 0,
       .max = 1,
       .reason = "minimum contrast of a keypoint, over all layers of an octave; lower finds more and fainter ones"});
  fields.Add(
      "edge_threshold", edge_threshold,
      {.min = 1,
       .max = 1000,
       .reason = "maximum ratio of principal curvatures; lower drops more keypoints that lie on edges (Lowe: 10)"});
  fields.Add(
      "max_side_px", max_side_px,
      {.min = 64,
       .max = 16384,
       .unit = "px",
       .reason = "larger images are reduced to this longest side before extraction, which bounds time and memory"});
  fields.Add(
      "impulse_fraction", impulse_fraction,
      {.min = 0,
       .max = 1,
       .reason = "salt-and-pepper noise is removed if it covers more than this fraction of an image's flat regions; 1: "
                 "never"});
}

FeatureOptions LowContrastFeatureOptions() {
  FeatureOptions options;
  options.contrast_threshold = 0.015;
  options.edge_threshold = 20;
  return options;
}

std::vector<std::string> FeatureEngines() { return {"sift", "opencv"}; }

Expected<std::unique_ptr<const FeatureExtractor>> MakeFeatureExtractor(const FeatureOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (options.engine == "sift") return MakeSift(options);
  return MakeOpenCvSift(options);
}

}  // namespace victorious
