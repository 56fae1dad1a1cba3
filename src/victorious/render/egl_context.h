// Private to render/: an OpenGL 3.3 core context without a window.
#pragma once

#include <EGL/egl.h>

#include "victorious/base/error.h"

namespace victorious {

class EglContext {
 public:
  /// On the first device that offers it: GPUs before software, or only software. Error: kInternal.
  static Expected<EglContext> Create(bool software);
  ~EglContext();
  EglContext(EglContext&& other) noexcept;
  EglContext& operator=(EglContext&&) = delete;

  /// OpenGL calls of this thread go to this context from now on. Error: kInternal.
  [[nodiscard]] Status MakeCurrent() const;

 private:
  EglContext(EGLDisplay display, EGLContext context) : display_(display), context_(context) {}

  EGLDisplay display_;  // shared by all contexts of the device, therefore never terminated
  EGLContext context_;
};

}  // namespace victorious
