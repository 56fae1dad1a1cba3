// The parameters of geolocation (locate.h).
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "victorious/base/enum_text.h"
#include "victorious/base/options.h"
#include "victorious/geometry/ground.h"

namespace victorious {

/// The motion model of the object.
enum class MotionModel {
  kStatic,
  kVelocity,  ///< constant velocity
  kAuto,      ///< one of the two, selected from the lines
};

inline constexpr auto kMotionModelTexts = std::to_array<EnumText<MotionModel>>(
    {{MotionModel::kStatic, "static"}, {MotionModel::kVelocity, "velocity"}, {MotionModel::kAuto, "auto"}});

/// The estimators (locate.h).
enum class LocateMethod { kMaximumLikelihood, kRansac, kPrior, kLeastSquares, kGround };

inline constexpr auto kLocateMethodTexts =
    std::to_array<EnumText<LocateMethod>>({{LocateMethod::kMaximumLikelihood, "ml"},
                                           {LocateMethod::kRansac, "ransac"},
                                           {LocateMethod::kPrior, "prior"},
                                           {LocateMethod::kLeastSquares, "least-squares"},
                                           {LocateMethod::kGround, "ground"}});

/// Standard deviations of the errors that are common to all lines of sight of a flight. They do not average out.
struct CommonErrorOptions {
  double position_m = 2;
  double height_m = 2;
  double heading_deg = 0.5;
  /// Misalignment of the camera to the side, in addition to the heading error. Not a user parameter.
  double boresight_side_deg = 0.1;
  double boresight_rise_deg = 0.5;  ///< error in elevation: misalignment of the camera upwards. Not a user parameter
  double range_fraction = 0.02;

  void ListFields(FieldList& fields);
};

/// Standard deviations of the independent errors of one line. The `sigma_*` columns of the lines take precedence.
struct LineErrorOptions {
  double position_m = 2;
  double angle_deg = 0.5;
  double range_fraction = 0.15;

  void ListFields(FieldList& fields);
};

struct LocateOptions {
  MotionModel motion = MotionModel::kStatic;
  LocateMethod method = LocateMethod::kMaximumLikelihood;
  double identity_radius_m = 2;
  double distance_prior_allowance = 1.5;
  double gate_sigma = 3;
  double robust_sigma = 2.5;
  double ground_sigma_m = 2;
  int max_hypotheses = 500;
  std::uint64_t seed = 1;
  LineErrorOptions line;
  CommonErrorOptions common;
  std::shared_ptr<const Ground> ground;  ///< on which objects stand, if given; set by the caller. Not a user parameter

  void ListFields(FieldList& fields);
};

/// The fields of LocateOptions that a user can set where objects of a video are located (associate/): motion, method
/// and the errors of lines follow from the video.
struct VideoLocateFields {
  LocateOptions& locate;

  void ListFields(FieldList& fields) const;
};

}  // namespace victorious
