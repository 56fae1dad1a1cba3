#include "victorious/object/render/gl_program.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace victorious {
namespace {

using Log = std::array<char, 256>;

Error BuildError(Log log) {
  std::ranges::replace(log, '\n', ' ');
  return {ErrorCode::kInternal, fmt::format("the device cannot build the renderer's shaders: {}", log.data())};
}

Status AttachShader(GLuint program, GLenum kind, const std::vector<const char*>& pieces) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, static_cast<GLsizei>(pieces.size()), pieces.data(), nullptr);
  glCompileShader(shader);
  glAttachShader(program, shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  Log log = {};
  glGetShaderInfoLog(shader, log.size(), nullptr, log.data());
  glDeleteShader(shader);  // the program keeps it alive
  if (compiled != GL_TRUE) return std::unexpected(BuildError(log));
  return {};
}

}  // namespace

Expected<GlProgram> GlProgram::Make(const char* vertex, std::initializer_list<const char*> fragment) {
  GlProgram program(glCreateProgram());
  VICTORIOUS_RETURN_IF_ERROR(AttachShader(program.name_, GL_VERTEX_SHADER, {vertex}));
  VICTORIOUS_RETURN_IF_ERROR(AttachShader(program.name_, GL_FRAGMENT_SHADER, fragment));
  glLinkProgram(program.name_);
  GLint linked = GL_FALSE;
  glGetProgramiv(program.name_, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  Log log = {};
  glGetProgramInfoLog(program.name_, log.size(), nullptr, log.data());
  return std::unexpected(BuildError(log));
}

GlProgram::GlProgram(GlProgram&& other) noexcept
    : name_(std::exchange(other.name_, 0)), locations_(std::move(other.locations_)) {}

GlProgram::~GlProgram() {
  if (name_ != 0) glDeleteProgram(name_);
}

GLint GlProgram::Location(const char* uniform) {
  const auto known = locations_.find(uniform);
  if (known != locations_.end()) return known->second;
  return locations_[uniform] = glGetUniformLocation(name_, uniform);
}

void GlProgram::Set(const char* uniform, int value) { glUniform1i(Location(uniform), value); }
void GlProgram::Set(const char* uniform, float value) { glUniform1f(Location(uniform), value); }
void GlProgram::Set(const char* uniform, const Eigen::Vector2f& value) {
  glUniform2fv(Location(uniform), 1, value.data());
}
void GlProgram::Set(const char* uniform, const Eigen::Vector3f& value) {
  glUniform3fv(Location(uniform), 1, value.data());
}
void GlProgram::Set(const char* uniform, const Eigen::Vector4f& value) {
  glUniform4fv(Location(uniform), 1, value.data());
}
void GlProgram::Set(const char* uniform, const Eigen::Matrix4f& value) {
  glUniformMatrix4fv(Location(uniform), 1, GL_FALSE, value.data());
}

}  // namespace victorious
