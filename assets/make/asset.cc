#include "assets/make/asset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "assets/make/unwrap.h"
#include "victorious/base/check.h"

namespace victorious::assets {
namespace {

constexpr int kSupersampling = 2;  // the atlas is painted at twice its size, for antialiasing
constexpr int kSkyDirections = 48;
constexpr int kSkyMap_px = 384;

/// The surface under each texel: the outermost of the texel's chart.
struct Bake {
  explicit Bake(cv::Size size)
      : position(size, CV_32FC3), normal(size, CV_32FC3), depth(size, CV_32F, -1e9F), part(size, CV_16S, -1) {}
  cv::Mat position;  ///< in the part's axes
  cv::Mat normal;
  cv::Mat depth;
  cv::Mat part;  ///< -1 if the texel is not covered
};

Vec3 ToVec3(const cv::Vec3f& v) { return {v[0], v[1], v[2]}; }
cv::Vec3f ToCv(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Calls `visit(x, y, barycentric)` for each pixel whose centre lies in the triangle, or less than `reach` px outside.
template <typename Visit>
void Rasterise(const std::array<cv::Point2f, 3>& corners, cv::Size size, float reach, const Visit& visit) {
  const auto [a, b, c] = corners;
  const float area = (b - a).cross(c - a);
  if (std::abs(area) < 1e-9F) return;
  const int x0 = std::max(0, static_cast<int>(std::floor(std::min({a.x, b.x, c.x}) - reach)));
  const int y0 = std::max(0, static_cast<int>(std::floor(std::min({a.y, b.y, c.y}) - reach)));
  const int x1 = std::min(size.width - 1, static_cast<int>(std::ceil(std::max({a.x, b.x, c.x}) + reach)));
  const int y1 = std::min(size.height - 1, static_cast<int>(std::ceil(std::max({a.y, b.y, c.y}) + reach)));
  const std::array<float, 3> slack = {reach * static_cast<float>(cv::norm(c - b)) / std::abs(area),
                                      reach * static_cast<float>(cv::norm(a - c)) / std::abs(area),
                                      reach * static_cast<float>(cv::norm(b - a)) / std::abs(area)};
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const cv::Point2f p(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
      const Vec3 weight((b - p).cross(c - p) / area, (c - p).cross(a - p) / area, (a - p).cross(b - p) / area);
      if (weight[0] < -slack[0] || weight[1] < -slack[1] || weight[2] < -slack[2]) continue;
      visit(x, y, weight);
    }
  }
}

void BakePart(const Part& part, int index, const Unwrap& unwrap, const std::vector<Vec3>& normals, Bake& bake) {
  for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
    const Chart& chart = unwrap.charts[unwrap.triangle_charts[index][t]];
    const auto& triangle = part.mesh.triangles[t];
    const std::array<Vec3, 3> points = {part.mesh.points[triangle[0]], part.mesh.points[triangle[1]],
                                        part.mesh.points[triangle[2]]};
    std::array<cv::Point2f, 3> corners;
    for (std::size_t i = 0; i < 3; ++i)
      corners[i] = ProjectToAtlas(points[i], chart) * static_cast<float>(kSupersampling);
    Rasterise(corners, bake.part.size(), 0.75F, [&](int x, int y, const Vec3& weight) {
      if (!(chart.place.x * kSupersampling <= x && x < chart.place.br().x * kSupersampling)) return;
      const Vec3 position = weight[0] * points[0] + weight[1] * points[1] + weight[2] * points[2];
      const float depth = position.dot(Outward(chart.side));
      if (depth <= bake.depth.at<float>(y, x)) return;
      bake.depth.at<float>(y, x) = depth;
      const Vec3 normal = weight[0] * normals[3 * t] + weight[1] * normals[3 * t + 1] + weight[2] * normals[3 * t + 2];
      bake.position.at<cv::Vec3f>(y, x) = ToCv(position);
      bake.normal.at<cv::Vec3f>(y, x) = ToCv(normal.normalized());
      bake.part.at<short>(y, x) = static_cast<short>(index);
    });
  }
}

/// Calls `visit(x, y, part)` for each covered texel, rows in parallel.
template <typename Visit>
void ForEachTexel(const Bake& bake, const Visit& visit) {
  oneapi::tbb::parallel_for(0, bake.part.rows, [&](int y) {
    for (int x = 0; x < bake.part.cols; ++x) {
      if (const int part = bake.part.at<short>(y, x); part >= 0) visit(x, y, part);
    }
  });
}

/// A depth map of the model from one direction of the sky.
class SkyMap {
 public:
  SkyMap(const Vec3& direction, const Vec3& centre, float radius)
      : direction_(direction),
        right_(direction.unitOrthogonal()),
        up_(direction.cross(right_)),
        centre_(centre),
        scale_(kSkyMap_px / (2 * radius)),
        height_(kSkyMap_px, kSkyMap_px, CV_32F, -1e9F) {}

