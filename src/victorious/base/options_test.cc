#include "victorious/base/options.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace victorious {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct NestedOptions {
  double ratio = 0.8;
  int neighbours = 2;

  void ListFields(FieldList& fields) {
    fields.Add("ratio", ratio, {.min = 0.1, .max = 1.0, .unit = "", .reason = "the ratio test's threshold"});
    fields.Add("neighbours", neighbours, {.min = 1, .max = 10, .reason = "how many are looked for"});
  }
};

enum class Filter { kCascade, kNone };

constexpr auto kFilterTexts = std::to_array<EnumText<Filter>>({{Filter::kCascade, "cascade"}, {Filter::kNone, "none"}});

struct TestOptions {
  NestedOptions match;
  std::uint64_t seed = 1;
  bool verbose = false;
  std::string engine = "opencv";
  std::string note = "none";
  double gain = 1.0;
  int offset = 0;

  void ListFields(FieldList& fields) {
    fields.AddGroup("match", match);
    fields.Add("seed", seed, {.reason = "of every random draw"});
    fields.Add("verbose", verbose, {});
    fields.Add("engine", engine, {.choices = {"opencv", "own"}, .reason = "what makes the features"});
    fields.Add("note", note, {});
    fields.Add("gain", gain, {.unit = "px"});
    fields.Add("offset", offset, {.unit = "px"});
  }
};

Status Set(TestOptions& options, std::string_view text) {
  return SetFromJson(nlohmann::json::parse(text), CollectFields(options));
}

// The error's message; empty for success.
std::string ErrorText(std::string_view text) {
  TestOptions options;
  const TestOptions untouched;
  const Status status = Set(options, text);
  if (status) return "";
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(status.error().message.find('\n'), std::string::npos) << status.error().message;
  EXPECT_EQ(OptionsToJsonText(options), OptionsToJsonText(untouched)) << "changed by the refused values";
  return status.error().message;
}

TEST(FieldList, FlattensGroupsIntoDottedNames) {
  TestOptions options;
  const auto fields = CollectFields(options);
  ASSERT_EQ(fields.size(), 8U);
  EXPECT_EQ(fields[0].name, "match.ratio");
  EXPECT_EQ(fields[1].name, "match.neighbours");
  EXPECT_EQ(fields[2].name, "seed");  // the prefix ends with its group
}

TEST(ToJson, NestsGroupsAndSortsKeys) {
  EXPECT_EQ(OptionsToJsonText(TestOptions{}),
            R"({"engine":"opencv","gain":1.0,"match":{"neighbours":2,"ratio":0.8},"note":"none","offset":0,)"
            R"("seed":1,"verbose":false})");
}

TEST(ToJson, RoundTrips) {
  TestOptions options;
  options.match = {.ratio = 1.0 / 3.0, .neighbours = 7};
  options.seed = std::numeric_limits<std::uint64_t>::max();
  options.verbose = true;
  options.engine = "own";
  options.note = "a \"quoted\" word\n";
  options.offset = std::numeric_limits<int>::min();
  TestOptions copy;
  ASSERT_TRUE(Set(copy, OptionsToJsonText(options)));
  EXPECT_EQ(copy.match.ratio, options.match.ratio);
  EXPECT_EQ(copy.seed, options.seed);
  EXPECT_EQ(OptionsToJsonText(copy), OptionsToJsonText(options));
}

TEST(ToJson, AcceptsInvalidUtf8) {
  TestOptions options;
  options.note = "caf\xe9";
  EXPECT_THAT(OptionsToJsonText(options), HasSubstr("caf"));
}

TEST(SetFromJson, AcceptsNestedAndDottedNames) {
  TestOptions nested;
  ASSERT_TRUE(Set(nested, R"({"match": {"ratio": 0.7}, "verbose": true})"));
  EXPECT_EQ(nested.match.ratio, 0.7);
  EXPECT_TRUE(nested.verbose);
  EXPECT_EQ(nested.match.neighbours, 2);  // a field that is not named keeps its value
  TestOptions dotted;
  ASSERT_TRUE(Set(dotted, R"({"match.ratio": 0.7, "verbose": true})"));
  EXPECT_EQ(OptionsToJsonText(dotted), OptionsToJsonText(nested));
}

