// Mesh sequences from files: every format gives the same triangles and positions, nothing is lost or changed in
// silence.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/surface_scan.h"
#include "libpreprocess/exchange/surface_source.h"
#include "libpreprocess/exchange/write_surfaces.h"
#include "tests/formats/support/scratch.h"

namespace tet4d::exchange {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

class Surfaces : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& content) {
    std::ofstream(scratch_.path(name), std::ios::binary) << content;
    return scratch_.path(name);
  }
  static std::vector<Vec3f> frame(SurfaceSource& source, std::size_t k) {
    std::vector<Vec3f> positions(source.info().vertices);
    source.readFrame(k, positions);
    return positions;
  }
  // The fault of opening files and reading all frames.
  static Fault faultOf(const std::vector<std::string>& files, const SurfaceSourceOptions& options = {}) {
    try {
      const auto source = openSurfaces(files, options);
      for (std::size_t k = 0; k < source->info().times.size(); ++k) frame(*source, k);
    } catch (const Error& error) {
      return error.fault();
    }
    return {FaultCode::kUsage, "", "", "no fault", ""};
  }
  test::Scratch scratch_;
};

#define NEEDS_OPENMESH \
  if (!kHasOpenMesh) GTEST_SKIP() << "built without OpenMesh"
#ifdef TET4D_WITH_OPENMESH
constexpr bool kHasOpenMesh = true;
#else
constexpr bool kHasOpenMesh = false;
#endif

// A quad and a triangle over five vertices, the last of which rises.
std::string obj(double top) {
  return "# made by hand\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0\nv +1 1 0\nv 0 1e0 0 1.0\nvt 0 0\nvn 0 0 1\nv .5 "
         ".5 " +
         std::to_string(top) + "\nf 1 2 3 4\nf 1/1/1 -1//1 2/1\n";
}
std::string off(double top) {
  return "OFF\n# counts\n5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n.5 .5 " + std::to_string(top) + "\n4 0 1 2 3\n3 0 4 1\n";
}
std::string plyHeader(const std::string& format, const std::string& real, std::size_t faces = 2) {
  return "ply\nformat " + format + " 1.0\ncomment x\nelement vertex 5\nproperty " + real + " x\nproperty " + real +
         " y\nproperty uchar red\nproperty " + real + " z\nelement face " + std::to_string(faces) +
         "\nproperty list uchar int vertex_indices\nproperty float area\nend_header\n";
}
std::string ply(double top) {
  return plyHeader("ascii", "double") + "0 0 1 0\n1 0 1 0\n1 1 1 0\n0 1 1 0\n.5 .5 1 " + std::to_string(top) +
         "\n4 0 1 2 3 1.5\n3 0 4 1 1.5\n";
}
template <class T>
void put(std::string& out, T value, bool big) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (big) std::reverse(raw, raw + sizeof(T));
  out.append(raw, sizeof(T));
}
std::string binaryPly(float top, bool big) {
  std::string text = plyHeader(big ? "binary_big_endian" : "binary_little_endian", "float");
  const std::array<std::array<float, 3>, 5> points{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {.5F, .5F, top}}};
  for (const auto& p : points) {
    put(text, p[0], big), put(text, p[1], big), put<std::uint8_t>(text, 7, big), put(text, p[2], big);
  }
  for (const auto& face : {std::vector<int>{0, 1, 2, 3}, {0, 4, 1}}) {
    put(text, static_cast<std::uint8_t>(face.size()), big);
    for (const int i : face) put(text, i, big);
    put(text, 1.5F, big);
  }
  return text;
}

const Triangles kExpected{{0, 1, 2}, {0, 2, 3}, {0, 4, 1}};

