#include "victorious/search/recognize/shape_evidence.h"

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

const ShapeEvidence kRight{
    .response = 12, .contour_mean = 0.4, .distance_change = 0.005, .step = 0.8, .turn_rad = 0.03};

TEST(ShapeEvidence, AllOfItCounts) {
  const double right = NegLog10NfaOf(kRight);
  EXPECT_GT(right, 6);
  ShapeEvidence other = kRight;
  other.response -= 3;
  EXPECT_LT(NegLog10NfaOf(other), right - 1);
  other = kRight;
  other.contour_mean -= 0.2;
  EXPECT_LT(NegLog10NfaOf(other), right - 1);
  other = kRight;
  other.step = 0.3;
  EXPECT_LT(NegLog10NfaOf(other), right - 1) << "painted lines";
  other = kRight;
  other.turn_rad = RadiansFromDegrees(12);
  EXPECT_LT(NegLog10NfaOf(other), right - 3);
}

TEST(ShapeEvidence, NearerAndFartherSpeakAgainstItUpToALimit) {
  ShapeEvidence nearer = kRight;
  ShapeEvidence farther = kRight;
  nearer.distance_change = -0.03;
  farther.distance_change = 0.03;
  EXPECT_DOUBLE_EQ(NegLog10NfaOf(nearer), NegLog10NfaOf(farther));
  EXPECT_LT(NegLog10NfaOf(nearer), NegLog10NfaOf(kRight) - 1);
  farther.distance_change = 0.06;
  const double far = NegLog10NfaOf(farther);
  farther.distance_change = 0.3;
  EXPECT_DOUBLE_EQ(NegLog10NfaOf(farther), far);
}

}  // namespace
}  // namespace victorious
