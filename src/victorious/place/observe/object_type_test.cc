#include "victorious/place/observe/object_type.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(ObjectType, IsTheLastKnownPart) {
  ASSERT_NE(FindObjectType("vehicle/car"), nullptr);
  EXPECT_EQ(FindObjectType("vehicle/car")->name, "car");
  EXPECT_EQ(FindObjectType("vehicle/lunar rover")->name, "vehicle");
  EXPECT_EQ(FindObjectType("Truck")->name, "truck");
  EXPECT_EQ(FindObjectType("the mayor's"), nullptr);
  EXPECT_EQ(FindObjectType(""), nullptr);
}

TEST(ObjectType, LengthAndMotionAreConsistent) {
  EXPECT_TRUE(FindObjectType("building")->is_static);
  EXPECT_EQ(FindObjectType("building")->length_m, 0);
  for (const ObjectType& type : ObjectTypes()) {
    EXPECT_EQ(type.length_m > 0, type.length_fraction > 0) << type.name;
    EXPECT_EQ(FindObjectType(type.name), &type);
  }
}

}  // namespace
}  // namespace victorious