TEST_F(Surfaces, EveryFormatGivesTheSame) {
  NEEDS_OPENMESH;
  for (const std::string suffix : {"obj", "off", "ply", "le.ply", "be.ply"}) {
    std::vector<std::string> files;
    for (int k = 0; k < 3; ++k) {
      const double top = 0.25 * k;
      files.push_back(write(std::string("a").append(std::to_string(k)).append(".").append(suffix),
                            suffix == "obj"   ? obj(top)
                            : suffix == "off" ? off(top)
                            : suffix == "ply" ? ply(top)
                                              : binaryPly(static_cast<float>(top), suffix == "be.ply")));
    }
    const auto source = openSurfaces(files);
    EXPECT_EQ(source->info().triangles, kExpected) << suffix;
    EXPECT_EQ(source->info().polygons_cut, 1u);
    EXPECT_EQ(source->info().times, (std::vector<double>{0, 1, 2}));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::vector<Vec3f> expected{
          {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {.5F, .5F, 0.25F * static_cast<float>(k)}};
      EXPECT_EQ(frame(*source, k), expected) << suffix << " " << k;
    }
  }
}

TEST_F(Surfaces, LaterFramesMayBeVerticesOnly) {
  NEEDS_OPENMESH;
  const std::string vertices = "v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv .5 .5 9\n";
  auto source = openSurfaces({write("a1.obj", obj(0)), write("a2.obj", vertices)});
  EXPECT_EQ(frame(*source, 1)[4], (Vec3f{.5F, .5F, 9}));
  source = openSurfaces({write("b1.off", off(0)), write("b2.off", "OFF 5 0 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n.5 .5 9\n")});
  EXPECT_EQ(frame(*source, 1)[4], (Vec3f{.5F, .5F, 9}));
  std::string points = plyHeader("ascii", "float", 0) + "0 0 1 1\n1 0 1 1\n1 1 1 1\n0 1 1 1\n.5 .5 1 9\n";
  source = openSurfaces({write("c1.ply", ply(0)), write("c2.ply", points)});
  EXPECT_EQ(frame(*source, 1)[4], (Vec3f{.5F, .5F, 9}));
  EXPECT_NE(faultOf({write("d1.obj", vertices), write("d2.obj", obj(0))}).what.find("no faces"), std::string::npos);
  const Fault fewer = faultOf({scratch_.path("a1.obj"), write("a2.obj", "v 0 0 1\n")});
  EXPECT_NE(fewer.what.find("has 1 vertices, but"), std::string::npos) << fewer.what;
}

TEST_F(Surfaces, TheFirstDifferenceOfConnectivityIsNamed) {
  NEEDS_OPENMESH;
  const std::string first = write("a1.off", off(0));
  std::string turned = off(1), fewer = off(1), more = off(1);
  turned.replace(turned.find("3 0 4 1"), 7, "3 0 1 4");
  fewer.replace(fewer.find("5 2 0"), 5, "5 1 0");
  more.replace(more.find("5 2 0"), 5, "5 3 0") += "3 1 2 4\n";
  Fault fault = faultOf({first, write("a2.off", turned)});
  EXPECT_EQ(fault.place, "face 1");
  EXPECT_NE(fault.what.find("is 0 1 4, but in " + first + " it is 0 4 1"), std::string::npos) << fault.what;
  EXPECT_EQ(fault.file, scratch_.path("a2.off"));
  EXPECT_NE(faultOf({first, write("a2.off", fewer)}).what.find("is missing, but"), std::string::npos);
  EXPECT_EQ(faultOf({first, write("a2.off", more)}).place, "face 2");
}

