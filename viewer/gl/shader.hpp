// GLSL programs and the passes' sources.
#pragma once

#include <Eigen/Core>
#include <string_view>

#include "protocol/base/result.hpp"
#include "viewer/gl/gl_objects.hpp"
#include "viewer/scene/colour.hpp"

namespace enamel::view {

/// Sources without the #version line ("330 core" is put before them). Errors: kDisplay with the driver's log.
[[nodiscard]] Result<GlProgram> build_program(std::string_view name, std::string_view vertex,
                                              std::string_view fragment);

void set_uniform(const GlProgram& program, const char* name, const Eigen::Matrix4f& value);
void set_uniform(const GlProgram& program, const char* name, const Eigen::Vector2f& value);
void set_uniform(const GlProgram& program, const char* name, const Colour& value);
void set_uniform(const GlProgram& program, const char* name, float value);
void set_uniform(const GlProgram& program, const char* name, int value);

namespace glsl {
extern const std::string_view kModelVertex;
extern const std::string_view kModelFragment;
extern const std::string_view kLineVertex;
extern const std::string_view kLineFragment;
extern const std::string_view kScreenVertex;  ///< one triangle over the screen
extern const std::string_view kBackdropFragment;
extern const std::string_view kOcclusionFragment;
extern const std::string_view kDarkenFragment;
extern const std::string_view kQuickCompose;  ///< with edges blurred a little: all that software has time for
extern const std::string_view kComposeFragment;
}  // namespace glsl

}  // namespace enamel::view
