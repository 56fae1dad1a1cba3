// Private to render/: a linked shader program.
#pragma once

#include <initializer_list>
#include <map>
#include <string>

#include <Eigen/Core>

#include "victorious/base/error.h"
#include "victorious/object/render/gl_objects.h"

namespace victorious {

class GlProgram {
 public:
  /// Compiles and links. The sources in `fragment` are concatenated. Error: kInternal, with the start of the driver's
  /// log.
  [[nodiscard]] static Expected<GlProgram> Make(const char* vertex, std::initializer_list<const char*> fragment);
  ~GlProgram();
  GlProgram(GlProgram&& other) noexcept;
  GlProgram& operator=(GlProgram&&) = delete;

  void Use() const { glUseProgram(name_); }

  // Sets a uniform. The program must be in use. A uniform that the program does not have is ignored.
  void Set(const char* uniform, int value);
  void Set(const char* uniform, float value);
  void Set(const char* uniform, const Eigen::Vector2f& value);
  void Set(const char* uniform, const Eigen::Vector3f& value);
  void Set(const char* uniform, const Eigen::Vector4f& value);
  void Set(const char* uniform, const Eigen::Matrix4f& value);

 private:
  explicit GlProgram(GLuint name) : name_(name) {}
  GLint Location(const char* uniform);

  GLuint name_;
  std::map<std::string, GLint, std::less<>> locations_;
};

}  // namespace victorious