TEST_F(Surfaces, WhatOpenMeshChangesIsNamed) {
  NEEDS_OPENMESH;
  const std::string text = off(0), path = write("a.off", text);
  PolygonMesh mesh = readSurfaceFile(path);
  EXPECT_NO_THROW(compareWithOpenMesh(path, text, mesh));
  const auto changed = [&](auto change, const std::string& place, const std::string& what) {
    PolygonMesh other = mesh;
    change(other);
    try {
      compareWithOpenMesh(path, text, other);
      ADD_FAILURE() << place << " passed";
    } catch (const Error& error) {
      EXPECT_EQ(error.fault().place, place);
      EXPECT_NE(error.fault().what.find(what), std::string::npos) << error.fault().what;
    }
  };
  changed([](PolygonMesh& m) { std::swap(m.corners[4], m.corners[5]); }, "face 1",
          "reads 0 4 1 where the file has 4 0 1");
  changed([](PolygonMesh& m) { m.ends.pop_back(), m.corners.resize(4); }, "face 1", "where the file has nothing");
  changed(
      [](PolygonMesh& m) {
        m.corners.insert(m.corners.end(), {1, 2, 3}), m.ends.push_back(10);
      },
      "face 2", "reads nothing where the file has 1 2 3");
  changed([](PolygonMesh& m) { m.points.pop_back(); }, "vertex 4", "more vertices");
}

// OpenMesh leaves such faces out without a word.
TEST_F(Surfaces, FacesThatNameAVertexTwiceAreErrors) {
  Fault fault = faultOf({write("a1.obj", obj(0) + "f 1 2 2\n")});
  EXPECT_EQ(fault.place, "line 13");
  EXPECT_NE(fault.what.find("vertex twice"), std::string::npos) << fault.what;
  EXPECT_NE(faultOf({write("a1.obj", obj(0) + "f 1 2\n")}).what.find("fewer than three"), std::string::npos);
  EXPECT_NE(faultOf({write("a1.obj", obj(0) + "f 1 2 9\n")}).what.find("\"9\""), std::string::npos);
}

// Three facets: two share an edge in every frame; the third touches it in the first frame only.
std::string stlFacets(float x) {
  std::string text;
  for (const auto& facet : {std::array<float, 9>{0, 0, 0, 1, 0, 0, 0, 1, 0},
                            {1, 0, 0, 1, 1, 0, 0, 1, 0},
                            {1 + x, 0, 0, 2, 0, x, 1, 1, x}}) {
    text.append(12, '\0');
    for (const float c : facet) put(text, c, false);
    text.append(2, '\0');
  }
  return text;
}
std::string binaryStl(float x) {
  return std::string("solid, and binary all the same").append(50, ' ') + std::string("\3\0\0\0", 4) + stlFacets(x);
}

TEST_F(Surfaces, StlCornersWeldWhereTheyCoincideInEveryFrame) {
  const auto source = openSurfaces({write("a1.stl", binaryStl(0)), write("a2.stl", binaryStl(0.5F))});
  EXPECT_EQ(source->info().vertices, 7u);
  EXPECT_EQ(source->info().triangles, (Triangles{{0, 1, 2}, {1, 3, 2}, {4, 5, 6}}));
  EXPECT_EQ(frame(*source, 0)[4], (Vec3f{1, 0, 0}));
  EXPECT_EQ(frame(*source, 1)[4], (Vec3f{1.5F, 0, 0}));
  EXPECT_EQ(openSurfaces({scratch_.path("a1.stl")})->info().vertices, 5u) << "alone, the first frame is one piece";
}

TEST_F(Surfaces, StlAsTextAndFacetsThatCollapse) {
  const auto facet = [](const std::string& a, const std::string& b, const std::string& c) {
    return "facet normal 0 0 1\n outer loop\n  vertex " + a + "\n  vertex " + b + "\n  vertex " + c +
           "\n endloop\nendfacet\n";
  };
  const std::string first =
      "solid x\n" + facet("0 0 0", "1 0 0", "0 1 0") + facet("1 0 0", "1 0 0", "0 1 0") + "endsolid x\n";
  const std::string second =
      "solid x\n" + facet("0 0 0", "1 0 0", "0 1 0") + facet("1 0 0", "1 1 0", "0 1 0") + "endsolid x\n";
  EXPECT_EQ(openSurfaces({write("a1.stl", first), write("a2.stl", first)})->info().collapsed, 1u);
  const auto source = openSurfaces({write("a1.stl", first), write("a2.stl", second)});
  EXPECT_EQ(source->info().triangles, (Triangles{{0, 1, 2}, {1, 3, 2}})) << "of no area in the first frame only";
}