TEST(SetFromJson, AcceptsIntegersForRealAndSignedForUnsignedFields) {
  TestOptions options;
  ASSERT_TRUE(Set(options, R"({"gain": 3, "match.ratio": 1})"));
  EXPECT_EQ(options.gain, 3.0);
  ASSERT_TRUE(SetFromJson({{"seed", 42}}, CollectFields(options)));  // a signed integer when made in C++
  EXPECT_EQ(options.seed, 42U);
}

TEST(SetFromJson, AcceptsTheBoundsOfARange) {
  EXPECT_EQ(ErrorText(R"({"match": {"ratio": 0.1, "neighbours": 10}})"), "");
  EXPECT_EQ(ErrorText(R"({"offset": 2147483647, "seed": 18446744073709551615})"), "");
  EXPECT_EQ(ErrorText(R"({"offset": -2147483648, "seed": 0})"), "");
}

TEST(SetFromJson, EmptyObjectChangesNothing) {
  EXPECT_EQ(ErrorText("{}"), "");
  EXPECT_EQ(ErrorText(R"({"match": {}})"), "");
}

TEST(SetFromJson, ReportsEveryViolationAndChangesNothing) {
  EXPECT_THAT(
      ErrorText(
          R"({"match": {"ratio": 1.5, "neighbours": 0}, "engine": "surf", "verbose": 1, "gian": 2, "note": "fine"})"),
      AllOf(HasSubstr("match.ratio = 1.5: must be 0.1 to 1"), HasSubstr("match.neighbours = 0: must be 1 to 10"),
            HasSubstr("engine = \"surf\": must be one of opencv, own"), HasSubstr("verbose = 1: must be true or false"),
            HasSubstr("gian"), Not(HasSubstr("note"))));
}

TEST(SetFromJson, UnknownNameSuggestsTheNearestOne) {
  EXPECT_THAT(ErrorText(R"({"match": {"ratoi": 0.7}})"), AllOf(HasSubstr("match.ratoi"), HasSubstr("match.ratio")));
  EXPECT_THAT(ErrorText(R"({"verbos": true})"), HasSubstr("nearest is verbose"));
  EXPECT_THAT(ErrorText(R"({"ratio": 0.7})"), HasSubstr("nearest is match.ratio"));
  EXPECT_THAT(ErrorText(R"({"brightness": 1})"), AllOf(HasSubstr("unknown parameter"), Not(HasSubstr("nearest"))));
}

TEST(SetFromJson, RefusesValuesForGroupsAndGroupsForValues) {
  EXPECT_THAT(ErrorText(R"({"match": 5})"), HasSubstr("unknown parameter"));
  EXPECT_THAT(ErrorText(R"({"match": {"ratio": {"x": 1}}})"), HasSubstr("match.ratio"));
  EXPECT_THAT(ErrorText(R"({"nothing": {}})"), HasSubstr("unknown parameter"));
}

TEST(SetFromJson, RefusesDuplicateNames) {
  EXPECT_THAT(ErrorText(R"({"match": {"ratio": 0.7}, "match.ratio": 0.9})"),
              AllOf(HasSubstr("match.ratio"), HasSubstr("twice")));
}

TEST(SetFromJson, RefusesWrongTypes) {
  EXPECT_THAT(ErrorText(R"({"match.ratio": "0.8"})"), HasSubstr("match.ratio = \"0.8\": must be a number"));
  EXPECT_THAT(ErrorText(R"({"match.ratio": null})"), HasSubstr("must be a number"));
  EXPECT_THAT(ErrorText(R"({"match.ratio": [0.8]})"), HasSubstr("must be a number"));
  EXPECT_THAT(ErrorText(R"({"match.neighbours": 2.5})"), HasSubstr("must be a whole number"));
  EXPECT_THAT(ErrorText(R"({"verbose": "true"})"), HasSubstr("must be true or false"));
  EXPECT_THAT(ErrorText(R"({"engine": 3})"), HasSubstr("must be text"));
  EXPECT_THAT(ErrorText(R"({"seed": -1})"), HasSubstr("seed = -1: must be a whole number, at least 0"));
  EXPECT_THAT(ErrorText(R"({"seed": 1.5})"), HasSubstr("must be a whole number, at least 0"));
}

