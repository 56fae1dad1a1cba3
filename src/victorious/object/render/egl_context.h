// Private to render/: a headless OpenGL 3.3 core context (EGL).
#pragma once

#include <EGL/egl.h>

#include "victorious/base/error.h"

namespace victorious {

class EglContext {
 public:
  /// Creates the context on the first device that supports it. Tries GPUs, then software renderers; software renderers
  /// only if `software`. Error: kInternal, no device supports OpenGL 3.3.
  [[nodiscard]] static Expected<EglContext> Create(bool software);
  ~EglContext();
  EglContext(EglContext&& other) noexcept;
  EglContext& operator=(EglContext&&) = delete;

  /// Makes this context current on the calling thread. Error: kInternal.
  [[nodiscard]] Status MakeCurrent() const;

 private:
  EglContext(EGLDisplay display, EGLContext context) : display_(display), context_(context) {}

  EGLDisplay display_;  // never terminated: all contexts of the device share it
  EGLContext context_;
};

}  // namespace victorious