  void Draw(const Vec3& a, const Vec3& b, const Vec3& c) {
    Rasterise({On(a), On(b), On(c)}, height_.size(), 0, [&](int x, int y, const Vec3& weight) {
      const float height = (weight[0] * a + weight[1] * b + weight[2] * c).dot(direction_);
      float& highest = height_.at<float>(y, x);
      highest = std::max(highest, height);
    });
  }

  [[nodiscard]] bool Sees(const Vec3& point, const Vec3& normal) const {
    // Offset by 1.5 px from the surface, against self-shadowing.
    const Vec3 lifted = point + normal * (1.5F / scale_);
    const cv::Point2f at = On(lifted);
    const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
    if (x < 0 || y < 0 || x >= kSkyMap_px || y >= kSkyMap_px) return true;
    return height_.at<float>(y, x) < lifted.dot(direction_) + 1.0F / scale_;
  }

 private:
  [[nodiscard]] cv::Point2f On(const Vec3& point) const {
    const Vec3 from_centre = point - centre_;
    return {from_centre.dot(right_) * scale_ + kSkyMap_px / 2.0F, from_centre.dot(up_) * scale_ + kSkyMap_px / 2.0F};
  }

  Vec3 direction_, right_, up_, centre_;
  float scale_;
  cv::Mat height_;
};

/// Directions evenly distributed over the upper hemisphere (golden angle spiral).
Vec3 SkyDirection(int index) {
  const float height = (static_cast<float>(index) + 0.5F) / kSkyDirections;
  const float angle = static_cast<float>(index) * std::numbers::pi_v<float> * (3 - std::sqrt(5.0F));
  const float out = std::sqrt(1 - height * height);
  return {out * std::cos(angle), height, out * std::sin(angle)};
}

/// The visible fraction of the sky of each texel, 0 to 1; downward surfaces get a small minimum.
cv::Mat SkyLight(const Asset& asset, const Bake& bake, const Vec3& min_corner, const Vec3& max_corner) {
  const Vec3 centre = (min_corner + max_corner) / 2;
  const float radius = (max_corner - min_corner).norm() / 2 + 0.1F;
  cv::Mat seen(bake.part.size(), CV_32F, cv::Scalar(0.02));
  cv::Mat whole(bake.part.size(), CV_32F, cv::Scalar(0.06));
  for (int i = 0; i < kSkyDirections; ++i) {
    const Vec3 direction = SkyDirection(i);
    SkyMap map(direction, centre, radius);
    for (const Part& part : asset.parts) {
      for (const Eigen::Affine3f& place : part.places) {
        for (const auto& [a, b, c] : part.mesh.triangles) {
          map.Draw(place * part.mesh.points[a], place * part.mesh.points[b], place * part.mesh.points[c]);
        }
      }
    }
    ForEachTexel(bake, [&](int x, int y, int part) {
      const Eigen::Affine3f& place = asset.parts[part].places.front();
      const Vec3 normal = place.linear() * ToVec3(bake.normal.at<cv::Vec3f>(y, x));
      const float facing = normal.dot(direction);
      if (facing <= 0) return;
      whole.at<float>(y, x) += facing;
      if (map.Sees(place * ToVec3(bake.position.at<cv::Vec3f>(y, x)), normal)) seen.at<float>(y, x) += facing;
    });
  }
  cv::Mat light = seen / whole;
  cv::blur(light, light, {3, 3});
  return light;
}

/// Fills the texels between the charts with the nearest covered colour, so that filtering shows no seams.
void FillGaps(cv::Mat& texture, const cv::Mat& part) {
  const cv::Mat empty = part < 0;
  cv::Mat distance, labels;
  cv::distanceTransform(empty, distance, labels, cv::DIST_L2, 5, cv::DIST_LABEL_PIXEL);
  std::vector<cv::Vec3b> colour_of(static_cast<std::size_t>(texture.total()) + 1);
  for (int y = 0; y < part.rows; ++y) {
    for (int x = 0; x < part.cols; ++x) {
      if (part.at<short>(y, x) >= 0) colour_of[labels.at<int>(y, x)] = texture.at<cv::Vec3b>(y, x);
    }
  }
  for (int y = 0; y < part.rows; ++y) {
    for (int x = 0; x < part.cols; ++x) {
      if (part.at<short>(y, x) < 0) texture.at<cv::Vec3b>(y, x) = colour_of[labels.at<int>(y, x)];
    }
  }
}

std::vector<Chart> Enlarged(std::vector<Chart> charts) {
  for (Chart& chart : charts) {
    chart.texels_per_m *= kSupersampling;
    chart.place = {chart.place.tl() * kSupersampling, chart.place.size() * kSupersampling};
  }
  return charts;
}

struct Extent {
  Vec3 min_corner = Vec3::Constant(std::numeric_limits<float>::max());
  Vec3 max_corner = -min_corner;
};

Extent ExtentOf(const Asset& asset) {
  Extent extent;
  for (const Part& part : asset.parts) {
    for (const Eigen::Affine3f& place : part.places) {
      for (const Vec3& point : part.mesh.points) {
        extent.min_corner = extent.min_corner.cwiseMin(place * point);
        extent.max_corner = extent.max_corner.cwiseMax(place * point);
      }
    }
  }
  return extent;
}

/// Scales the model to its length and moves the origin to the ground below its centre.
Eigen::Affine3f Placement(const Asset& asset, const Extent& extent) {
  const Vec3 size = extent.max_corner - extent.min_corner;
  const float scale = asset.length_m > 0 ? asset.length_m / size.z() : 1;
  Vec3 origin = Vec3::Zero();
  if (asset.centred) {
    const Vec3 middle = (extent.min_corner + extent.max_corner) / 2;
    origin = Vec3(middle.x(), extent.min_corner.y(), middle.z());
  }
  return Eigen::Scaling(scale) * Eigen::Translation3f(-origin);
}

cv::Mat PaintTexture(const Asset& asset, const Unwrap& unwrap, const Bake& bake, const Extent& extent) {
  cv::Mat colour(bake.part.size(), CV_8UC3, cv::Scalar::all(0));
  ForEachTexel(bake, [&](int x, int y, int part) {
    const Surface surface{ToVec3(bake.position.at<cv::Vec3f>(y, x)), ToVec3(bake.normal.at<cv::Vec3f>(y, x))};
    colour.at<cv::Vec3b>(y, x) = cv::Vec3b(asset.parts[part].paint(surface));
  });
  cv::Mat shade(bake.part.size(), CV_8U, cv::Scalar(kPlainShade));
  const std::vector<Chart> charts = Enlarged(unwrap.charts);
  if (asset.decorate) asset.decorate(Canvas(asset.parts, charts, colour, shade));

  const cv::Mat light = SkyLight(asset, bake, extent.min_corner, extent.max_corner);
  ForEachTexel(bake, [&](int x, int y, int index) {
    const Part& part = asset.parts[index];
    const Eigen::Affine3f& place = part.places.front();
    const Surface surface{place * ToVec3(bake.position.at<cv::Vec3f>(y, x)) - Vec3(0, extent.min_corner.y(), 0),
                          place.linear() * ToVec3(bake.normal.at<cv::Vec3f>(y, x))};
    const Bgr painted = Bgr(colour.at<cv::Vec3b>(y, x)) * (shade.at<std::uint8_t>(y, x) / kPlainShade);
    const Bgr weathered = Mix(painted, Weathered(asset.weather, painted, surface), part.weather);
    const float dark = asset.corner_shadow * (1 - light.at<float>(y, x));
    colour.at<cv::Vec3b>(y, x) = cv::Vec3b(Bgr(weathered * (1 - dark)));
  });
  FillGaps(colour, bake.part);
  cv::Mat texture;
  cv::resize(colour, texture, {asset.atlas_px, asset.atlas_px}, 0, 0, cv::INTER_AREA);
  return texture;
}

/// Merges corners of equal position, normal and texture coordinates into one vertex.
void AddTriangles(const Asset& asset, const Unwrap& unwrap, const std::vector<std::vector<Vec3>>& normals,
                  const Eigen::Affine3f& placement, TexturedMesh& model) {
  for (std::size_t index = 0; index < asset.parts.size(); ++index) {
    const Part& part = asset.parts[index];
    for (const Eigen::Affine3f& place : part.places) {
      std::map<std::array<int, 5>, std::uint32_t> vertices;
      for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
        const int chart = unwrap.triangle_charts[index][t];
        for (std::size_t i = 0; i < 3; ++i) {
          const int corner = part.mesh.triangles[t][i];
          const Vec3& own_normal = normals[index][3 * t + i];
          const auto rough = [](float value) { return static_cast<int>(std::lround(value * 500)); };
          const auto [vertex, added] =
              vertices.try_emplace({corner, chart, rough(own_normal.x()), rough(own_normal.y()), rough(own_normal.z())},
                                   static_cast<std::uint32_t>(model.positions.size()));
          if (added) {
            const cv::Point2f at = ProjectToAtlas(part.mesh.points[corner], unwrap.charts[chart]);
            model.positions.push_back(placement * (place * part.mesh.points[corner]));
            model.normals.push_back((place.linear() * own_normal).normalized());
            model.uvs.emplace_back(at.x / static_cast<float>(asset.atlas_px),
                                   at.y / static_cast<float>(asset.atlas_px));
          }
          model.indices.push_back(vertex->second);
        }
      }
    }
  }
}

}  // namespace

