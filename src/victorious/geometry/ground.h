// The ground: how high it is, and where a line of sight meets it.
//
// A ray is followed from its camera. Where it is c above the ground it may go on by c / (s + d) along the ground, s
// being the steepest slope that the ground is supposed to have and d how fast the ray falls, and by half the ground's
// spacing at least; where it is below, the crossing lies between the last two points and is halved out. What is thinner
// than these steps may be passed over: a mast, not a hill. Heights count from the ellipsoid, so that the Earth's
// curvature needs no word.
#pragma once

#include <expected>
#include <memory>
#include <optional>
#include <utility>

#include <Eigen/Core>

#include "victorious/geometry/geodesy.h"

namespace victorious {

/// Immutable; any number of threads may ask it at once.
class Ground {
 public:
  virtual ~Ground() = default;

  /// Above the ellipsoid, m, at the point's latitude and longitude. Nothing where it is not known.
  [[nodiscard]] virtual std::optional<double> HeightAt(const GeodeticPoint& point) const = 0;

  /// Between neighbouring heights, m, > 0: it is straight between them.
  [[nodiscard]] virtual double Spacing() const = 0;

  /// The steepest slope that a search for it supposes, m/m.
  [[nodiscard]] virtual double Steepest() const = 0;

 protected:
  Ground() = default;
  Ground(const Ground&) = default;
  Ground& operator=(const Ground&) = default;
};

/// Of one height everywhere.
class FlatGround final : public Ground {
 public:
  explicit FlatGround(double height_m) : height_m_(height_m) {}

  [[nodiscard]] std::optional<double> HeightAt(const GeodeticPoint& /*point*/) const override { return height_m_; }
  [[nodiscard]] double Spacing() const override { return 1; }
  [[nodiscard]] double Steepest() const override { return 0; }

 private:
  double height_m_;
};

/// Another ground, raised: where the middle of what stands on it is.
class RaisedGround final : public Ground {
 public:
  RaisedGround(std::shared_ptr<const Ground> ground, double by_m) : ground_(std::move(ground)), by_m_(by_m) {}

  [[nodiscard]] std::optional<double> HeightAt(const GeodeticPoint& point) const override {
    const auto height_m = ground_->HeightAt(point);
    return height_m ? std::optional(*height_m + by_m_) : std::nullopt;
  }
  [[nodiscard]] double Spacing() const override { return ground_->Spacing(); }
  [[nodiscard]] double Steepest() const override { return ground_->Steepest(); }

 private:
  std::shared_ptr<const Ground> ground_;
  double by_m_;
};

/// A place of the ground, and how the ground lies there.
struct GroundPatch {
  Eigen::Vector3d point;   ///< in the plane
  Eigen::Vector3d normal;  ///< in the plane; of length 1, upwards
};

/// The ground straight below or above a point. Nothing where it is not known.
std::optional<GroundPatch> PatchBelow(const Ground& ground, const TangentPlane& plane,
                                      const Eigen::Vector3d& point_in_plane);

/// Why a ray meets no ground.
enum class NoGround {
  kBelow,    ///< it starts below the ground
  kUnknown,  ///< it leaves what is known of the ground, or meets it where it is not known
  kAbove,    ///< it stays above the ground, or is all but parallel to it where they meet
};

/// Where a ray first meets the ground from above. The ground that is not known between the camera and where it is known
/// again counts as passed if the ray comes out of it above.
/// @param from, along  in the plane; `along` of length 1
/// @param slack_m      how far below the ground the ray may start, by errors of height: it must come out of it first
std::expected<GroundPatch, NoGround> MeetGround(const Ground& ground, const TangentPlane& plane,
                                                const Eigen::Vector3d& from, const Eigen::Vector3d& along,
                                                double slack_m);

}  // namespace victorious
