// victorious model show --findable: the detectability of a model
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "victorious/base/progress.h"
#include "victorious/cli/arguments.h"
#include "victorious/cli/cmd_model.h"
#include "victorious/image/image_file.h"
#include "victorious/image/montage.h"
#include "victorious/pipeline/index_options.h"

namespace victorious::cli {

void AddDetectabilityFlags(CLI::App& app, DetectabilityArguments& arguments) {
  CLI::Option* wanted = app.add_flag(
      "--findable", arguments.wanted,
      "Measure the fraction of test images, rendered or made of the photos, in which the search finds the model");
  const auto add = [&](CLI::Option* option) {
    option->needs(wanted);
    return option;
  };
  add(app.add_option("--size-px", arguments.options.size_px, "Longest side of its box in the image (default 64)"))
      ->type_name("PX");
  add(app.add_option("--noise", arguments.options.noise, "Fraction of salt-and-pepper pixels (default 0)"))
      ->type_name("FRACTION");
  add(app.add_option("--sun", arguments.sun, "Elevation of the sun in degrees, or off: diffuse light (default)"))
      ->type_name("DEG");
  add(app.add_flag("--no-attitude", arguments.no_attitude,
                   "Search without the camera's attitude, as without telemetry"));
  add(app.add_option("--directions", arguments.options.directions,
                     "Number of view directions: more take longer and estimate fractions more accurately (default 24)"))
      ->type_name("N");
  add(app.add_option("--seed", arguments.options.seed, "Seed of the random numbers (default 1)"))->type_name("N");
  add(app.add_option("--draw", arguments.draw, "Draw the test images into this file: found green, missed red"))
      ->type_name("FILE");
  add(app.add_option("--params", arguments.params, "Parameters of the search, as for `index` (JSON)"))
      ->type_name("FILE");
}

Expected<Detectability> RunDetectabilityTest(const ObjectModel& model, const DetectabilityArguments& arguments) {
  IndexOptions search;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, search));
  DetectabilityOptions options = arguments.options;
  options.attitude_known = !arguments.no_attitude;
  VICTORIOUS_RETURN_IF_ERROR(CheckFlags(
      CollectFields(options), {{"size_px", "--size-px"}, {"noise", "--noise"}, {"directions", "--directions"}}));
  if (arguments.sun != "off") {
    double elevation_deg = 0;
    if (!CLI::detail::lexical_cast(arguments.sun, elevation_deg)) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("--sun {}: must be an elevation of 5 to 90 degrees, or off", OneLine(arguments.sun)));
    }
    options.sun_deg = elevation_deg;
  }
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