TEST_F(Surfaces, FarFromTheOriginNothingIsLost) {
  NEEDS_OPENMESH;
  const auto far = [](double z) {
    return "v 10000000.25 -2e7 0\nv 10000001.25 -20000000 0\nv 10000000.25 -19999999.0009765625 " + std::to_string(z) +
           "\nf 1 2 3\n";
  };
  const auto source = openSurfaces({write("a1.obj", far(0)), write("a2.obj", far(1))});
  const auto positions = frame(*source, 1);
  const auto world = [&](std::size_t i) {
    return toWorld(source->info().index_to_world, {positions[i].x, positions[i].y, positions[i].z});
  };
  EXPECT_EQ(world(0), (std::array<double, 3>{10000000.25, -2e7, 0}));
  EXPECT_EQ(world(2), (std::array<double, 3>{10000000.25, -19999999.0009765625, 1}));
  // Near the origin the map is none.
  const auto near = openSurfaces({write("b1.obj", obj(1)), write("b2.obj", obj(2))});
  EXPECT_EQ(near->info().index_to_world, AffineMap{});
}

std::string packed(const std::string& bytes) {
  std::string out(compressBound(bytes.size()) + 64, '\0');
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}
template <class T>
std::string bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}
std::string json(const std::string& vertices, const std::string& more = "") {
  return R"({"vertices": 4, "triangles": 2, "frames": 2, "triangles_file": "t.i32", "vertices_file": ")" + vertices +
         "\"" + more + "}";
}

TEST_F(Surfaces, RawArraysWithADescription) {
  write("t.i32", bytesOf(std::vector<std::int32_t>{0, 1, 2, 1, 3, 2}));
  const std::vector<float> floats{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 2.5F};
  std::vector<std::int16_t> shorts;
  std::vector<double> doubles(floats.begin(), floats.end());
  for (const float f : floats) shorts.push_back(static_cast<std::int16_t>(f * 2));
  write("v.f32", bytesOf(floats)), write("v.f32.gz", packed(bytesOf(floats)));
  write("v.i16", bytesOf(shorts)), write("v.f64.gz", packed(bytesOf(doubles)));
  for (const auto& [vertices, more] :
       {std::pair{"v.f32", ""}, {"v.f32.gz", ", \"times\": [5, 7]"}, {"v.i16", ", \"scale\": 0.5"}, {"v.f64.gz", ""}}) {
    const auto source = openSurfaces({write("sequence.json", json(vertices, more))});
    EXPECT_EQ(source->info().triangles, (Triangles{{0, 1, 2}, {1, 3, 2}}));
    EXPECT_EQ(source->info().times.front(), std::string(more).find("times") != std::string::npos ? 5 : 0);
    EXPECT_EQ(frame(*source, 1)[3], (Vec3f{1, 1, 2.5F})) << vertices;
    EXPECT_EQ(frame(*source, 0)[3], (Vec3f{1, 1, 0})) << "back again, " << vertices;
  }
  write("short.f32", bytesOf(std::vector<float>(23)));
  EXPECT_NE(faultOf({write("s.json", json("short.f32"))}).what.find("the counts make 96"), std::string::npos);
  write("t.i32", bytesOf(std::vector<std::int32_t>{0, 1, 2, 1, -3, 2}));
  EXPECT_EQ(faultOf({write("s.json", json("v.f32"))}).place, "triangle 1");
}

