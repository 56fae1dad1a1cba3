// victorious features IMAGE --out FILE [--json]
#include <chrono>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/json.h"
#include "victorious/input/image/image_file.h"
#include "victorious/object/features/feature_extractor.h"

namespace victorious::cli {
namespace {

struct FeaturesArguments {
  std::string image;
  std::string out;
  std::string engine;
  std::string params;
  bool json = false;
};

Status Run(const FeaturesArguments& arguments, const ArgumentParser& parser) {
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, {{"--out", arguments.out, FileKind::kFeatures}}));
  FeatureOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, options));
  if (!arguments.engine.empty()) options.engine = arguments.engine;
  VICTORIOUS_RETURN_IF_ERROR(CheckFlags(CollectFields(options), {{"engine", "--engine"}}));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options));
  VICTORIOUS_ASSIGN_OR_RETURN(const Image image, ReadImage(arguments.image));
  const auto start = std::chrono::steady_clock::now();
  VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet features, extractor->Extract(GreyFromBgr(image.bgr)));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "{} {}\n", features.size(), kDescriptorSize);
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Keypoint& keypoint = features.keypoints[i];
    fmt::format_to(std::back_inserter(text), "{:.4f} {:.4f} {:.4f} {:.5f}", keypoint.x, keypoint.y, keypoint.scale_px,
                   keypoint.orientation_rad);
    for (const std::uint8_t value : features.View().Descriptor(i))
      fmt::format_to(std::back_inserter(text), " {}", value);
    text.push_back('\n');
  }
  VICTORIOUS_RETURN_IF_ERROR(WriteOutput(arguments.out, {text.data(), text.size()}));
  if (!arguments.json) return {};
  const nlohmann::ordered_json line = {{"image", arguments.image},
                                       {"file", arguments.out},
                                       {"engine", options.engine},
                                       {"features", features.size()},
                                       {"seconds", took.count()}};
  return WriteOutput("", DumpJson(line) + "\n");
}

}  // namespace

Action SetUpFeatures(ArgumentParser& parser) {
  const auto arguments = std::make_shared<FeaturesArguments>();
  parser.Add("IMAGE", arguments->image, "An image (PNG, JPEG)").Required();
  parser
      .Add("--out", arguments->out,
           "Output file: `N 128`, then one line per feature: x y scale orientation_rad d1 … d128")
      .Required()
      .TypeName("FILE");
  parser.Add("--engine", arguments->engine, "The feature engine").TypeName("NAME");
  parser.Add("--params", arguments->params, "Parameters, JSON (`victorious params features` lists them)")
      .TypeName("FILE");
  parser.AddFlag("--json", arguments->json,
                 "Print one JSON object: the file, the number of features, the seconds that their extraction took");
  AddForce(parser);
  return [=] { return Run(*arguments, parser); };
}

}  // namespace victorious::cli
