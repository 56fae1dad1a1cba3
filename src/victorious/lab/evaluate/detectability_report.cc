#include "victorious/lab/evaluate/detectability_report.h"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"

namespace victorious {
namespace {

constexpr double kHighRate = 0.9;

nlohmann::ordered_json RateOrNull(const std::optional<DetectionRate>& rate) {
  return rate ? nlohmann::ordered_json(rate->Fraction()) : nlohmann::ordered_json();
}

// The fraction of the detections with a correct view; std::nullopt without detections.
std::optional<double> CorrectViewFraction(const DetectionRate& rate) {
  if (rate.found == 0) return std::nullopt;
  return static_cast<double>(rate.correct_view) / rate.found;
}

nlohmann::ordered_json ToJson(const DetectionRate& rate, const DetectableSizes& min_size) {
  return {{"directions", rate.tested},
          {"found", rate.Fraction()},
          {"correct_view", OrNull(CorrectViewFraction(rate))},
          {"half_found_from_px", OrNull(min_size.size_50_px)},
          {"nine_tenths_found_from_px", OrNull(min_size.size_90_px)}};
}

std::string SizeText(const std::optional<double>& size_px) { return size_px ? fmt::format("{:g} px", *size_px) : "-"; }

std::string Row(const std::string& name, const DetectionRate& rate, const DetectableSizes& min_size,
                const std::string& features) {
  const std::optional<double> right = CorrectViewFraction(rate);
  return fmt::format("    {:<14} {:>4} of {:<4} {:>10} {:>10} {:>10} {:>9}\n", name, rate.found, rate.tested,
                     right ? fmt::format("{:.2f}", *right) : "-", SizeText(min_size.size_50_px),
                     SizeText(min_size.size_90_px), features);
}

std::string SettingText(const DetectabilityOptions& options, bool of_photos) {
  if (of_photos) {
    return fmt::format("{:g} px, {}", options.size_px,
                       options.noise > 0 ? fmt::format("noise {:g}", options.noise) : "no noise");
  }
  return fmt::format("{:g} px, {}, {}, camera attitude {}", options.size_px,
                     options.sun_deg ? fmt::format("sun elevation {:g} degrees", *options.sun_deg) : "diffuse light",
                     options.noise > 0 ? fmt::format("noise {:g}", options.noise) : "no noise",
                     options.attitude_known ? "known" : "unknown");
}

std::string BandText(const DetectabilityBand& band, const Detectability& findable) {
  const double max_size_px = findable.max_size_px;
  const std::string where = fmt::format("{:.0f} to {:.0f} degrees {}", band.min_deg, band.max_deg,
                                        findable.of_photos ? "from the photo's direction" : "off nadir");
  if (band.min_size.size_90_px)
    return fmt::format("At {}, 90 % are detected from {:g} px.", where, *band.min_size.size_90_px);
  const std::string why =
      fmt::format("The model has {:.0f} features per view there: {}", band.features,
                  findable.of_photos ? "use a larger, sharper photo of a textured side, and photos from more directions"
                                     : "add texture, or use larger templates (`model add --params`, min_size_px)");
  if (band.min_size.size_50_px) {
    return fmt::format("At {}, 50 % are detected from {:g} px, and 90 % at no size up to {:g} px. {}.", where,
                       *band.min_size.size_50_px, max_size_px, why);
  }
  return fmt::format("At {}, fewer than 50 % are detected at all sizes up to {:g} px. {}.", where, max_size_px, why);
}

std::vector<std::string> Advice(const Detectability& findable) {
  std::vector<std::string> advice;
  for (const DetectabilityBand& band : findable.bands) advice.push_back(BandText(band, findable));
  const auto would = [&](const std::optional<DetectionRate>& rate, const char* how) {
    if (!rate || rate->found <= findable.rate.found) return;
    advice.push_back(fmt::format("{0}, the detected fraction at {3:g} px rises from {2:.2f} to {1:.2f}.", how,
                                 rate->Fraction(), findable.rate.Fraction(), findable.options.size_px));
  };
  would(findable.without_noise, "Without the noise");
  would(findable.in_diffuse_light, "In diffuse light");
  would(findable.with_attitude, "With the camera's attitude from telemetry");
  if (findable.rate.Fraction() < kHighRate && findable.min_size.size_90_px &&
      *findable.min_size.size_90_px > findable.options.size_px) {
    advice.push_back(fmt::format("From nearer, or with a longer focal length: 90 % are detected from {:g} px.",
                                 *findable.min_size.size_90_px));
  }
  const std::optional<double> right = CorrectViewFraction(findable.rate);
  if (right && *right < kHighRate && !findable.of_photos) {
    advice.push_back(
        fmt::format("The view, and with it the heading, is within 10 degrees for a fraction {:.2f} of the detections: "
                    "the object's sides look similar, or lack detail at this size.",
                    *right));
  }
  return advice;
}

}  // namespace

nlohmann::ordered_json ToJson(const Detectability& findable) {
  const DetectabilityOptions& options = findable.options;
  nlohmann::ordered_json json = {{"size_px", options.size_px},
                                 {"noise", options.noise},
                                 {"sun_deg", OrNull(options.sun_deg)},
                                 {"attitude_known", options.attitude_known},
                                 {"seed", options.seed},
                                 {"max_size_px", findable.max_size_px}};
  json.update(ToJson(findable.rate, findable.min_size));
  json["found_without_noise"] = RateOrNull(findable.without_noise);
  json["found_in_soft_light"] = RateOrNull(findable.in_diffuse_light);
  json["found_with_attitude"] = RateOrNull(findable.with_attitude);
  json["bands"] = nlohmann::ordered_json::array();
  for (const DetectabilityBand& band : findable.bands) {
    nlohmann::ordered_json row = {{findable.of_photos ? "turned_deg" : "off_nadir_deg", {band.min_deg, band.max_deg}},
                                  {"features", band.features}};
    row.update(ToJson(band.rate, band.min_size));
    json["bands"].push_back(std::move(row));
  }
  json["advice"] = Advice(findable);
  return json;
}

std::string ToText(const Detectability& findable) {
  std::string text = fmt::format("  findable  at {}; {} directions {}\n    {:<14} {:>12} {:>10} {:>10} {:>10} {:>9}\n",
                                 SettingText(findable.options, findable.of_photos), findable.rate.tested,
                                 findable.of_photos ? "around those of the photos" : "between the model's views",
                                 findable.of_photos ? "turned" : "off nadir", "found", "right view", "50 % from",
                                 "90 % from", "features");
  for (const DetectabilityBand& band : findable.bands) {
    text += Row(fmt::format("{:.0f} to {:.0f} deg", band.min_deg, band.max_deg), band.rate, band.min_size,
                fmt::format("{:.0f}", band.features));
  }
  if (findable.bands.size() > 1) text += Row("all", findable.rate, findable.min_size, "");
  for (const std::string& line : Advice(findable)) text += fmt::format("    {}\n", line);
  text += fmt::format("    An upper limit: a flight detects less, as object, light and ground differ from the {}.\n",
                      findable.of_photos ? "photos" : "model's renderings");
  return text;
}

}  // namespace victorious