TEST_F(Surfaces, KeysOfADescriptionAreNamedWithWhatWasFound) {
  const auto expect = [&](const std::string& text, const std::string& place, const std::string& what) {
    const std::string path = write("s.json", text);
    const Fault fault = faultOf({path});
    EXPECT_EQ(fault.file, path) << text;
    EXPECT_EQ(fault.place, place) << text;
    EXPECT_NE(fault.what.find(what), std::string::npos) << fault.what;
    EXPECT_NE(fault.remedy.find("vertices, triangles, frames"), std::string::npos) << fault.remedy;
    EXPECT_EQ((fault.what + fault.remedy).find("json."), std::string::npos) << "a library speaks: " << fault.what;
  };
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = json("v.f32");
    return text.replace(text.find(from), from.size(), to);
  };
  expect("{", "byte 2", "no JSON");
  expect("[1, 2]", "", "holds an array");
  expect("{\"vertices\": 1e999}", "", "beyond float64");
  expect("{}", "key vertices", "is missing");
  expect(with("\"vertices\": 4, ", ""), "key vertices", "is missing");
  expect(with("\"vertices\": 4", "\"vertices\": -1"), "key vertices", "is -1, not a count");
  expect(with("\"vertices\": 4", "\"vertices\": 4.5"), "key vertices", "is 4.5, not a count");
  expect(with("\"triangles\": 2", "\"triangles\": \"2\""), "key triangles", "is a text, not a count");
  expect(with("\"frames\": 2", "\"frames\": 18446744073709551615"), "key frames", "not a count from 1 to 16777216");
  expect(with("\"t.i32\"", "7"), "key triangles_file", "is 7, not a file's name");
  expect(with("\"v.f32\"", "\"\""), "key vertices_file", "is an empty text");
  expect(json("v.f32", ", \"scale\": null"), "key scale", "is null, not a number");
  expect(json("v.f32", ", \"scale\": 0"), "key scale", "other than 0");
  expect(json("v.f32", ", \"times\": {}"), "key times", "is an object, not an array");
  expect(json("v.f32", ", \"times\": [7]"), "key times", "has 1 times, but frames is 2");
  expect(json("v.f32", ", \"times\": [7, true]"), "key times 1", "is true, not a number");
  expect(json("v.f32", ", \"times\": [7, 5]"), "key times 1", "not later");
}

TEST_F(Surfaces, MeshesBesideVolumesAreRefused) {
  std::filesystem::create_directory(scratch_.path("d"));
  write("d/b2.stl", binaryStl(0)), write("d/b10.stl", binaryStl(0)), write("d/a.nrrd", "NRRD0004\n");
  const auto what = [](const std::vector<std::string>& inputs) -> std::string {
    try {
      return areSurfaces(inputs) ? "meshes" : "none";
    } catch (const Error& error) {
      return error.fault().what;
    }
  };
  EXPECT_EQ(what({scratch_.path("d")}), "a directory of two kinds: " + scratch_.path("d/b2.stl") + " is a mesh, " +
                                            scratch_.path("d/a.nrrd") + " a volume");
  EXPECT_EQ(what({"a.nrrd", "b.obj"}), "a list of two kinds: b.obj is a mesh, a.nrrd is none");
  EXPECT_EQ(what({"b.obj", "a.nrrd"}), what({"a.nrrd", "b.obj"}));
  EXPECT_EQ(what({"a.nrrd", "b.nrrd"}), "none");
}

TEST_F(Surfaces, OffWithColoursAndCountsOnTheFirstLine) {
  NEEDS_OPENMESH;
  const std::string points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n.5 .5 1\n";
  const std::string coloured = "0 0 0 255 0 0 255\n1 0 0 1 2 3 4\n1 1 0 1 2 3 4\n0 1 0 1 2 3 4 # x\n.5 .5 1 1 2 3 4\n";
  for (const std::string& text :
       {"OFF 5 2 0\n" + points + "4 0 1 2 3 255 0 0\n3 0 4 1 255 0 0 128\n",
        "OFF 5 2\n" + points + "4 0 1 2 3\n3 0 4 1\n", "OFF\n5 2 0\n" + points + "4 0 1 2 3 0.5 0.25 1\n3 0 4 1 7\n",
        "COFF # colours\n\n5 2 0\n" + coloured + "4 0 1 2 3 1 2\n\n3 0 4 1 1 2 3 4 5 6\nthe end 9 9\n"}) {
    const auto source = openSurfaces({write("a.off", text)});
    EXPECT_EQ(source->info().triangles, kExpected) << text;
    EXPECT_EQ(frame(*source, 0)[4], (Vec3f{.5F, .5F, 1})) << text;
  }
}

