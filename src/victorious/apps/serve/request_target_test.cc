#include "victorious/apps/serve/request_target.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

TEST(RequestTarget, IsDecoded) {
  const auto target = ParseRequestTarget("/api/v1/objects?model=box%20truck&near=1%2C2,3&flag&q=a+b");
  ASSERT_TRUE(target);
  EXPECT_THAT(target->segments, ElementsAre("api", "v1", "objects"));
  EXPECT_THAT(target->query,
              ElementsAre(Pair("model", "box truck"), Pair("near", "1,2,3"), Pair("flag", ""), Pair("q", "a b")));
  EXPECT_THAT(ParseRequestTarget("/")->segments, IsEmpty());
  EXPECT_THAT(ParseRequestTarget("/a/")->segments, ElementsAre("a"));
  EXPECT_THAT(ParseRequestTarget("/?")->query, IsEmpty());
  EXPECT_THAT(ParseRequestTarget("/a+b%2b")->segments, ElementsAre("a+b+")) << "plus is a space in a query only";
}

TEST(RequestTarget, RefusesToLeaveItsFolder) {
  for (const char* target : {"", "x", "//etc/passwd", "/../etc/passwd", "/a/../../b", "/%2e%2e/etc", "/a/%2e", "/a%2fb",
                             "/a%5cb", "/a%00b", "/%", "/%1", "/%zz", "/a\nb", "http://elsewhere/"}) {
    const auto parsed = ParseRequestTarget(target);
    ASSERT_FALSE(parsed) << target;
    EXPECT_EQ(parsed.error().error.code, ErrorCode::kInvalidArgument) << target;
  }
  EXPECT_FALSE(ParseRequestTarget("/" + std::string(5000, 'a')));
  EXPECT_EQ(ParseRequestTarget("/?a=1&a=2").error().field, "a");
}

TEST(QueryReader, ReadsTypesAndNamesTheField) {
  const auto target = ParseRequestTarget("/?n=7&x=0.5&bad=1x&far=nan&near=52.5,13.4,50&off=91,0,1&two=1,2");
  ASSERT_TRUE(target);
  QueryReader query(*target);
  EXPECT_EQ(**query.Integer("n", 1, 10), 7);
  EXPECT_EQ(query.Integer("n", 8, 10).error().field, "n");
  EXPECT_EQ(**query.Number("x", 0, 1), 0.5);
  EXPECT_EQ(query.Number("bad", 0, 10).error().field, "bad");
  EXPECT_EQ(query.Number("far", 0, 10).error().field, "far");
  EXPECT_EQ(*query.Number("none", 0, 1), std::nullopt);
  EXPECT_NEAR((**query.Circle("near")).centre.latitude_rad, RadiansFromDegrees(52.5), 1e-12);
  EXPECT_EQ(query.Circle("off").error().field, "off");
  EXPECT_FALSE(query.CheckAllUsed());
  EXPECT_EQ(query.CheckAllUsed().error().field, "two");
  EXPECT_EQ(query.Circle("two").error().field, "two");
  EXPECT_TRUE(query.CheckAllUsed());
}

TEST(QueryReader, ReadsAreas) {
  const auto area_of = [](const std::string& text) {
    const auto target = ParseRequestTarget("/?area=" + text);
    EXPECT_TRUE(target) << text;
    return QueryReader(*target).Area("area");
  };
  const auto triangle = area_of("52.5,13.4,52.6,13.4,52.6,13.5");
  ASSERT_TRUE(triangle && *triangle);
  ASSERT_EQ((**triangle).corners.size(), 3);
  EXPECT_NEAR((**triangle).corners[2].longitude_rad, RadiansFromDegrees(13.5), 1e-12);
  EXPECT_TRUE(area_of("1,179,1,-179,2,-179")) << "across the antimeridian";
  for (const char* wrong : {"", "1,2", "1,2,3,4", "1,2,3,4,5", "1,2,3,4,5,6,", "1,2,3,4,5,x", "1,2,3,4,5,nan",
                            "91,2,3,4,5,6", "0,0,0,100,1,0"}) {
    const auto area = area_of(wrong);
    ASSERT_FALSE(area) << wrong;
    EXPECT_EQ(area.error().field, "area");
  }
}

}  // namespace
}  // namespace victorious
