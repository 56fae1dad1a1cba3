#include "victorious/geometry/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/similarity.h"

namespace victorious {
namespace {

using Eigen::Vector2d;

const Polygon kUnitSquare = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
const Polygon kArrow = {{0, 0}, {4, 2}, {0, 4}, {1, 2}};  // a dart: not convex, area 6
const Polygon kBowTie = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};

Polygon Regular(int corners, double radius, const Vector2d& centre = Vector2d::Zero(), double turn_rad = 0) {
  Polygon polygon;
  polygon.reserve(static_cast<std::size_t>(corners));
  for (int i = 0; i < corners; ++i) {
    const double angle = turn_rad + 2 * kPi * i / corners;
    polygon.emplace_back(centre + radius * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return polygon;
}

Polygon Mapped(const Similarity2& similarity, Polygon polygon) {
  for (Vector2d& corner : polygon) corner = similarity.Apply(corner);
  return polygon;
}

Polygon Reversed(Polygon polygon) {
  std::ranges::reverse(polygon);
  return polygon;
}

std::vector<Vector2d> RandomPoints(Random& random, int count) {
  std::vector<Vector2d> points(static_cast<std::size_t>(count));
  for (Vector2d& point : points) point = {random.Uniform(0, 10), random.Uniform(0, 10)};
  return points;
}

Polygon RandomConvex(Random& random) { return ConvexHull(RandomPoints(random, 8)); }

Similarity2 RandomMove(Random& random) {
  return {.scale = 1,
          .rotation_rad = random.Uniform(-kPi, kPi),
          .translation = {random.Uniform(-1000, 1000), random.Uniform(-1000, 1000)}};
}

// True if `point` is inside the convex, clockwise `hull`, or within 1e-9 of it.
bool Holds(const Polygon& hull, const Vector2d& point) {
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vector2d edge = hull[(i + 1) % hull.size()] - hull[i];
    const Vector2d to = point - hull[i];
    if (edge.x() * to.y() - edge.y() * to.x() < -1e-9) return false;
  }
  return true;
}

TEST(SignedArea, KnownAreasAndOrientation) {
  EXPECT_DOUBLE_EQ(SignedArea(kUnitSquare), 1);  // clockwise on the screen
  EXPECT_DOUBLE_EQ(SignedArea(Reversed(kUnitSquare)), -1);
  EXPECT_DOUBLE_EQ(SignedArea(kArrow), 6);
  EXPECT_NEAR(SignedArea(Regular(360, 1)), 180 * std::sin(kPi / 180), 1e-12);
}

TEST(SignedArea, OfLessThanATriangleIsZero) {
  EXPECT_EQ(SignedArea({}), 0);
  EXPECT_EQ(SignedArea({{3, 4}}), 0);
  EXPECT_EQ(SignedArea({{3, 4}, {5, 6}}), 0);
}

TEST(SignedArea, IsInvariantUnderRigidMotionAndQuadraticInScale) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    Similarity2 move = RandomMove(random);
    EXPECT_NEAR(SignedArea(Mapped(move, kArrow)), 6, 1e-9);
    move.scale = 3;
    EXPECT_NEAR(SignedArea(Mapped(move, kArrow)), 54, 1e-9);
  }
}

TEST(SignedArea, IsExactFarFromTheOrigin) {
  const Similarity2 far{.scale = 1, .rotation_rad = 0, .translation = {1e9, -1e9}};
  EXPECT_DOUBLE_EQ(SignedArea(Mapped(far, kUnitSquare)), 1);
}

TEST(BoundingBox, IsTheSmallest) {
  EXPECT_EQ(BoundingBox(kArrow), (Box{0, 0, 4, 4}));
  EXPECT_EQ(BoundingBox({{-2, 7}}), (Box{-2, 7, 0, 0}));
  EXPECT_TRUE(BoundingBox({}).IsEmpty());
}

TEST(BoxCorners, RoundTripsThroughTheBoundingBox) {
  const Box box{2, 3, 10, 5};
  EXPECT_EQ(BoundingBox(BoxCorners(box)), box);
  EXPECT_DOUBLE_EQ(SignedArea(BoxCorners(box)), box.Area());
  EXPECT_EQ(BoxCorners(box).front(), Vector2d(2, 3));
}