TEST(SetFromJson, RefusesIntegersOutOfRange) {
  EXPECT_THAT(ErrorText(R"({"offset": 2147483648})"), HasSubstr("offset = 2147483648: must be a whole number"));
  EXPECT_THAT(ErrorText(R"({"offset": -2147483649})"), HasSubstr("must be a whole number"));
  EXPECT_THAT(ErrorText(R"({"offset": 18446744073709551615})"), HasSubstr("must be a whole number"));
  EXPECT_THAT(ErrorText(R"({"offset": 18446744073709551614})"), HasSubstr("must be a whole number"));
}

TEST(SetFromJson, RefusesNonObjects) {
  EXPECT_THAT(ErrorText("[1, 2]"), HasSubstr("JSON object"));
  EXPECT_THAT(ErrorText("null"), HasSubstr("JSON object"));
}

TEST(SetFromJson, DeepNestingIsAnError) {
  const int depth = 200'000;
  std::string text;
  for (int i = 0; i < depth; ++i) text += R"({"match":)";
  text += "1" + std::string(depth, '}');
  EXPECT_THAT(ErrorText(text), HasSubstr("unknown parameter"));
  std::string value = R"({"match.ratio":)";
  value += std::string(depth, '[') + std::string(depth, ']') + "}";
  EXPECT_THAT(ErrorText(value), HasSubstr("must be a number"));
}

TEST(SetFromJson, ControlCharactersInNamesAreEscaped) {
  EXPECT_THAT(ErrorText(R"({"a\nb": 1, "note": "c\nd", "engine": "e\nf"})"), HasSubstr("unknown parameter"));
}

TEST(Validate, DefaultsAreValid) { EXPECT_TRUE(ValidateOptions(TestOptions{})); }

TEST(Validate, ListsEveryViolation) {
  TestOptions options;
  options.match = {.ratio = 0.0, .neighbours = 99};
  options.engine = "";
  const Status status = ValidateOptions(options);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(status.error().message,
            "match.ratio = 0.0: must be 0.1 to 1; match.neighbours = 99: must be 1 to 10; "
            "engine = \"\": must be one of opencv, own");
}

TEST(Validate, NanAndInfinityViolateEveryRange) {
  for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    TestOptions options;
    options.gain = value;  // without bounds
    options.match.ratio = value;
    const Status status = ValidateOptions(options);
    ASSERT_FALSE(status) << value;
    EXPECT_THAT(status.error().message, AllOf(HasSubstr("match.ratio = "), HasSubstr("gain = ")));
  }
  TestOptions options;
  options.gain = std::nan("");
  EXPECT_EQ(ValidateOptions(options).error().message, "gain = nan: must be a number");
}

TEST(MarkdownTable, HasOneRowPerField) {
  TestOptions options;
  const std::string table = MarkdownTable(CollectFields(options));
  EXPECT_THAT(table, HasSubstr("| `match.ratio` | 0.8 | 0.1 to 1 |  | the ratio test's threshold |\n"));
  EXPECT_THAT(table, HasSubstr("| `engine` | \"opencv\" | one of opencv, own |  | what makes the features |\n"));
  EXPECT_THAT(table, HasSubstr("| `gain` | 1.0 | any | px |  |\n"));
  EXPECT_EQ(std::ranges::count(table, '\n'), 10);
}

struct LimitOptions {
  double pixels = 5e6;

  void ListFields(FieldList& fields) { fields.Add("pixels", pixels, {.min = 1, .max = 16'777'217}); }
};

TEST(MarkdownTable, ShowsLimitsInFull) {
  LimitOptions options;
  EXPECT_THAT(MarkdownTable(CollectFields(options)), HasSubstr("1 to 16777217"));
}

