// The sizes of telemetry's errors in one flight, as its own lines of sight show them, relative to the supposed ones.
//
// Lines of sight to one standing object meet but for errors. In frame k, line i has the offset, m, to the side and
// upwards, from the place o of its object:
//
//   y_ki = P_i (o - o0) + P_i a s_p e_k + d_i b s_a (f_k + g) + d_i m s_i h_ki
//
// with the supposed position error s_p and attitude error s_a, both of each row (e_k, f_k: one in all lines of a frame)
// and of the flight (g; that of the position moves all objects alike and does not show), the line's own error s_i
// (h_ki), errors of clock and focal length (LineOfSight), and standard normal e, f, g, h. Unknown scales: a, b, m.
// Their posterior is computed on a grid, with the places and the errors of the flight integrated out (restricted
// maximum likelihood; Patterson and Thompson 1971):
//
//   prior: log a, log b normal about log q, q half-Cauchy with scale 1 (Gelman 2006): what is supposed; m log-normal
//
// Where the lines say little the posterior is the prior. What is common to the flight is of the size that the rows
// have, if the telemetry is one of unfiltered rows: q is the class of the receiver and the mount. This is a prior, not
// a measurement: a constant error of position does not show in a flight.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/place/associate/object_options.h"
#include "victorious/place/associate/observed_tracklet.h"

namespace victorious {

/// The size of one kind of error over the supposed size.
struct ErrorScale {
  double ratio = 1;          ///< root of the mean square of its posterior
  bool is_measured = false;  ///< the lines say more than the prior
};

struct TelemetryErrors {
  ErrorScale position;
  ErrorScale attitude;
  /// The errors that are common to the flight are of the class of those of its rows: ErrorSource::kReceiver, and the
  /// rows are unfiltered. Else only larger ones are concluded from the rows.
  bool is_receiver_known = false;
  /// Of the supposed errors of clock and field of view, which show in no line: predicted by the other two. 1 where they
  /// are measured, or given.
  double clock_ratio = 1;
  double focal_ratio = 1;
  int objects = 0;  ///< that stand, and are compared
  int frames = 0;   ///< with lines of sight to them
};

/// Estimates the sizes of one flight's errors. std::nullopt if the lines say nothing: fewer than kMinErrorFrames
/// frames, or telemetry that states its own errors.
/// @param tracklets  of one video
/// Cost: some 2 ms a frame, for at most 60 frames.
[[nodiscard]] std::optional<TelemetryErrors> EstimateTelemetryErrors(std::span<const ObservedTracklet> tracklets,
                                                                     const ObjectOptions& options);

/// Fewer frames say nothing.
inline constexpr int kMinErrorFrames = 8;

/// Sets the sizes in the observations, and scales the errors of clock and field of view where they are supposed ones.
void SetTelemetryErrors(const TelemetryErrors& errors, const ObjectOptions& options,
                        std::span<ObservedTracklet> tracklets);

/// "attitude: 0.03 degrees, measured on 4 objects and 60 frames", one line for each kind of error.
/// @param errors  std::nullopt: all are supposed
[[nodiscard]] std::vector<std::string> DescribeErrors(const std::optional<TelemetryErrors>& errors,
                                                      const ObjectOptions& options);

}  // namespace victorious
