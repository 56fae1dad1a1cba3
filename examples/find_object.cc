// find_object IMAGE MODELS: searches an image for every model of a folder that `victorious model add` wrote. Prints one
// line per detection, best first: model, score, and box in pixels.
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/error.h"
#include "victorious/input/image/image_file.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/object/model/model_library.h"
#include "victorious/search/recognize/recognizer.h"

namespace victorious {
namespace {

Status FindObjects(const std::string& image_file, const std::string& models_folder) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<ObjectModel> models, ModelLibrary(models_folder).LoadAll());
  if (models.empty()) return Fail(ErrorCode::kInvalidArgument, models_folder + ": holds no model: add one");
  FeatureOptions options = LowContrastFeatureOptions();
  options.engine = models.front().engine;  // descriptors of different engines are not comparable
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options));
  VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer, Recognizer::Create(std::move(models), options.engine, {}));

  VICTORIOUS_ASSIGN_OR_RETURN(const Image image, ReadImage(image_file));
  const cv::Mat grey = GreyFromBgr(image.bgr);
  VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet scene, extractor->Extract(grey));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Detection> detections, recognizer.Recognize(scene));
  for (const Detection& detection : detections) {
    const Box& box = detection.box;
    fmt::print("{} {:.3f} {:.0f},{:.0f},{:.0f},{:.0f}\n", recognizer.models()[detection.model_index].name,
               detection.score, box.x, box.y, box.width, box.height);
  }
  return {};
}

}  // namespace
}  // namespace victorious

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: find_object IMAGE MODELS\n");
    return 2;
  }
  if (const victorious::Status found = victorious::FindObjects(argv[1], argv[2]); !found) {
    fmt::print(stderr, "find_object: {}\n", found.error().message);
    return victorious::ExitStatus(found.error().code);
  }
  return 0;
}