struct HeightOptions {
  std::optional<double> height_m;

  void ListFields(FieldList& fields) { fields.Add("height_m", height_m, {.min = 0, .max = 10}); }
};

TEST(OptionalField, IsANumberOrNull) {
  HeightOptions options;
  EXPECT_EQ(OptionsToJsonText(options), R"({"height_m":null})");
  EXPECT_TRUE(ValidateOptions(options));
  const auto set = [&](const nlohmann::json& value) {
    return SetFromJson({{"height_m", value}}, CollectFields(options));
  };
  ASSERT_TRUE(set(3));
  EXPECT_EQ(options.height_m, 3);
  EXPECT_EQ(OptionsToJsonText(options), R"({"height_m":3.0})");
  EXPECT_EQ(set(11).error().message, "height_m = 11: must be 0 to 10");
  EXPECT_EQ(set("3").error().message, "height_m = \"3\": must be a number, or null for none");
  EXPECT_EQ(options.height_m, 3);
  ASSERT_TRUE(set(nullptr));
  EXPECT_EQ(options.height_m, std::nullopt);
}

struct FilterOptions {
  Filter filter = Filter::kCascade;

  void ListFields(FieldList& fields) { fields.Add("filter", filter, kFilterTexts, {.reason = "of the matches"}); }
};

TEST(EnumField, IsWrittenAsItsText) {
  FilterOptions options;
  EXPECT_EQ(OptionsToJsonText(options), R"({"filter":"cascade"})");
  ASSERT_TRUE(SetFromJson({{"filter", "none"}}, CollectFields(options)));
  EXPECT_EQ(options.filter, Filter::kNone);
  EXPECT_EQ(OptionsToJsonText(options), R"({"filter":"none"})");
}

TEST(EnumField, UnknownTextsAndTypesAreRefused) {
  FilterOptions options;
  const auto error = [&](const nlohmann::json& value) {
    return SetFromJson({{"filter", value}}, CollectFields(options)).error().message;
  };
  EXPECT_EQ(error("None"), "filter = \"None\": must be one of cascade, none");
  EXPECT_EQ(error(""), "filter = \"\": must be one of cascade, none");
  EXPECT_EQ(error(1), "filter = 1: must be text");
  EXPECT_EQ(options.filter, Filter::kCascade);
}

TEST(EnumField, ValueOutsideTheTableIsInvalid) {
  EXPECT_TRUE(ValidateOptions(FilterOptions{}));
  EXPECT_EQ(ValidateOptions(FilterOptions{.filter = static_cast<Filter>(7)}).error().message,
            "filter = \"\": must be one of cascade, none");
}

TEST(EnumField, ManualListsItsTexts) {
  FilterOptions options;
  EXPECT_THAT(MarkdownTable(CollectFields(options)),
              HasSubstr("| `filter` | \"cascade\" | one of cascade, none |  | of the matches |\n"));
}

TEST(EnumText, ConvertsBothWays) {
  for (const EnumText<Filter>& entry : kFilterTexts) {
    EXPECT_EQ(ToText(kFilterTexts, entry.value), entry.text);
    EXPECT_EQ(FromText(kFilterTexts, entry.text), entry.value);
  }
  EXPECT_EQ(FromText(kFilterTexts, "cascad"), std::nullopt);
}

TEST(EnumTexts, UnknownTextIsNulloptForOptional) {
  enum class Datum { kSea };
  constexpr auto kTexts =
      std::to_array<EnumText<std::optional<Datum>>>({{std::nullopt, "given"}, {Datum::kSea, "sea"}});
  EXPECT_EQ(FromText(kTexts, "mountain"), std::nullopt);
  const std::optional<std::optional<Datum>> given = FromText(kTexts, "given");
  ASSERT_TRUE(given.has_value());
  EXPECT_FALSE(given->has_value());
  EXPECT_EQ(FromText(kTexts, "sea"), std::optional(Datum::kSea));
}

}  // namespace
}  // namespace victorious
