#include "tests/player/swept_mesh.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "formats/core/tet_slice.h"

namespace tet4d::test {
namespace {

std::array<double, 3> unit(std::array<double, 3> v) {
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (double& c : v) c /= length;
  return v;
}

Surface icosahedron() {
  const double phi = (1 + std::sqrt(5.0)) / 2;
  Surface s;
  s.vertices = {{-1, phi, 0},  {1, phi, 0},  {-1, -phi, 0}, {1, -phi, 0}, {0, -1, phi},  {0, 1, phi},
                {0, -1, -phi}, {0, 1, -phi}, {phi, 0, -1},  {phi, 0, 1},  {-phi, 0, -1}, {-phi, 0, 1}};
  for (auto& v : s.vertices) v = unit(v);
  s.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return s;
}

Vec4f toVec4f(const std::array<double, 3>& p, double t) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]), static_cast<float>(t)};
}

// Collects the dynamic triangles of tetrahedra over shared vertices.
class PageBuilder {
 public:
  explicit PageBuilder(std::vector<Vec4f> vertices) { page_.vertices = std::move(vertices); }

  // outside: the direction, at the tetrahedron, in which the triangles must face.
  void addTet(const std::array<std::uint32_t, 4>& tet, const std::array<double, 3>& outside) {
    const auto t = [&](std::size_t k) { return page_.vertices[tet[k]].t; };
    const TimeOrder order = orderByTime(t(0), t(1), t(2), t(3));
    for (const DynTriRule& rule : kDynTriRules) {
      const float begin = t(order.at[rule.begin]), end = t(order.at[rule.end]);
      if (!(begin < end)) continue;
      dyntri::Triangle triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& ends = kTetEdges[rule.edges[k]];
        triangle[k] = edgeOf(tet[order.at[ends[0]]], tet[order.at[ends[1]]]);
      }
      if (faces(triangle, (begin + end) / 2, outside) < 0) std::swap(triangle[1], triangle[2]);
      page_.triangles.push_back(triangle);
      page_.lifespans.push_back({begin, end});
    }
  }

  Page finish() {
    std::vector<std::size_t> order(page_.triangles.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return page_.lifespans[a].begin < page_.lifespans[b].begin; });
    Page sorted{page_.vertices, page_.edges, {}, {}};
    for (const std::size_t i : order) {
      sorted.lifespans.push_back(page_.lifespans[i]);
      sorted.triangles.push_back(page_.triangles[i]);
    }
    return sorted;
  }

 private:
  std::uint32_t edgeOf(std::uint32_t a, std::uint32_t b) {
    const auto [at, is_new] = edge_of_.try_emplace({a, b}, static_cast<std::uint32_t>(page_.edges.size()));
    if (is_new) page_.edges.push_back({a, b});
    return at->second;
  }
  double faces(const dyntri::Triangle& triangle, float t, const std::array<double, 3>& outside) const {
    std::array<Vec3f, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = page_.edges[triangle[k]];
      p[k] = interpolateAt(page_.vertices[a], page_.vertices[b], t);
    }
    const double ux = p[1].x - p[0].x, uy = p[1].y - p[0].y, uz = p[1].z - p[0].z;
    const double vx = p[2].x - p[0].x, vy = p[2].y - p[0].y, vz = p[2].z - p[0].z;
    return (uy * vz - uz * vy) * outside[0] + (uz * vx - ux * vz) * outside[1] + (ux * vy - uy * vx) * outside[2];
  }

  Page page_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edge_of_;
};

std::array<double, 3> normalOf(const Surface& s, const std::array<std::uint32_t, 3>& triangle) {
  const auto &a = s.vertices[triangle[0]], &b = s.vertices[triangle[1]], &c = s.vertices[triangle[2]];
  const std::array<double, 3> u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

}  // namespace

Surface icosphere(int subdivisions) {
  Surface s = icosahedron();
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle_of;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] = middle_of.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(s.vertices.size()));
      if (is_new) {
        const auto p = s.vertices[a], q = s.vertices[b];
        s.vertices.push_back(unit({p[0] + q[0], p[1] + q[1], p[2] + q[2]}));
      }
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : s.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    s.triangles = finer;
  }
  return s;
}

Page sweep(const Surface& surface, const Motion& motion, int first, int last) {
  std::vector<Vec4f> vertices;
  for (int frame = first; frame <= last; ++frame) {
    for (const auto& p : surface.vertices) vertices.push_back(toVec4f(motion(p, frame), frame));
  }
  PageBuilder builder(std::move(vertices));
  const auto per_frame = static_cast<std::uint32_t>(surface.vertices.size());
  for (int frame = first; frame < last; ++frame) {
    const std::uint32_t low = static_cast<std::uint32_t>(frame - first) * per_frame, high = low + per_frame;
    for (const auto& triangle : surface.triangles) {
      // By ascending vertex number, so that neighbouring prisms cut their common wall alike.
      auto [a, b, c] = triangle;
      if (a > b) std::swap(a, b);
      if (b > c) std::swap(b, c);
      if (a > b) std::swap(a, b);
      const auto outside = normalOf(surface, triangle);
      builder.addTet({low + a, low + b, low + c, high + c}, outside);
      builder.addTet({low + a, low + b, high + b, high + c}, outside);
      builder.addTet({low + a, high + a, high + b, high + c}, outside);
    }
  }
  return builder.finish();
}