TEST_F(Surfaces, FacesInMessagesAreShort) {
  const std::vector<std::uint32_t> many{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  EXPECT_EQ(faceText(std::span(many).first(0)), "no corners");
  EXPECT_EQ(faceText(std::span(many).first(8)), "0 1 2 3 4 5 6 7");
  EXPECT_EQ(faceText(many), "0 1 2 3 4 5 6 7 ... (10 corners)");
  std::string text = off(0);
  text.replace(text.find("3 0 4 1"), 7, "0");
  EXPECT_EQ(faultOf({write("a.off", text)}).what, "the face has no corners");
}

// OpenMesh takes the first number of a face for its count of corners.
TEST_F(Surfaces, PlyWithAPropertyInFrontOfTheCornersIsRefused) {
  std::string header = plyHeader("ascii", "float");
  const std::string area = "property float area\n";
  header.erase(header.find(area), area.size()).insert(header.find("property list"), area);
  const Fault fault = faultOf({write("a.ply", header + "0 0 1 0\n1 0 1 0\n1 1 1 0\n0 1 1 0\n.5 .5 1 1\n"
                                                       "1.5 4 0 1 2 3\n1.5 3 0 4 1\n")});
  EXPECT_NE(fault.what.find("area in front of vertex_indices"), std::string::npos) << fault.what;
  EXPECT_NE(fault.remedy.find("first property"), std::string::npos) << fault.remedy;
}

TEST_F(Surfaces, ASurfaceSequenceGivesWhatWasWritten) {
  auto source =
      openSurfaces({write("a1.stl", binaryStl(0)), write("a2.stl", binaryStl(0.5F))}, {.times = {1.7e9, 1.7e9 + 1}});
  std::uint64_t digest = 0;
  outofcore::Progress progress;
  const auto keep = [&](std::uint64_t value) {
    digest = value;
    return std::string("{}");
  };
  writeSurfaceSequence(scratch_.path("a.t4q"), *source, paged::Codec::kRaw, true, keep, progress);
  const auto read = openSurfaces({scratch_.path("a.t4q")});
  EXPECT_EQ(read->info().triangles, source->info().triangles);
  EXPECT_EQ(read->info().times, source->info().times);
  SurfaceDigest again(read->info());
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(frame(*read, k), frame(*source, k));
    again.add(frame(*read, k));
  }
  EXPECT_EQ(again.value(), digest);
}

TEST_F(Surfaces, NamesOfSequences) {
  std::filesystem::create_directory(scratch_.path("d"));
  for (const int k : {8, 9, 10})
    write(std::string("d/a").append(std::to_string(k)).append(".stl"), binaryStl(static_cast<float>(k)));
  write("d/readme.txt", "x");
  for (const std::string& input : {scratch_.path("d"), scratch_.path("d/a%d.stl")}) {
    EXPECT_TRUE(areSurfaces({input})) << input;
    const auto source = openSurfaces({input});
    EXPECT_EQ(source->info().times.size(), 3u);
    EXPECT_EQ(frame(*source, 2)[4].x, 11) << "in order of numbers";
  }
  std::filesystem::remove(scratch_.path("d/a9.stl"));
  write("d/a11.stl", binaryStl(0));
  EXPECT_NE(faultOf({scratch_.path("d")}).what, "no fault") << "a hole";
  EXPECT_EQ(openSurfaces({scratch_.path("d")}, {.allow_gaps = true, .times = {}})->info().times,
            (std::vector<double>{0, 2, 3}));
  EXPECT_NE(faultOf({scratch_.path("d")}, {.allow_gaps = true, .times = {1, 2}}).what, "no fault") << "too few times";
  write("d/b.obj", obj(0));
  EXPECT_NE(faultOf({scratch_.path("d")}).what.find("two kinds"), std::string::npos);
  EXPECT_FALSE(areSurfaces({"a.nrrd"}));
  EXPECT_TRUE(areSurfaces({"a.PLY"}));
}

