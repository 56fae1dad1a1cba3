#include "victorious/place/associate/fit_options.h"

#include <algorithm>
#include <vector>

namespace victorious {
namespace {

// A field added to one of the structs does not compile here before it has a name here. If its struct lists it
// (ListFields), nothing else is to be done; if not, AllFields below must list it, unless no fit depends on it
// (`kept_json`).
void CountFields(const ObjectOptions& options) {
  [[maybe_unused]] const auto& [merge_gate_sigma, max_merge_distance_m, min_inlier_fraction, max_size_ratio,
                                false_alarm_rate, telemetry_errors, locate, motion_window_s, max_height_deviation_m,
                                centre_height_m, centre_height_sigma_m, ground, ground_id, kept_json] = options;
  [[maybe_unused]] const auto& [motion, method, identity_radius_m, distance_prior_allowance, gate_sigma, robust_sigma,
                                ground_sigma_m, max_hypotheses, seed, line, common, locate_ground] = locate;
  [[maybe_unused]] const auto& [line_position_m, angle_deg, line_range_fraction] = line;
  [[maybe_unused]] const auto& [position_m, height_m, heading_deg, boresight_side_deg, boresight_rise_deg,
                                range_fraction] = common;
}

struct AllFields {
  ObjectOptions& options;

  void ListFields(FieldList& fields) const {
    CountFields(options);
    options.ListFields(fields);
    fields.AddGroup("whole_locate", options.locate);  // with those that ObjectOptions does not list
    CommonErrorOptions& common = options.locate.common;
    fields.Add("boresight_side_deg", common.boresight_side_deg, {});
    fields.Add("boresight_rise_deg", common.boresight_rise_deg, {});
    fields.Add("motion_window_s", options.motion_window_s, {});
    fields.Add("max_height_deviation_m", options.max_height_deviation_m, {});
    fields.Add("centre_height_m", options.centre_height_m, {});
    fields.Add("centre_height_sigma_m", options.centre_height_sigma_m, {});
    fields.Add("ground_id", options.ground_id, {});
  }
};

}  // namespace

std::string FitOptionsText(ObjectOptions options) {
  const AllFields all{options};
  std::vector<FieldRef> fields = CollectFields(all);
  std::erase_if(fields, [](const FieldRef& field) {
    return std::ranges::find(kOptionsOfNoFit, field.name) != kOptionsOfNoFit.end();
  });
  return ToJsonText(fields);
}

}  // namespace victorious