std::array<double, 3> MovingSphere::centreAt(double t) const {
  return {start[0] + t * velocity[0], start[1] + t * velocity[1], start[2] + t * velocity[2]};
}

Motion MovingSphere::motion() const {
  return [sphere = *this](const std::array<double, 3>& p, double t) {
    const auto c = sphere.centreAt(t);
    const double r = sphere.radiusAt(t);
    return std::array<double, 3>{c[0] + r * p[0], c[1] + r * p[1], c[2] + r * p[2]};
  };
}

const std::string& temporaryDirectory() {
  struct Directory {
    std::string path = testing::TempDir() + "tet4d-player-" + std::to_string(::getpid());
    Directory() { std::filesystem::create_directories(path); }
    ~Directory() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Directory kDirectory;
  return kDirectory.path;
}

std::string writeFile(const std::string& name, const std::vector<Page>& pages, const FileSpec& spec) {
  std::vector<dyntri::PageView> views;
  for (const Page& page : pages) views.push_back(page.view());
  return writeViews(name, views, spec);
}

std::string writeViews(const std::string& name, std::span<const dyntri::PageView> pages, const FileSpec& spec) {
  const std::string path = temporaryDirectory() + "/" + name;
  dyntri::Header header{};
  header.index_to_world = spec.map;
  header.last_time = static_cast<float>(spec.times.size() - 1);
  std::vector<Column> columns;
  for (const TestColumn& column : spec.columns) columns.push_back(column.column);
  auto writer = dyntri::Writer::create(path, header, spec.times, spec.codec, true, columns, spec.part_isovalues);
  if (!writer.ok()) throw std::runtime_error(writer.fault().what);
  for (std::size_t k = 0; k < pages.size(); ++k) {
    dyntri::PageView view = pages[k];
    if (k < spec.part_of_page.size()) view.part = spec.part_of_page[k];
    std::vector<std::vector<float>> rows(spec.columns.size());
    for (std::size_t c = 0; c < rows.size(); ++c) {
      for (const Vec4f& v : view.vertices) {
        for (const float x : spec.columns[c].row(v)) rows[c].push_back(x);
      }
    }
    const std::vector<std::span<const float>> spans(rows.begin(), rows.end());
    if (Status s = writer.value().addPage(view, 0, 0, spans); !s.ok()) throw std::runtime_error(s.fault().what);
  }
  if (Status s = writer.value().close("{}"); !s.ok()) throw std::runtime_error(s.fault().what);
  return path;
}

std::string writeTestSphere(const std::string& name, int frames, const AffineMap& map) {
  const Surface surface = icosphere(3);
  std::vector<Page> pages;
  FileSpec spec{map, {0}, paged::Codec::kRaw};
  for (int frame = 0; frame + 1 < frames; ++frame) {
    pages.push_back(sweep(surface, kTestSphere.motion(), frame, frame + 1));
    spec.times.push_back(frame + 1);
  }
  return writeFile(name, pages, spec);
}

std::string writeColumnSphere(const std::string& name, int frames) {
  const Surface surface = icosphere(3);
  std::vector<Page> pages;
  FileSpec spec{{}, {0}, paged::Codec::kRaw};
  for (int frame = 0; frame + 1 < frames; ++frame) {
    pages.push_back(sweep(surface, kTestSphere.motion(), frame, frame + 1));
    spec.times.push_back(frame + 1);
  }
  spec.columns = {{{"speed [m/s]", 1},
                   [](const Vec4f& v) {
                     return std::vector{v.t == 0 ? std::numeric_limits<float>::quiet_NaN() : 100 * v.x + 10 * v.t};
                   }},
                  {{"velocity", 3},
                   [](const Vec4f& v) {
                     return std::vector{v.t, 0.5f * v.t, 0.0f};
                   }},
                  {{"normal", 3}, [](const Vec4f& v) {
                     const auto c = kTestSphere.centreAt(double{v.t});
                     const double r = kTestSphere.radiusAt(double{v.t});
                     return std::vector{static_cast<float>((double{v.x} - c[0]) / r),
                                        static_cast<float>((double{v.y} - c[1]) / r),
                                        static_cast<float>((double{v.z} - c[2]) / r)};
                   }}};
  return writeFile(name, pages, spec);
}

std::string writeParts(const std::string& name) {
  const Surface surface = icosphere(2);
  std::vector<Page> pages;
  for (int part = 0; part < 3; ++part)
    pages.push_back(sweep(surface, MovingSphere{{4.0 + 10 * part, 4, 4}, {0.5, 0, 0}, 4, -0.5}.motion(), 0, 1));
  return writeFile(
      name, pages,
      {{}, {0, 1}, paged::Codec::kRaw, {}, {0.1, 0.5, std::numeric_limits<double>::quiet_NaN()}, {0, 1, 2}});
}

}  // namespace tet4d::test
