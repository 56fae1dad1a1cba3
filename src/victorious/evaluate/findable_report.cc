// Formats the result of MeasureDetectability() as JSON and as text with advice.
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/evaluate/findable.h"

namespace victorious {
namespace {

constexpr double kMost = 0.9;

nlohmann::ordered_json OrNull(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

nlohmann::ordered_json ShareOrNull(const std::optional<FoundShare>& share) {
  return share ? nlohmann::ordered_json(share->Share()) : nlohmann::ordered_json();
}

// The fraction of the detections with a correct view; std::nullopt without detections.
std::optional<double> RightView(const FoundShare& share) {
  if (share.found == 0) return std::nullopt;
  return static_cast<double>(share.right_view) / share.found;
}

nlohmann::ordered_json ToJson(const FoundShare& share, const LeastSizes& least) {
  return {{"directions", share.asked},
          {"found", share.Share()},
          {"right_view", OrNull(RightView(share))},
          {"half_found_from_px", OrNull(least.half_px)},
          {"nine_tenths_found_from_px", OrNull(least.most_px)}};
}

std::string SizeText(const std::optional<double>& size_px) { return size_px ? fmt::format("{:g} px", *size_px) : "-"; }

std::string Row(const std::string& name, const FoundShare& share, const LeastSizes& least,
                const std::string& features) {
  const std::optional<double> right = RightView(share);
  return fmt::format("    {:<14} {:>4} of {:<4} {:>10} {:>10} {:>10} {:>9}\n", name, share.found, share.asked,
                     right ? fmt::format("{:.2f}", *right) : "-", SizeText(least.half_px), SizeText(least.most_px),
                     features);
}

std::string SettingText(const FindableOptions& options) {
  return fmt::format("{:g} px, {}, {}, camera attitude {}", options.size_px,
                     options.sun_deg ? fmt::format("sun elevation {:g} degrees", *options.sun_deg) : "diffuse light",
                     options.noise > 0 ? fmt::format("noise {:g}", options.noise) : "no noise",
                     options.attitude_known ? "known" : "unknown");
}

std::string BandText(const FindableBand& band, double largest_px) {
  const std::string where = fmt::format("{:.0f} to {:.0f} degrees off nadir", band.least_deg, band.most_deg);
  if (band.least.most_px)
    return fmt::format("At {}, 90 % are detected from {:g} px.", where, *band.least.most_px);
  const std::string why =
      fmt::format("The model has {:.0f} features per view there: {}", band.features,
                  "add texture, or use larger templates (`model add --params`, least_size_px)");
  if (band.least.half_px) {
    return fmt::format("At {}, 50 % are detected from {:g} px, and 90 % at no size up to {:g} px. {}.", where,
                       *band.least.half_px, largest_px, why);
  }
  return fmt::format("At {}, fewer than 50 % are detected at all sizes up to {:g} px. {}.", where, largest_px, why);
}

std::vector<std::string> Advice(const Findable& findable) {
  std::vector<std::string> advice;
  for (const FindableBand& band : findable.bands) advice.push_back(BandText(band, findable.largest_px));
  const auto would = [&](const std::optional<FoundShare>& share, const char* how) {
    if (!share || share->found <= findable.share.found) return;
    advice.push_back(fmt::format("{0}, the detected fraction at {3:g} px rises from {2:.2f} to {1:.2f}.", how,
                                 share->Share(), findable.share.Share(), findable.options.size_px));
  };
  would(findable.quiet, "Without the noise");
  would(findable.soft, "In diffuse light");
  would(findable.upright, "With the camera's attitude from telemetry");
  if (findable.share.Share() < kMost && findable.least.most_px && *findable.least.most_px > findable.options.size_px) {
    advice.push_back(fmt::format("From nearer, or with a longer focal length: 90 % are detected from {:g} px.",
                                 *findable.least.most_px));
  }
  const std::optional<double> right = RightView(findable.share);
  if (right && *right < kMost) {
    advice.push_back(
        fmt::format("The view, and with it the heading, is within 10 degrees for a fraction {:.2f} of the detections: "
                    "the object's sides look similar, or lack detail at this size.",
                    *right));
  }
  return advice;
}

}  // namespace

nlohmann::ordered_json ToJson(const Findable& findable) {
  const FindableOptions& options = findable.options;
  nlohmann::ordered_json json = {{"size_px", options.size_px},
                                 {"noise", options.noise},
                                 {"sun_deg", OrNull(options.sun_deg)},
                                 {"attitude_known", options.attitude_known},
                                 {"seed", options.seed},
                                 {"largest_px", findable.largest_px}};
  json.update(ToJson(findable.share, findable.least));
  json["found_without_noise"] = ShareOrNull(findable.quiet);
  json["found_in_soft_light"] = ShareOrNull(findable.soft);
  json["found_with_attitude"] = ShareOrNull(findable.upright);
  json["bands"] = nlohmann::ordered_json::array();
  for (const FindableBand& band : findable.bands) {
    nlohmann::ordered_json row = {{"off_nadir_deg", {band.least_deg, band.most_deg}}, {"features", band.features}};
    row.update(ToJson(band.share, band.least));
    json["bands"].push_back(std::move(row));
  }
  json["advice"] = Advice(findable);
  return json;
}

std::string ToText(const Findable& findable) {
  std::string text = fmt::format(
      "  findable  at {}; {} directions between the model's views\n    {:<14} {:>12} {:>10} {:>10} {:>10} {:>9}\n",
      SettingText(findable.options), findable.share.asked, "off nadir", "found", "right view", "50 % from", "90 % from",
      "features");
  for (const FindableBand& band : findable.bands) {
    text += Row(fmt::format("{:.0f} to {:.0f} deg", band.least_deg, band.most_deg), band.share, band.least,
                fmt::format("{:.0f}", band.features));
  }
  if (findable.bands.size() > 1) text += Row("all", findable.share, findable.least, "");
  for (const std::string& line : Advice(findable)) text += fmt::format("    {}\n", line);
  text +=
      "    An upper limit: a flight detects less, as object, light and ground differ from the model's renderings.\n";
  return text;
}

}  // namespace victorious
