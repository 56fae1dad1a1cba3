#include "victorious/geometry/box.h"

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

constexpr Box kTenByFive{.x = 2, .y = 3, .width = 10, .height = 5};

Box RandomBox(Random& random) {
  return {random.Uniform(-5, 5), random.Uniform(-5, 5), random.Uniform(0.1, 6), random.Uniform(0.1, 6)};
}

TEST(Box, IsEmptyWithoutBothSides) {
  EXPECT_TRUE(Box{}.IsEmpty());
  EXPECT_TRUE((Box{1, 1, 0, 5}).IsEmpty());
  EXPECT_TRUE((Box{1, 1, 5, -1}).IsEmpty());
  EXPECT_FALSE(kTenByFive.IsEmpty());
  EXPECT_EQ(kTenByFive.Area(), 50);
}

TEST(Box, ContainsLeftAndTopEdgesOnly) {
  EXPECT_TRUE(kTenByFive.Contains(2, 3));
  EXPECT_TRUE(kTenByFive.Contains(11.999, 7.999));
  EXPECT_FALSE(kTenByFive.Contains(12, 5));
  EXPECT_FALSE(kTenByFive.Contains(5, 8));
  EXPECT_FALSE(kTenByFive.Contains(1.999, 5));
}

TEST(Intersection, OfOverlappingBoxes) {
  EXPECT_EQ(Intersection(kTenByFive, {7, 0, 100, 5}), (Box{7, 3, 5, 2}));
  EXPECT_EQ(Intersection(kTenByFive, {4, 4, 1, 1}), (Box{4, 4, 1, 1}));  // inside
}

TEST(Intersection, OfDisjointOrTouchingBoxesIsEmpty) {
  EXPECT_TRUE(Intersection(kTenByFive, {20, 3, 5, 5}).IsEmpty());
  EXPECT_TRUE(Intersection(kTenByFive, {12, 3, 5, 5}).IsEmpty());
  EXPECT_TRUE(Intersection(kTenByFive, {2, 50, 5, 5}).IsEmpty());
  EXPECT_EQ(Intersection(kTenByFive, {20, 30, 5, 5}).Area(), 0);
}

TEST(IntersectionOverUnionOfBoxes, KnownValues) {
  EXPECT_DOUBLE_EQ(IntersectionOverUnion(kTenByFive, kTenByFive), 1);
  EXPECT_DOUBLE_EQ(IntersectionOverUnion(Box{0, 0, 2, 2}, Box{1, 0, 2, 2}), 1.0 / 3);
  EXPECT_DOUBLE_EQ(IntersectionOverUnion(Box{0, 0, 4, 4}, Box{1, 1, 2, 2}), 0.25);
  EXPECT_EQ(IntersectionOverUnion(kTenByFive, Box{20, 20, 5, 5}), 0);
  EXPECT_EQ(IntersectionOverUnion(Box{}, Box{}), 0);
  EXPECT_EQ(IntersectionOverUnion(kTenByFive, Box{4, 4, 0, 0}), 0);
}

TEST(IntersectionOverUnionOfBoxes, IsSymmetricBoundedAndInvariant) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    const Box a = RandomBox(random);
    const Box b = RandomBox(random);
    const double iou = IntersectionOverUnion(a, b);
    EXPECT_EQ(iou, IntersectionOverUnion(b, a));
    EXPECT_GE(iou, 0);
    EXPECT_LE(iou, 1);
    const auto moved = [](const Box& box) {
      return Box{2 * box.x + 31, 2 * box.y - 17, 2 * box.width, 2 * box.height};
    };
    EXPECT_NEAR(IntersectionOverUnion(moved(a), moved(b)), iou, 1e-12);
  }
}

}  // namespace
}  // namespace victorious
