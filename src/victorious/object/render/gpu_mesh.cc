#include "victorious/object/render/gpu_mesh.h"

#include <opencv2/core.hpp>

namespace victorious {
namespace {

// Uploads a vertex attribute; an empty array sets the constant 1 for all vertices.
template <int Size>
void UploadAttribute(GLuint location, const GlBuffer& buffer,
                     const std::vector<Eigen::Matrix<float, Size, 1>>& values) {
  if (values.empty()) {
    constexpr std::array<float, 4> kOnes = {1, 1, 1, 1};
    glVertexAttrib4fv(location, kOnes.data());
    return;
  }
  glBindBuffer(GL_ARRAY_BUFFER, buffer.name());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof(values[0])), values.data(),
               GL_STATIC_DRAW);
  glVertexAttribPointer(location, Size, GL_FLOAT, GL_FALSE, 0, nullptr);
  glEnableVertexAttribArray(location);
}

void UploadTexture(const GlTexture& texture, const cv::Mat& bgra) {
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, bgra.cols, bgra.rows, 0, GL_BGRA, GL_UNSIGNED_BYTE, bgra.data);
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

GLint GlWrap(TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::kClamp:
      return GL_CLAMP_TO_EDGE;
    case TextureWrap::kMirror:
      return GL_MIRRORED_REPEAT;
    case TextureWrap::kRepeat:
      break;
  }
  return GL_REPEAT;
}

}  // namespace

GpuMesh::GpuMesh(const Mesh& mesh) : parts_(mesh.parts), materials_(mesh.materials), box_(BoundingBox(mesh)) {
  UploadVertices(mesh);
  UploadTextures(mesh);
  for (int part = 0; part < static_cast<int>(parts_.size()); ++part) {
    const MeshPart& mesh_part = parts_[static_cast<std::size_t>(part)];
    if (MaterialOf(mesh_part).alpha_mode != AlphaMode::kBlend) continue;
    for (std::uint32_t i = mesh_part.first_triangle; i < mesh_part.first_triangle + mesh_part.triangles; ++i) {
      const auto& corners = mesh.triangles[i];
      const Eigen::Vector3f sum = mesh.positions[corners[0]] + mesh.positions[corners[1]] + mesh.positions[corners[2]];
      blended_.push_back({part, corners, sum / 3.0F});
    }
  }
}

void GpuMesh::UploadVertices(const Mesh& mesh) {
  glBindVertexArray(vertex_array_.name());
  UploadAttribute(0, attributes_[0], mesh.positions);
  UploadAttribute(1, attributes_[1], mesh.normals);
  UploadAttribute(2, attributes_[2], mesh.uvs);
  UploadAttribute(3, attributes_[3], mesh.colours);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, elements_.name());
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.triangles.size() * sizeof(mesh.triangles[0])),
               mesh.triangles.data(), GL_STATIC_DRAW);
  glBindVertexArray(0);
}

void GpuMesh::UploadTextures(const Mesh& mesh) {
  UploadTexture(white_, cv::Mat(1, 1, CV_8UC4, cv::Scalar::all(255)));
  textures_.resize(mesh.textures.size());
  for (std::size_t i = 0; i < textures_.size(); ++i) {
    const cv::Mat& image = mesh.textures[i];
    UploadTexture(textures_[i], image.isContinuous() ? image : image.clone());
  }
}

void GpuMesh::BindVertices() const {
  glBindVertexArray(vertex_array_.name());
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, elements_.name());
}

void GpuMesh::BindTexture(const Material& material) const {
  if (material.texture < 0) {
    glBindTexture(GL_TEXTURE_2D, white_.name());
    return;
  }
  glBindTexture(GL_TEXTURE_2D, textures_[static_cast<std::size_t>(material.texture)].name());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GlWrap(material.wrap_u));
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GlWrap(material.wrap_v));
}

}  // namespace victorious
