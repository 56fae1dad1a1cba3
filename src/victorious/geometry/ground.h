// The ground surface: its height, and the intersection of a line of sight with it. Used by geolocate/; terrain/
// implements Ground for GeoTIFF height models.
//
// A ray is marched from the camera. At clearance c above the ground it advances by c / (s + d) along the ground, where
// s is the maximum slope assumed for the ground and d the descent of the ray, and by at least half the ground's
// spacing. The first point below the ground brackets the intersection, which is found by bisection. Structures thinner
// than the steps may be missed: a mast, not a hill. Heights are above the ellipsoid, so the Earth's curvature needs no
// correction.
#pragma once

#include <expected>
#include <memory>
#include <optional>
#include <utility>

#include <Eigen/Core>

#include "victorious/geometry/geodesy.h"

namespace victorious {

/// A height model. Immutable and thread-safe.
class Ground {
 public:
  virtual ~Ground() = default;

  /// Height above the ellipsoid, m, at the point's latitude and longitude; std::nullopt where it is not known.
  [[nodiscard]] virtual std::optional<double> HeightAt(const GeodeticPoint& point) const = 0;

  /// Distance between neighbouring height samples, m, > 0; the surface is linear between them.
  [[nodiscard]] virtual double Spacing() const = 0;

  /// Maximum slope that the ray marching assumes, m/m.
  [[nodiscard]] virtual double MaxSlope() const = 0;

 protected:
  Ground() = default;
  Ground(const Ground&) = default;
  Ground& operator=(const Ground&) = default;
};

/// A ground of constant height.
class FlatGround final : public Ground {
 public:
  explicit FlatGround(double height_m) : height_m_(height_m) {}

  [[nodiscard]] std::optional<double> HeightAt(const GeodeticPoint& /*point*/) const override { return height_m_; }
  [[nodiscard]] double Spacing() const override { return 1; }
  [[nodiscard]] double MaxSlope() const override { return 0; }

 private:
  double height_m_;
};

/// Another ground shifted upwards, for example to the centres of the objects that stand on it.
class RaisedGround final : public Ground {
 public:
  RaisedGround(std::shared_ptr<const Ground> ground, double offset_m)
      : ground_(std::move(ground)), offset_m_(offset_m) {}

  [[nodiscard]] std::optional<double> HeightAt(const GeodeticPoint& point) const override {
    const auto height_m = ground_->HeightAt(point);
    return height_m ? std::optional(*height_m + offset_m_) : std::nullopt;
  }
  [[nodiscard]] double Spacing() const override { return ground_->Spacing(); }
  [[nodiscard]] double MaxSlope() const override { return ground_->MaxSlope(); }

 private:
  std::shared_ptr<const Ground> ground_;
  double offset_m_;
};

/// A point on the ground with the surface normal there.
struct GroundPatch {
  Eigen::Vector3d point;   ///< in the tangent plane
  Eigen::Vector3d normal;  ///< in the tangent plane; unit vector, upwards
};

/// The ground vertically below or above a point; std::nullopt where it is not known.
std::optional<GroundPatch> GroundPatchAt(const Ground& ground, const TangentPlane& plane,
                                         const Eigen::Vector3d& point_in_plane);

/// The vertical component of the patch's normal: an error of the ground's height times this is its error along the
/// normal.
double VerticalPart(const GroundPatch& patch, const TangentPlane& plane);

/// Why a ray does not intersect the ground.
enum class GroundMiss {
  kBelow,    ///< the ray starts below the ground
  kUnknown,  ///< the ray leaves the area of known ground, or intersects it where the height is not known
  kAbove,    ///< the ray stays above the ground, or is nearly parallel to it at the intersection
};

/// The first intersection of a ray with the ground from above. A stretch of unknown ground between the camera and known
/// ground counts as passed if the ray leaves it above the ground.
/// @param from, along  in the tangent plane; `along` is a unit vector
/// @param slack_m      maximum depth below the ground at which the ray may start, to allow for height errors: it must
///                     then emerge from the ground first
[[nodiscard]] std::expected<GroundPatch, GroundMiss> IntersectGround(const Ground& ground, const TangentPlane& plane,
                                                                     const Eigen::Vector3d& from,
                                                                     const Eigen::Vector3d& along, double slack_m);

}  // namespace victorious
