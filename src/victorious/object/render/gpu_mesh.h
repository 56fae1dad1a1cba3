// Private to render/: a mesh in GPU memory. The centres of its blended triangles stay in main memory for depth sorting.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/object/render/gl_objects.h"
#include "victorious/types/mesh.h"

namespace victorious {

class GpuMesh {
 public:
  struct BlendedTriangle {
    int part = 0;
    std::array<std::uint32_t, 3> corners = {};
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  };

  explicit GpuMesh(const Mesh& mesh);

  [[nodiscard]] const std::vector<MeshPart>& parts() const { return parts_; }
  [[nodiscard]] const Material& MaterialOf(const MeshPart& part) const {
    return materials_[static_cast<std::size_t>(part.material)];
  }
  [[nodiscard]] const std::vector<BlendedTriangle>& blended() const { return blended_; }
  [[nodiscard]] const Eigen::AlignedBox3d& box() const { return box_; }

  /// Binds the vertex array, and the mesh's triangles as its element buffer.
  void BindVertices() const;
  /// Binds the material's texture, or a white 1 x 1 texture if the material has none.
  void BindTexture(const Material& material) const;

 private:
  void UploadVertices(const Mesh& mesh);
  void UploadTextures(const Mesh& mesh);

  GlVertexArray vertex_array_;
  std::array<GlBuffer, 4> attributes_;
  GlBuffer elements_;
  GlTexture white_;
  std::vector<GlTexture> textures_;
  std::vector<MeshPart> parts_;
  std::vector<Material> materials_;
  std::vector<BlendedTriangle> blended_;
  Eigen::AlignedBox3d box_;
};

}  // namespace victorious