Part& Asset::Add(std::string part_name, Mesh mesh, Paint paint) {
  Part& part = parts.emplace_back();
  part.name = std::move(part_name);
  part.mesh = std::move(mesh);
  part.paint = std::move(paint);
  return part;
}

Stencil Canvas::On(const cv::Mat& image, std::string_view part, Side side) const {
  for (const Chart& chart : charts_) {
    if (parts_[chart.part].name != part || chart.side != side) continue;
    const cv::Mat place = image(chart.place);
    const double margin = kChartMargin_px * kSupersampling;
    const cv::Point2d origin(margin - chart.min_corner.x * chart.texels_per_m,
                             margin - chart.min_corner.y * chart.texels_per_m);
    return {place, origin, chart.texels_per_m, side};
  }
  VICTORIOUS_CHECK(false && "no such part, or none of it faces that side");
  std::abort();
}

TexturedMesh BuildTexturedMesh(const Asset& asset) {
  const Unwrap unwrap = UnwrapParts(asset.parts, asset.atlas_px);
  Bake bake({asset.atlas_px * kSupersampling, asset.atlas_px * kSupersampling});
  std::vector<std::vector<Vec3>> normals;
  for (std::size_t i = 0; i < asset.parts.size(); ++i) {
    normals.push_back(CornerNormals(asset.parts[i].mesh, asset.parts[i].crease_deg));
    BakePart(asset.parts[i], static_cast<int>(i), unwrap, normals[i], bake);
  }
  const Extent extent = ExtentOf(asset);
  TexturedMesh model;
  model.jpeg_quality = asset.jpeg_quality;
  model.texture = PaintTexture(asset, unwrap, bake, extent);
  AddTriangles(asset, unwrap, normals, Placement(asset, extent), model);
  return model;
}

}  // namespace victorious::assets
