// Private to render/: RAII owners of OpenGL object names. Their context must be current when they are destroyed.
#pragma once

#define GL_GLEXT_PROTOTYPES 1
#include <utility>

#include <GL/glcorearb.h>

namespace victorious {

template <auto Generate, auto Delete>
class GlObject {
 public:
  GlObject() { Generate(1, &name_); }
  ~GlObject() {
    if (name_ != 0) Delete(1, &name_);
  }
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }

  [[nodiscard]] GLuint name() const { return name_; }

 private:
  GLuint name_ = 0;
};

using GlBuffer = GlObject<&glGenBuffers, &glDeleteBuffers>;
using GlTexture = GlObject<&glGenTextures, &glDeleteTextures>;
using GlVertexArray = GlObject<&glGenVertexArrays, &glDeleteVertexArrays>;
using GlFramebuffer = GlObject<&glGenFramebuffers, &glDeleteFramebuffers>;
using GlRenderbuffer = GlObject<&glGenRenderbuffers, &glDeleteRenderbuffers>;

}  // namespace victorious
