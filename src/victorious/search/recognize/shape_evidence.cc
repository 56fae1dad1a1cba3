#include "victorious/search/recognize/shape_evidence.h"

#include <algorithm>
#include <cmath>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// Chosen on flights of bench/accuracy/plain_vehicles.py (docs/adr/0047).
constexpr double kScoreOfContourDecade = 24;
constexpr double kScoreOfDistance = 110;  // of a unit of the logarithm
constexpr double kScoreOfDegree = 0.5;
// A wrong height above the ground or field of view changes all distances: not more than that speaks against a match.
constexpr double kMaxScoreOfDistance = 5;
constexpr double kScoreOfStep = 12;
constexpr double kUsualStep = 0.6;  // vehicles have more, with 15 % of noise, too; court and lane markings 0.2 to 0.5
constexpr double kScoreOfOneFalseAlarm = 3;
constexpr double kDecadesPerScore = 0.6;

}  // namespace

double ScoreOf(const ShapeEvidence& evidence) {
  return evidence.response + kScoreOfContourDecade * evidence.contour_mean -
         std::min(kMaxScoreOfDistance, kScoreOfDistance * std::abs(evidence.distance_change)) -
         kScoreOfStep * std::max(0.0, kUsualStep - evidence.step) -
         kScoreOfDegree * DegreesFromRadians(evidence.turn_rad);
}

double NegLog10NfaOf(const ShapeEvidence& evidence) {
  return kDecadesPerScore * (ScoreOf(evidence) - kScoreOfOneFalseAlarm);
}

}  // namespace victorious
