// The objects of an index, from its tracklets (associate_objects.h) and from the fits that earlier runs kept
// (kept_fits.h): the cost of one more video is that of its own fits, and of reading the rows of tracklets and objects.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/place/associate/object_options.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// What is said of one video's flight, one line each.
struct FlightNotes {
  std::vector<std::string> warnings;          ///< Describe() of its errors
  std::vector<std::string> telemetry_errors;  ///< DescribeErrors(), if anything of it has a line of sight
};

/// Computes the objects of the whole index, but for those that people boxed, and stores them; corrects the yaw and the
/// ranges of each flight by the errors on which its objects agree (flight_errors.h). The objects do not depend on what
/// is kept.
/// Fits are stored each `interval` while it runs, so that a process that is killed, or cancelled, leaves them to the
/// next.
/// @param cancel  stops it at such a moment, with kCancelled, and long waiting for another process
/// @param tell    what is to be said of a video
/// Errors: those of IndexStore; kDataLoss for a search whose stored options cannot be read.
[[nodiscard]] Status UpdateObjects(const ObjectOptions& options, IndexStore& store, const CancelToken& cancel,
                                   const std::function<void(const VideoRecord&, const FlightNotes&)>& tell,
                                   std::chrono::milliseconds interval = std::chrono::seconds(10));

}  // namespace victorious
