// OpenGL names as values that free themselves, and shader programs. Private to player/render.
#pragma once

#include <glad/gl.h>

#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <utility>

#include "formats/core/result.h"

namespace tet4d::render {

// One GL name; Kind has create() and destroy().
template <class Kind>
class GlName {
 public:
  GlName() = default;
  static GlName create() {
    GlName name;
    name.name_ = Kind::create();
    return name;
  }
  GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlName& operator=(GlName&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~GlName() {
    if (name_ != 0) Kind::destroy(name_);
  }
  GLuint get() const { return name_; }

 private:
  GLuint name_ = 0;
};

struct BufferKind {
  static GLuint create();
  static void destroy(GLuint name);
};
struct TextureKind {
  static GLuint create();
  static void destroy(GLuint name);
};
struct FramebufferKind {
  static GLuint create();
  static void destroy(GLuint name);
};
struct VertexArrayKind {
  static GLuint create();
  static void destroy(GLuint name);
};
struct ProgramKind {
  static GLuint create();
  static void destroy(GLuint name);
};
using GlBuffer = GlName<BufferKind>;
using GlTexture = GlName<TextureKind>;
using GlFramebuffer = GlName<FramebufferKind>;
using GlVertexArray = GlName<VertexArrayKind>;

// A linked program. Uniforms that the compiler removed are ignored.
class GlProgram {
 public:
  // `defines`: lines put before all texts, after the version. `geometry` may be null. Fault with the driver's log if it
  // refuses.
  static Result<GlProgram> link(const char* name, const std::string& defines, const char* vertex, const char* geometry,
                                const char* fragment);

  void use() const { glUseProgram(name_.get()); }
  void set(const char* uniform, int value) const { glUniform1i(at(uniform), value); }
  void set(const char* uniform, int x, int y) const { glUniform2i(at(uniform), x, y); }
  void set(const char* uniform, float x, float y) const { glUniform2f(at(uniform), x, y); }
  void set(const char* uniform, float value) const { glUniform1f(at(uniform), value); }
  void set(const char* uniform, const glm::vec3& v) const { glUniform3f(at(uniform), v.x, v.y, v.z); }
  void set(const char* uniform, const glm::mat3& m) const { glUniformMatrix3fv(at(uniform), 1, GL_FALSE, &m[0][0]); }
  void set(const char* uniform, const glm::mat4& m) const { glUniformMatrix4fv(at(uniform), 1, GL_FALSE, &m[0][0]); }

 private:
  GLint at(const char* uniform) const { return glGetUniformLocation(name_.get(), uniform); }
  GlName<ProgramKind> name_;
};

// Resolves GL's functions by name; Fault kNotBuilt if the current context has no OpenGL 3.3.
Status loadGl(void (*(*resolver)(const char*))());

// A table in the driver's memory that shaders read texel by texel.
struct GlTable {
  GlBuffer buffer;
  GlTexture texture;
  void bind(int unit) const {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glBindTexture(GL_TEXTURE_BUFFER, texture.get());
  }
};

// A copy of `bytes`, bound to the unit. Fault kOutOfMemory, of `place`, if it exceeds the driver's limit.
Result<GlTable> makeTable(GLenum format, std::span<const std::byte> bytes, std::size_t texel_bytes, int unit,
                          const std::string& place);

// The driver's error since the last call, as a Fault that names what was being done.
Status checkGl(const char* doing);

}  // namespace tet4d::render
