// victorious model show --findable: the detectability of a model
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/cmd_model.h"
#include "victorious/base/progress.h"
#include "victorious/base/text.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/image/montage.h"
#include "victorious/jobs/index/index_options.h"

namespace victorious::cli {

void AddDetectabilityFlags(ArgumentParser& parser, DetectabilityArguments& arguments) {
  const Argument wanted = parser.AddFlag(
      "--findable", arguments.wanted,
      "Measure the fraction of test images, rendered or made of the photos, in which the search finds the model");
  parser.Add("--size-px", arguments.options.size_px, "Longest side of its box in the image (default 64)")
      .Needs(wanted)
      .TypeName("PX");
  parser.Add("--noise", arguments.options.noise, "Fraction of salt-and-pepper pixels (default 0)")
      .Needs(wanted)
      .TypeName("FRACTION");
  parser.Add("--sun", arguments.sun, "Elevation of the sun in degrees, or off: diffuse light (default)")
      .Needs(wanted)
      .TypeName("DEG");
  parser.AddFlag("--no-attitude", arguments.no_attitude, "Search without the camera's attitude, as without telemetry")
      .Needs(wanted);
  parser
      .Add("--directions", arguments.options.directions,
           "Number of view directions: more take longer and estimate fractions more accurately (default 24)")
      .Needs(wanted)
      .TypeName("N");
  parser.Add("--seed", arguments.options.seed, "Seed of the random numbers (default 1)").Needs(wanted).TypeName("N");
  parser.Add("--draw", arguments.draw, "Draw the test images into this file: found green, missed red")
      .Needs(wanted)
      .TypeName("FILE");
  parser.Add("--params", arguments.params, "Parameters of the search, as for `index` (JSON)")
      .Needs(wanted)
      .TypeName("FILE");
}

Expected<Detectability> RunDetectabilityTest(const ObjectModel& model, const DetectabilityArguments& arguments) {
  IndexOptions search;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, search));
  DetectabilityOptions options = arguments.options;
  options.attitude_known = !arguments.no_attitude;
  if (arguments.sun != "off") {
    options.sun_deg = ParseNumber(arguments.sun);
    if (!options.sun_deg) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("--sun {}: must be an elevation of 5 to 90 degrees, or off", OneLine(arguments.sun)));
    }
  }
  VICTORIOUS_RETURN_IF_ERROR(CheckFlags(
      CollectFields(options),
      {{"size_px", "--size-px"}, {"noise", "--noise"}, {"sun_deg", "--sun"}, {"directions", "--directions"}}));
  std::optional<Progress> progress;
  std::vector<cv::Mat> images;
  DetectabilityCallbacks callbacks;
  callbacks.progress = [&](int done, int /*all*/) {
    if (!progress) progress.emplace(model.name, std::nullopt, "directions");
    progress->Update(done);
  };
  if (!arguments.draw.empty()) {
    callbacks.image = [&](const cv::Mat& bgr) {
      constexpr std::size_t kMaxImages = 24;
      if (images.size() < kMaxImages) images.push_back(bgr);
    };
  }
  Expected<Detectability> found =
      MeasureDetectability(model, search.features, search.recognize, options, Interrupt(), callbacks);
  if (found && !images.empty()) VICTORIOUS_RETURN_IF_ERROR(WriteImage(arguments.draw, Montage(images, 4)));
  return found;
}

}  // namespace victorious::cli