TEST(ClipToConvex, KeepsInsideAndRemovesOutside) {
  const Box frame{-1, -1, 10, 10};
  EXPECT_EQ(ClipToBox(kUnitSquare, frame), kUnitSquare);
  EXPECT_TRUE(ClipToBox(Regular(5, 1, {50, 50}), frame).empty());
}

TEST(ClipToConvex, ClipsAtEdges) {
  const Polygon diamond = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  const Polygon clipped = ClipToBox(diamond, {0, -2, 4, 4});
  EXPECT_NEAR(SignedArea(clipped), 1, 1e-12);
  EXPECT_EQ(BoundingBox(clipped), (Box{0, -1, 1, 2}));
}

TEST(ClipToConvex, IsIndependentOfClipOrientation) {
  const Polygon clip = Regular(6, 2, {3, 2});
  EXPECT_NEAR(SignedArea(ClipToConvex(kArrow, clip)), SignedArea(ClipToConvex(kArrow, Reversed(clip))), 1e-12);
  EXPECT_NEAR(SignedArea(ClipToConvex(Reversed(kArrow), clip)), -SignedArea(ClipToConvex(kArrow, clip)), 1e-12);
}

TEST(ClipToConvex, ClipsCornersFarOutside) {
  // Corners far outside the frame, as of an outline that extends beyond it.
  const Polygon clipped = ClipToBox({{-1000, -1000}, {3000, -1000}, {-1000, 3000}}, {0, 0, 640, 480});
  EXPECT_NEAR(SignedArea(clipped), 640.0 * 480.0, 1e-6);
}

TEST(ClipToConvex, DegenerateClipGivesEmptyPolygon) {
  EXPECT_TRUE(ClipToConvex(kUnitSquare, {}).empty());
  EXPECT_TRUE(ClipToConvex(kUnitSquare, {{0.5, 0.5}}).empty());
  EXPECT_TRUE(ClipToConvex(kUnitSquare, {{0, 0}, {1, 1}}).empty());
  EXPECT_TRUE(ClipToBox(kUnitSquare, Box{0.5, 0.5, 0, 0}).empty());
  EXPECT_TRUE(ClipToConvex({}, kUnitSquare).empty());
}

TEST(ClipToConvex, AreasOfAPartitionSumUp) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Polygon polygon = RandomConvex(random);
    const double cut = random.Uniform(0, 10);
    const double left = SignedArea(ClipToBox(polygon, {-1, -1, cut + 1, 12}));
    const double right = SignedArea(ClipToBox(polygon, {cut, -1, 12 - cut, 12}));
    EXPECT_NEAR(left + right, SignedArea(polygon), 1e-9);
  }
}

TEST(IsConvex, Examples) {
  EXPECT_TRUE(IsConvex(kUnitSquare));
  EXPECT_TRUE(IsConvex(Reversed(kUnitSquare)));
  EXPECT_TRUE(IsConvex(Regular(17, 5, {100, 100})));
  EXPECT_TRUE(IsConvex({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}}));  // a corner on an edge
  EXPECT_FALSE(IsConvex(kArrow));
  EXPECT_FALSE(IsConvex(kBowTie));
  EXPECT_FALSE(IsConvex({}));
  EXPECT_FALSE(IsConvex({{0, 0}, {1, 1}}));
}

TEST(IsConvex, DoublyWoundPolygonIsNot) {
  Polygon pentagram;
  for (const int corner : {0, 2, 4, 1, 3}) pentagram.push_back(Regular(5, 1)[static_cast<std::size_t>(corner)]);
  EXPECT_FALSE(IsConvex(pentagram));
}

TEST(IsConvex, DegenerateOrNonFinitePolygonIsNot) {
  EXPECT_FALSE(IsConvex({{0, 0}, {1, 0}, {2, 0}}));
  EXPECT_FALSE(IsConvex({{0, 0}, {1, 1}, {2, 2}}));
  EXPECT_FALSE(IsConvex({{0, 0}, {2, 0}, {1, 0}, {3, 0}}));
  EXPECT_FALSE(IsConvex({{1, 1}, {1, 1}, {1, 1}}));
  EXPECT_FALSE(IsConvex({{0, 0}, {1, 0}, {std::nan(""), 1}}));
  EXPECT_FALSE(IsConvex({{0, 0}, {1, 0}, {std::numeric_limits<double>::infinity(), 1}}));
}

