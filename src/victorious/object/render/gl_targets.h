// Private to render/: the framebuffers of the render passes.
#pragma once

#include "victorious/object/render/gl_objects.h"

namespace victorious {

/// A framebuffer with a colour texture and a depth buffer of the same size.
class Target {
 public:
  Target(int width, int height, GLenum format) : width_(width), height_(height) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glBindTexture(GL_TEXTURE_2D, colour_.name());
    Allocate(format);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour_.name(), 0);
    glBindRenderbuffer(GL_RENDERBUFFER, depth_.name());
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.name());
  }

  void Bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, width_, height_);
  }
  void Clear(float grey) const {
    glClearColor(grey, grey, grey, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  }
  void BindTexture() const { glBindTexture(GL_TEXTURE_2D, colour_.name()); }

 private:
  void Allocate(GLenum format) const {
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width_, height_, 0, GL_RGBA, GL_FLOAT, nullptr);
  }

  int width_;
  int height_;
  GlFramebuffer framebuffer_;
  GlTexture colour_;
  GlRenderbuffer depth_;
};

/// The framebuffers of the three passes over an image: supersampled colour, resolved colour, depth with instance.
struct Targets {
  Targets(int width_px, int height_px, int samples)
      : width(width_px),
        height(height_px),
        supersampling(samples),
        colour(width_px * samples, height_px * samples, GL_RGBA16F),
        resolved(width_px, height_px, GL_RGBA8),
        depth(width_px, height_px, GL_RG32F) {}

  int width;
  int height;
  int supersampling;
  Target colour;
  Target resolved;
  Target depth;
};

/// The shadow map: a depth texture in the sun's parallel projection, with hardware depth comparison.
class ShadowMap {
 public:
  ShadowMap() {
    glBindTexture(GL_TEXTURE_2D, depth_.name());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  }

  void Begin(int width, int height) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    if (width != width_ || height != height_) {
      glBindTexture(GL_TEXTURE_2D, depth_.name());
      glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, width, height, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
      glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_.name(), 0);
      glDrawBuffer(GL_NONE);
      glReadBuffer(GL_NONE);
      width_ = width;
      height_ = height;
    }
    glViewport(0, 0, width, height);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glClear(GL_DEPTH_BUFFER_BIT);
  }
  void BindTexture() const { glBindTexture(GL_TEXTURE_2D, depth_.name()); }

 private:
  int width_ = 0;
  int height_ = 0;
  GlFramebuffer framebuffer_;
  GlTexture depth_;
};

}  // namespace victorious
