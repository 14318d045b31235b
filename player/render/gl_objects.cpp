#define GLAD_GL_IMPLEMENTATION
#include "player/render/gl_objects.h"

#include <array>
#include <cstdio>

namespace tet4d::render {
namespace {

template <class Generate>
GLuint generate(Generate generator) {
  GLuint name = 0;
  generator(1, &name);
  return name;
}

Result<GLuint> compile(GLenum stage, const char* name, const std::string& defines, const char* text) {
  const std::string head = "#version 330 core\n" + defines;
  const std::array<const char*, 2> texts{head.c_str(), text};
  const GLuint shader = glCreateShader(stage);
  glShaderSource(shader, 2, texts.data(), nullptr);
  glCompileShader(shader);
  GLint compiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled != 0) return shader;
  std::array<char, 2048> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  glDeleteShader(shader);
  const char* stage_name = stage == GL_VERTEX_SHADER     ? " (vertex)"
                           : stage == GL_GEOMETRY_SHADER ? " (geometry)"
                                                         : " (fragment)";
  return Fault{FaultCode::kNotBuilt, "", std::string("shader ") + name + stage_name,
               std::string("the driver refuses it: ") + log.data(), "use --renderer cpu"};
}

}  // namespace

GLuint BufferKind::create() { return generate(glGenBuffers); }
void BufferKind::destroy(GLuint name) { glDeleteBuffers(1, &name); }
GLuint TextureKind::create() { return generate(glGenTextures); }
void TextureKind::destroy(GLuint name) { glDeleteTextures(1, &name); }
GLuint FramebufferKind::create() { return generate(glGenFramebuffers); }
void FramebufferKind::destroy(GLuint name) { glDeleteFramebuffers(1, &name); }
GLuint VertexArrayKind::create() { return generate(glGenVertexArrays); }
void VertexArrayKind::destroy(GLuint name) { glDeleteVertexArrays(1, &name); }
GLuint ProgramKind::create() { return glCreateProgram(); }
void ProgramKind::destroy(GLuint name) { glDeleteProgram(name); }

Result<GlProgram> GlProgram::link(const char* name, const std::string& defines, const char* vertex,
                                  const char* geometry, const char* fragment) {
  GlProgram program;
  program.name_ = GlName<ProgramKind>::create();
  const GLuint id = program.name_.get();
  for (const auto& [stage, text] : {std::pair{GL_VERTEX_SHADER, vertex}, std::pair{GL_GEOMETRY_SHADER, geometry},
                                    std::pair{GL_FRAGMENT_SHADER, fragment}}) {
    if (text == nullptr) continue;
    const auto shader = compile(static_cast<GLenum>(stage), name, defines, text);
    if (!shader.ok()) return shader.fault();
    glAttachShader(id, shader.value());
    glDeleteShader(shader.value());  // when the program goes
  }
  glLinkProgram(id);
  GLint linked = 0;
  glGetProgramiv(id, GL_LINK_STATUS, &linked);
  if (linked != 0) return program;
  std::array<char, 2048> log{};
  glGetProgramInfoLog(id, static_cast<GLsizei>(log.size()), nullptr, log.data());
  return Fault{FaultCode::kNotBuilt, "", std::string("shader ") + name,
               std::string("the driver refuses to link it: ") + log.data(), "use --renderer cpu"};
}

Status loadGl(void (*(*resolver)(const char*))()) {
  if (gladLoadGL(resolver) >= GLAD_MAKE_VERSION(3, 3)) return {};
  return Fault{FaultCode::kNotBuilt, "", "OpenGL", "the driver has no version 3.3", "use --renderer cpu"};
}

Result<GlTable> makeTable(GLenum format, std::span<const std::byte> bytes, std::size_t texel_bytes, int unit,
                          const std::string& place) {
  GLint most_texels = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most_texels);
  const std::size_t texels = bytes.size() / texel_bytes;
  if (texels > static_cast<std::size_t>(most_texels)) {
    return Fault{
        FaultCode::kOutOfMemory, "", place,
        "a table of " + std::to_string(texels) + " texels exceeds the driver's limit of " + std::to_string(most_texels),
        "use --renderer cpu"};
  }
  GlTable table{GlBuffer::create(), GlTexture::create()};
  glBindBuffer(GL_TEXTURE_BUFFER, table.buffer.get());
  glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), GL_STATIC_DRAW);
  table.bind(unit);
  glTexBuffer(GL_TEXTURE_BUFFER, format, table.buffer.get());
  if (Status status = checkGl("upload of a table"); !status.ok()) return status.fault();
  return table;
}

Status checkGl(const char* doing) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return {};
  std::array<char, 32> code{};
  std::snprintf(code.data(), code.size(), "GL error 0x%04x", error);
  const bool no_memory = error == GL_OUT_OF_MEMORY;
  return Fault{no_memory ? FaultCode::kOutOfMemory : FaultCode::kIo, "", doing, code.data(),
               no_memory ? "give a smaller --size or fewer --samples" : "use --renderer cpu"};
}

}  // namespace tet4d::render
