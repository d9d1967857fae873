#include "viewer/gl/shader.hpp"

#include <array>
#include <string>

namespace enamel::view {
namespace {

Result<GlShader> compile(std::string_view name, GLenum stage, std::string_view source) {
  constexpr std::string_view kVersionLine = "#version 330 core\n";
  GlShader shader = GlShader::adopt(glCreateShader(stage));
  const std::array<const GLchar*, 2> text{kVersionLine.data(), source.data()};
  const std::array<GLint, 2> length{static_cast<GLint>(kVersionLine.size()), static_cast<GLint>(source.size())};
  glShaderSource(shader.id(), 2, text.data(), length.data());
  glCompileShader(shader.id());
  GLint ok = GL_FALSE;
  glGetShaderiv(shader.id(), GL_COMPILE_STATUS, &ok);
  if (ok != GL_TRUE) {
    std::array<GLchar, 2048> log{};
    glGetShaderInfoLog(shader.id(), static_cast<GLsizei>(log.size()), nullptr, log.data());
    return fail(ErrorCode::kDisplay, "shader " + std::string(name) + ": " + log.data());
  }
  return shader;
}

}  // namespace

Result<GlProgram> build_program(std::string_view name, std::string_view vertex, std::string_view fragment) {
  ENAMEL_TRY_ASSIGN(const GlShader vs, compile(name, GL_VERTEX_SHADER, vertex));
  ENAMEL_TRY_ASSIGN(const GlShader fs, compile(name, GL_FRAGMENT_SHADER, fragment));
  GlProgram program = GlProgram::make();
  glAttachShader(program.id(), vs.id());
  glAttachShader(program.id(), fs.id());
  glLinkProgram(program.id());
  GLint ok = GL_FALSE;
  glGetProgramiv(program.id(), GL_LINK_STATUS, &ok);
  if (ok != GL_TRUE) {
    std::array<GLchar, 2048> log{};
    glGetProgramInfoLog(program.id(), static_cast<GLsizei>(log.size()), nullptr, log.data());
    return fail(ErrorCode::kDisplay, "linking shader " + std::string(name) + ": " + log.data());
  }
  glDetachShader(program.id(), vs.id());
  glDetachShader(program.id(), fs.id());
  return program;
}

void set_uniform(const GlProgram& program, const char* name, const Eigen::Matrix4f& value) {
  glUniformMatrix4fv(glGetUniformLocation(program.id(), name), 1, GL_FALSE, value.data());
}
void set_uniform(const GlProgram& program, const char* name, const Eigen::Vector2f& value) {
  glUniform2f(glGetUniformLocation(program.id(), name), value.x(), value.y());
}
void set_uniform(const GlProgram& program, const char* name, const Colour& srgb) {
  glUniform3f(glGetUniformLocation(program.id(), name), srgb.r, srgb.g, srgb.b);
}
void set_uniform(const GlProgram& program, const char* name, float value) {
  glUniform1f(glGetUniformLocation(program.id(), name), value);
}
void set_uniform(const GlProgram& program, const char* name, int value) {
  glUniform1i(glGetUniformLocation(program.id(), name), value);
}

}  // namespace enamel::view
