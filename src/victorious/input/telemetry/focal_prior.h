// What is known of an error of telemetry's field of view before anything is measured: most are right, and a few are of
// another zoom, of a crop of the image or of another camera. Chosen, not fitted.
#pragma once

namespace victorious {

/// The probability that it is wrong.
inline constexpr double kWrongFocalProbability = 0.1;

/// Standard deviation of the logarithm of the true over the given focal length: of one that is right, and of a wrong.
inline constexpr double kRightFocalSigma = 0.02;
inline constexpr double kWrongFocalSigma = 0.2;

}  // namespace victorious
