// Faces as OpenMesh reads them, against those a scan of ours has seen. OpenMesh's half-edge meshes drop or split what
// is no manifold and its readers leave faces out in silence; so it hands its faces to an importer of ours, which builds
// no mesh, and every difference is an error.
#include "libpreprocess/error.h"
#include "libpreprocess/exchange/surface_scan.h"

#ifdef TET4D_WITH_OPENMESH

#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/IO/reader/OBJReader.hh>
#include <OpenMesh/Core/IO/reader/OFFReader.hh>
#include <OpenMesh/Core/IO/reader/PLYReader.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>
#include <new>
#include <sstream>

namespace tet4d::exchange {
namespace {

namespace om = OpenMesh;

// Takes vertices and faces as they come and compares faces at once. Everything else a reader may tell is dropped.
class FaceImporter final : public om::IO::BaseImporter {
 public:
  FaceImporter(const std::string& path, const PolygonMesh& scanned) : path_(path), scanned_(scanned) {}

  using BaseImporter::add_vertex;
  om::VertexHandle add_vertex(const om::Vec3f& /*point*/) override { return add_vertex(); }
  om::VertexHandle add_vertex() override {
    if (vertices_ >= scanned_.points.size()) {
      fail("vertex " + std::to_string(vertices_),
           "OpenMesh reads more vertices than the file's " + std::to_string(scanned_.points.size()));
    }
    return om::VertexHandle(static_cast<int>(vertices_++));
  }
  om::FaceHandle add_face(const VHandles& handles) override {
    std::vector<std::uint32_t> got;
    got.reserve(handles.size());
    for (const om::VertexHandle handle : handles) got.push_back(static_cast<std::uint32_t>(handle.idx()));
    if (faces_ >= scanned_.ends.size()) differ("nothing", faceText(got));
    const auto wanted = scanned_.face(faces_);
    if (!std::equal(got.begin(), got.end(), wanted.begin(), wanted.end())) differ(faceText(wanted), faceText(got));
    return om::FaceHandle(static_cast<int>(faces_++));
  }
  // Proves that all of the file was read.
  void finish() override {
    if (faces_ < scanned_.ends.size()) differ(faceText(scanned_.face(faces_)), "nothing");
    if (vertices_ != scanned_.points.size()) {
      fail("vertex " + std::to_string(vertices_), "OpenMesh reads " + std::to_string(vertices_) +
                                                      " vertices, the file has " +
                                                      std::to_string(scanned_.points.size()));
    }
  }
  size_t n_vertices() const override { return vertices_; }
  size_t n_faces() const override { return faces_; }
  size_t n_edges() const override { return 0; }

  om::HalfedgeHandle add_edge(om::VertexHandle /**/, om::VertexHandle /**/) override { return om::HalfedgeHandle(); }
  om::FaceHandle add_face(om::HalfedgeHandle /**/) override { return om::FaceHandle(); }
  void add_face_texcoords(om::FaceHandle /**/, om::VertexHandle /**/, const std::vector<om::Vec2f>& /**/) override {}
  void add_face_texcoords(om::FaceHandle /**/, om::VertexHandle /**/, const std::vector<om::Vec3f>& /**/) override {}
  void set_face_texindex(om::FaceHandle /**/, int /**/) override {}
  void set_point(om::VertexHandle /**/, const om::Vec3f& /**/) override {}
  void set_halfedge(om::VertexHandle /**/, om::HalfedgeHandle /**/) override {}
  void set_normal(om::VertexHandle /**/, const om::Vec3f& /**/) override {}
  void set_normal(om::VertexHandle /**/, const om::Vec3d& /**/) override {}
  void set_color(om::VertexHandle /**/, const om::Vec3uc& /**/) override {}
  void set_color(om::VertexHandle /**/, const om::Vec4uc& /**/) override {}
  void set_color(om::VertexHandle /**/, const om::Vec3f& /**/) override {}
  void set_color(om::VertexHandle /**/, const om::Vec4f& /**/) override {}
  void set_texcoord(om::VertexHandle /**/, const om::Vec2f& /**/) override {}
  void set_status(om::VertexHandle /**/, const om::Attributes::StatusInfo& /**/) override {}
  void set_next(om::HalfedgeHandle /**/, om::HalfedgeHandle /**/) override {}
  void set_face(om::HalfedgeHandle /**/, om::FaceHandle /**/) override {}
  void request_face_texcoords2D() override {}
  void set_texcoord(om::HalfedgeHandle /**/, const om::Vec2f& /**/) override {}
  void set_texcoord(om::VertexHandle /**/, const om::Vec3f& /**/) override {}
  void set_texcoord(om::HalfedgeHandle /**/, const om::Vec3f& /**/) override {}
  void set_status(om::HalfedgeHandle /**/, const om::Attributes::StatusInfo& /**/) override {}
  void set_color(om::EdgeHandle /**/, const om::Vec3uc& /**/) override {}
  void set_color(om::EdgeHandle /**/, const om::Vec4uc& /**/) override {}
  void set_color(om::EdgeHandle /**/, const om::Vec3f& /**/) override {}
  void set_color(om::EdgeHandle /**/, const om::Vec4f& /**/) override {}
  void set_status(om::EdgeHandle /**/, const om::Attributes::StatusInfo& /**/) override {}
  void set_normal(om::FaceHandle /**/, const om::Vec3f& /**/) override {}
  void set_normal(om::FaceHandle /**/, const om::Vec3d& /**/) override {}
  void set_color(om::FaceHandle /**/, const om::Vec3uc& /**/) override {}
  void set_color(om::FaceHandle /**/, const om::Vec4uc& /**/) override {}
  void set_color(om::FaceHandle /**/, const om::Vec3f& /**/) override {}
  void set_color(om::FaceHandle /**/, const om::Vec4f& /**/) override {}
  void set_status(om::FaceHandle /**/, const om::Attributes::StatusInfo& /**/) override {}
  void add_texture_information(int /**/, std::string /**/) override {}

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& what) const {
    throw Error(FaultCode::kBadInput, path_, place, what, "write the file again in its plainest form, or as STL");
  }
  [[noreturn]] void differ(const std::string& wanted, const std::string& got) const {
    fail("face " + std::to_string(faces_), "OpenMesh reads " + got + " where the file has " + wanted);
  }

