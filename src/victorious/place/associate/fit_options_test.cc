#include "victorious/place/associate/fit_options.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

namespace victorious {
namespace {

// Gives the field another value; numbers the least that they can change by.
void Change(const FieldRef& field) {
  if (double* const* number = std::get_if<double*>(&field.value)) {
    **number = std::nextafter(**number, 1e9);
  } else if (int* const* integer = std::get_if<int*>(&field.value)) {
    ++**integer;
  } else if (bool* const* flag = std::get_if<bool*>(&field.value)) {
    **flag = !**flag;
  } else if (std::uint64_t* const* count = std::get_if<std::uint64_t*>(&field.value)) {
    ++**count;
  } else if (std::string* const* text = std::get_if<std::string*>(&field.value)) {
    **text += "x";
  } else if (std::optional<double>* const* optional = std::get_if<std::optional<double>*>(&field.value)) {
    **optional = *optional ? 0 : 1;
  } else {
    const EnumFieldRef& choice = std::get<EnumFieldRef>(field.value);
    const auto& all = field.spec.choices;
    choice.set_text(choice.text() == all.front() ? all.back() : all.front());
  }
}

bool IsOfNoFit(const std::string& name) { return std::ranges::find(kOptionsOfNoFit, name) != kOptionsOfNoFit.end(); }

TEST(FitOptions, EachUserParameterChangesTheText) {
  const std::string before = FitOptionsText({});
  ObjectOptions defaults;
  std::set<std::string> names;
  for (std::size_t i = 0; i < CollectFields(defaults).size(); ++i) {
    ObjectOptions options;
    const FieldRef field = CollectFields(options).at(i);
    Change(field);
    EXPECT_EQ(FitOptionsText(options) == before, IsOfNoFit(field.name)) << field.name;
    names.insert(field.name);
  }
  EXPECT_TRUE(names.contains("min_inlier_fraction"));
  EXPECT_TRUE(names.contains("locate.common.range_fraction") || names.contains("locate.gate_sigma"));
}

TEST(FitOptions, EachParameterOfLocateChangesTheText) {
  const std::string before = FitOptionsText({});
  LocateOptions defaults;
  for (std::size_t i = 0; i < CollectFields(defaults).size(); ++i) {
    ObjectOptions options;
    const FieldRef field = CollectFields(options.locate).at(i);
    Change(field);
    EXPECT_NE(FitOptionsText(options), before) << field.name;
  }
}

TEST(FitOptions, EachOtherOptionChangesTheText) {
  const std::string before = FitOptionsText({});
  const std::vector<double& (*)(ObjectOptions&)> fields = {
      [](ObjectOptions& options) -> double& { return options.motion_window_s; },
      [](ObjectOptions& options) -> double& { return options.centre_height_m; },
      [](ObjectOptions& options) -> double& { return options.centre_height_sigma_m; },
      [](ObjectOptions& options) -> double& { return options.locate.common.boresight_side_deg; },
      [](ObjectOptions& options) -> double& { return options.locate.common.boresight_rise_deg; }};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    ObjectOptions options;
    fields[i](options) = std::nextafter(fields[i](options), 1e9);
    EXPECT_NE(FitOptionsText(options), before) << i;
  }
  EXPECT_NE(FitOptionsText({.ground_id = "another"}), before);
  EXPECT_EQ(FitOptionsText({.max_height_deviation_m = 1}), before);
}

}  // namespace
}  // namespace victorious
