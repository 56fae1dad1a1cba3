// The fits of data association: the places of hypotheses by their lines of sight. Fits makes them from the content of
// tracklets; KeptFits (kept_fits.h) takes those of earlier runs from the store.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "victorious/place/associate/object_hypothesis.h"
#include "victorious/place/associate/object_options.h"
#include "victorious/place/associate/object_place.h"
#include "victorious/place/associate/observed_tracklet.h"

namespace victorious {

/// The height of an object's centre, as the other objects of its flight show the ground.
struct Level {
  double altitude_m = 0;
  double sigma_m = 0;

  bool operator==(const Level&) const = default;
};

/// A place on the ground at a level.
struct LevelPlace {
  ObjectPlace relative;                 ///< as Fits::Relative(); `path` may be missing
  std::optional<Geolocation> absolute;  ///< with all errors of the flight; std::nullopt unless it moves as Absolute()
};

/// Makes each fit, of a hypothesis of one flight, when it is asked for. Not thread-safe.
class Fits {
 public:
  explicit Fits(const ObjectOptions& options) : options_(options) {}
  virtual ~Fits() = default;
  Fits(const Fits&) = delete;
  Fits& operator=(const Fits&) = delete;

  /// The place of a hypothesis for the comparison with others of its flight. `path` may be missing, see Path().
  [[nodiscard]] virtual ObjectPlace Relative(const ObjectHypothesis& hypothesis);

  /// The place with all errors of its flight. `path` may be missing.
  [[nodiscard]] virtual ObjectPlace Absolute(const ObjectHypothesis& hypothesis);

  /// The place on ground at this height.
  /// @param hypothesis  with its estimate and its absolute place, both of which have a path
  [[nodiscard]] virtual LevelPlace OnLevel(const ObjectHypothesis& hypothesis, const Level& level);

  /// The path of Relative(), where that has one.
  [[nodiscard]] virtual std::vector<Geolocation> Path(const ObjectHypothesis& hypothesis);

  /// The frames of a tracklet, ascending.
  [[nodiscard]] virtual const std::vector<std::int64_t>& Frames(const ObservedTracklet& tracklet);

  [[nodiscard]] const ObjectOptions& options() const { return options_; }

 private:
  ObjectOptions options_;
};

}  // namespace victorious