  const std::string& path_;
  const PolygonMesh& scanned_;
  std::size_t vertices_ = 0, faces_ = 0;
};

// Appends the next words of a line, each with a blank behind.
void copyWords(TextLines& lines, std::uint64_t count, std::string& text) {
  for (std::uint64_t i = 0; i < count; ++i) text.append(lines.word()).push_back(' ');
}

// OFF that scanOff() has passed as OpenMesh takes it: it knows no comments, no empty lines, no counts on the first line
// and not every number that may stand behind the corners. The words that remain are the file's.
std::string plainOff(std::string_view bytes, const std::string& path) {
  TextLines lines(bytes, path);
  lines.nextFilled();
  lines.word();
  if (TextLines(lines).word().empty()) lines.nextFilled();
  const std::uint64_t vertices = lines.count("the count of vertices"), faces = lines.count("the count of faces");
  std::string text = "OFF\n" + std::to_string(vertices) + " " + std::to_string(faces) + " 0\n";
  for (std::uint64_t v = 0; v < vertices && lines.nextFilled(); ++v) {
    copyWords(lines, 3, text);
    text.back() = '\n';
  }
  for (std::uint64_t f = 0; f < faces && lines.nextFilled(); ++f) {
    const std::uint64_t corners = lines.count("the face's count of corners");
    text.append(std::to_string(corners)).push_back(' ');
    copyWords(lines, corners, text);
    text.back() = '\n';
  }
  return text;
}

om::IO::BaseReader& readerOf(const std::string& format) {
  if (format == "OBJ") return om::IO::OBJReader();
  if (format == "OFF") return om::IO::OFFReader();
  return om::IO::PLYReader();
}

}  // namespace

void compareWithOpenMesh(const std::string& path, std::string_view bytes, const PolygonMesh& scanned) {
  omerr().disable();  // it prints what we tell ourselves
  omlog().disable();
  FaceImporter importer(path, scanned);
  om::IO::Options options;
  bool is_read = false;
  try {
    const std::string format = surfaceFormatOf(path);
    if (format == "OFF") {
      std::istringstream text(plainOff(bytes, path));
      is_read = readerOf(format).read(text, importer, options);
    } else {
      is_read = readerOf(format).read(path, importer, options);
    }
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(FaultCode::kOutOfMemory, path, "", "OpenMesh has no memory to read it", "give the machine more");
  } catch (const std::exception& error) {
    throw Error(FaultCode::kBadInput, path, "", std::string("OpenMesh cannot read it: ") + error.what(),
                "write the file again in its plainest form");
  }
  importer.finish();
  if (!is_read) {
    throw Error(FaultCode::kBadInput, path, "", "OpenMesh refuses the file",
                "write the file again in its plainest form");
  }
}

}  // namespace tet4d::exchange

#else

namespace tet4d::exchange {

void compareWithOpenMesh(const std::string& path, std::string_view /*bytes*/, const PolygonMesh& /*scanned*/) {
  throw Error(FaultCode::kNotBuilt, path, "",
              "this build reads no faces of OBJ, OFF and PLY: it was made without OpenMesh",
              "build with -DTET4D_WITH_OPENMESH=ON (libopenmesh-dev), or give STL, sequence.json or .t4q");
}

}  // namespace tet4d::exchange

#endif
