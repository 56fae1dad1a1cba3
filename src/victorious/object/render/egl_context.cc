#include "victorious/object/render/egl_context.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include <EGL/eglext.h>
#include <fmt/format.h>

namespace victorious {
namespace {

bool HasExtension(const char* list, std::string_view name) {
  for (std::string_view rest = list == nullptr ? "" : list; !rest.empty();) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    if (rest.substr(0, end) == name) return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

template <typename Function>
Function Find(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

// The displays of all EGL devices: GPUs, then software renderers; software renderers only if `software`.
std::vector<EGLDisplay> DeviceDisplays(bool software) {
  const auto query_devices = Find<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto query_string = Find<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  if (query_devices == nullptr || query_string == nullptr) return {};
  std::array<EGLDeviceEXT, 32> devices = {};
  EGLint count = 0;
  if (query_devices(devices.size(), devices.data(), &count) != EGL_TRUE) return {};
  std::vector<EGLDisplay> gpus;
  std::vector<EGLDisplay> software_devices;
  for (EGLint i = 0; i < count; ++i) {
    EGLDeviceEXT device = devices[static_cast<std::size_t>(i)];
    EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
    const bool is_software = HasExtension(query_string(device, EGL_EXTENSIONS), "EGL_MESA_device_software");
    (is_software ? software_devices : gpus).push_back(display);
  }
  if (software) return software_devices;
  gpus.insert(gpus.end(), software_devices.begin(), software_devices.end());
  return gpus;
}

std::vector<EGLDisplay> Displays(bool software) {
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  std::vector<EGLDisplay> displays;
  if (HasExtension(extensions, "EGL_EXT_platform_device")) displays = DeviceDisplays(software);
  if (!software && HasExtension(extensions, "EGL_MESA_platform_surfaceless")) {
    displays.push_back(eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr));
  }
  std::erase(displays, EGL_NO_DISPLAY);
  return displays;
}

EGLContext CreateContext(EGLDisplay display) {
  if (eglInitialize(display, nullptr, nullptr) != EGL_TRUE) return EGL_NO_CONTEXT;
  const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
  if (!HasExtension(extensions, "EGL_KHR_surfaceless_context")) return EGL_NO_CONTEXT;
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return EGL_NO_CONTEXT;
  constexpr std::array<EGLint, 5> kConfig = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                             EGL_NONE};
  EGLConfig config = nullptr;
  EGLint configs = 0;
  if (eglChooseConfig(display, kConfig.data(), &config, 1, &configs) != EGL_TRUE || configs < 1) return EGL_NO_CONTEXT;
  constexpr std::array<EGLint, 7> kContext = {
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  return eglCreateContext(display, config, EGL_NO_CONTEXT, kContext.data());
}

}  // namespace

Expected<EglContext> EglContext::Create(bool software) {
  for (EGLDisplay display : Displays(software)) {
    EGLContext context = CreateContext(display);
    if (context == EGL_NO_CONTEXT) continue;
    EglContext made(display, context);
    if (made.MakeCurrent()) return made;
  }
  return Fail(ErrorCode::kInternal,
              fmt::format("no device supports headless OpenGL 3.3{}: install Mesa's software renderer (Debian: "
                          "libegl1, libgl1-mesa-dri)",
                          software ? " in software" : ""));
}

EglContext::EglContext(EglContext&& other) noexcept
    : display_(other.display_), context_(std::exchange(other.context_, EGL_NO_CONTEXT)) {}

EglContext::~EglContext() {
  if (context_ == EGL_NO_CONTEXT) return;
  if (eglGetCurrentContext() == context_) eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
}

Status EglContext::MakeCurrent() const {
  if (eglGetCurrentContext() == context_) return {};
  // The bound API is per thread, not per context.
  if (eglBindAPI(EGL_OPENGL_API) == EGL_TRUE &&
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE) {
    return {};
  }
  return Fail(ErrorCode::kInternal, fmt::format("the OpenGL context cannot be used (EGL error {:#x})", eglGetError()));
}

}  // namespace victorious