TEST_F(Surfaces, WithoutOpenMeshFacesSayHowToGetThem) {
  if (kHasOpenMesh) GTEST_SKIP() << "OpenMesh is there";
  const Fault fault = faultOf({write("a1.obj", obj(0))});
  EXPECT_EQ(fault.code, FaultCode::kNotBuilt);
  EXPECT_NE(fault.remedy.find("TET4D_WITH_OPENMESH"), std::string::npos);
}

// Hostile files: damage is named or harmless, and costs no more than the file's size.
TEST_F(Surfaces, EveryPrefixAndFlippedByteIsSurvived) {
  const std::vector<std::pair<std::string, std::string>> good{{"a.obj", obj(1)},
                                                              {"a.off", off(1)},
                                                              {"a.ply", ply(1)},
                                                              {"le.ply", binaryPly(1, false)},
                                                              {"be.ply", binaryPly(1, true)},
                                                              {"a.stl", binaryStl(1)}};
  for (const auto& [name, bytes] : good) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const Fault fault = faultOf({write(name, bytes.substr(0, size))});
      if (name != "a.obj" && size + 4 < bytes.size()) {
        EXPECT_NE(fault.what, "no fault") << name << " " << size;
      }
    }
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      for (const char flip : {'\x10', '\xff'}) {
        std::string bad = bytes;
        bad[at] = static_cast<char>(bad[at] ^ flip);
        const Fault fault = faultOf({write(name, bad)});
        EXPECT_TRUE(fault.what == "no fault" || !fault.file.empty()) << name << " " << at;
      }
    }
  }
}

TEST_F(Surfaces, CountsBeyondTheFileAndBadNumbersAreNamed) {
  const auto what = [&](const std::string& name, std::string content, const std::string& from, const std::string& to) {
    content.replace(content.find(from), from.size(), to);
    return faultOf({write(name, content)}).what;
  };
  EXPECT_NE(what("a.off", off(0), "5 2 0", "4000000000 2 0").find("do not fit"), std::string::npos);
  EXPECT_NE(what("a.off", off(0), "5 2 0", "5 99999999999 0").find("do not fit"), std::string::npos);
  EXPECT_NE(what("a.off", off(0), "4 0 1", "99999999999 0 1").find("names vertex \"\""), std::string::npos);
  EXPECT_NE(what("a.off", off(0), "OFF", "OFF BINARY").find("binary"), std::string::npos);
  EXPECT_NE(what("a.ply", ply(0), "vertex 5", "vertex 2000000000").find("do not fit"), std::string::npos);
  EXPECT_NE(what("a.ply", ply(0), "vertex 5", "vertex 99999999999999999999").find("not a count"), std::string::npos);
  EXPECT_NE(what("a.ply", ply(0), "4 0 1", "9999999 0 1").find("list of"), std::string::npos);
  EXPECT_NE(what("a.ply", ply(0), "4 0 1", "-1 0 1").find("list of"), std::string::npos);
  EXPECT_NE(what("a.ply", ply(0), ".5", "nan").find("not finite"), std::string::npos);
  EXPECT_NE(what("a.obj", obj(0), ".5", "inf").find("not a finite number"), std::string::npos);
  EXPECT_NE(what("a.obj", obj(0), "+1", "1e999").find("not a finite number"), std::string::npos);
  EXPECT_NE(what("a.obj", obj(0), "+1", "0x1").find("not a finite number"), std::string::npos);
  std::string stl = binaryStl(0);
  const float nan = std::nanf("");
  std::memcpy(stl.data() + 84 + 50 + 12, &nan, 4);
  const Fault fault = faultOf({write("a.stl", stl)});
  EXPECT_EQ(fault.place, "facet 1, byte 134");
  const std::string big = "v 1e39 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_NE(faultOf({write("a.obj", big)}).what, "no fault") << "beyond float32";
}

}  // namespace
}  // namespace tet4d::exchange