TEST(ConvexHull, OfASquareWithPointsInsideAndOnItsEdges) {
  const Polygon hull = ConvexHull({{1, 1}, {0, 0}, {2, 2}, {1, 0}, {0, 2}, {2, 0}, {0, 1}, {0, 0}});
  EXPECT_EQ(hull, (Polygon{{0, 0}, {2, 0}, {2, 2}, {0, 2}}));
}

TEST(ConvexHull, OfLessThanATriangle) {
  EXPECT_TRUE(ConvexHull({}).empty());
  EXPECT_EQ(ConvexHull({{1, 2}, {1, 2}}).size(), 1U);
  EXPECT_EQ(ConvexHull({{3, 3}, {1, 1}, {2, 2}, {0, 0}}), (Polygon{{0, 0}, {3, 3}}));  // on one line
}

TEST(ConvexHull, IsConvexClockwiseAndContainsEveryPoint) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const auto points = RandomPoints(random, 3 + static_cast<int>(random.Below(40)));
    const Polygon hull = ConvexHull(points);
    EXPECT_TRUE(IsConvex(hull));
    EXPECT_GT(SignedArea(hull), 0);
    EXPECT_EQ(ConvexHull(hull).size(), hull.size());  // the hull of a hull is the same
    for (const Vector2d& point : points) EXPECT_TRUE(Holds(hull, point));
    for (const Vector2d& corner : hull) EXPECT_NE(std::ranges::find(points, corner), points.end());
  }
}

TEST(IntersectionOverUnionOfPolygons, KnownValues) {
  EXPECT_DOUBLE_EQ(IntersectionOverUnion(kUnitSquare, kUnitSquare), 1);
  EXPECT_DOUBLE_EQ(IntersectionOverUnion(BoxCorners({0, 0, 2, 2}), BoxCorners({1, 0, 2, 2})), 1.0 / 3);
  // The octagon that two unit squares at 45 degrees share has the area 2 (sqrt 2 - 1).
  const double common = 2 * (std::sqrt(2.0) - 1);
  const double radius = std::sqrt(0.5);
  EXPECT_NEAR(IntersectionOverUnion(Regular(4, radius), Regular(4, radius, {0, 0}, kPi / 4)), common / (2 - common),
              1e-12);
  EXPECT_DOUBLE_EQ(IntersectionOverUnion(kArrow, BoxCorners({0, 0, 4, 4})), 6.0 / 16);  // the first need not be convex
}

TEST(IntersectionOverUnionOfPolygons, IsZeroForDisjointOrDegeneratePolygons) {
  EXPECT_EQ(IntersectionOverUnion(kUnitSquare, Regular(4, 1, {10, 10})), 0);
  EXPECT_EQ(IntersectionOverUnion(kUnitSquare, BoxCorners({1, 0, 1, 1})), 0);  // they touch
  EXPECT_EQ(IntersectionOverUnion(kUnitSquare, {}), 0);
  EXPECT_EQ(IntersectionOverUnion(Polygon{}, Polygon{}), 0);
}

TEST(IntersectionOverUnionOfPolygons, IsSymmetricBoundedAndInvariant) {
  Random random(4);
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const Polygon a = RandomConvex(random);
    const Polygon b = RandomConvex(random);
    const double iou = IntersectionOverUnion(a, b);
    EXPECT_GE(iou, 0);
    EXPECT_LE(iou, 1);
    EXPECT_NEAR(IntersectionOverUnion(b, a), iou, 1e-9);
    EXPECT_NEAR(IntersectionOverUnion(Reversed(a), b), iou, 1e-9);
    EXPECT_NEAR(IntersectionOverUnion(a, Reversed(b)), iou, 1e-9);
    Similarity2 move = RandomMove(random);
    move.scale = random.Uniform(0.1, 10);
    EXPECT_NEAR(IntersectionOverUnion(Mapped(move, a), Mapped(move, b)), iou, 1e-9);
  }
}

TEST(IntersectionOverUnionOfPolygons, AgreesWithBoxes) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Box a = BoundingBox(RandomConvex(random));
    const Box b = BoundingBox(RandomConvex(random));
    EXPECT_NEAR(IntersectionOverUnion(BoxCorners(a), BoxCorners(b)), IntersectionOverUnion(a, b), 1e-12);
  }
}

}  // namespace
}  // namespace victorious
