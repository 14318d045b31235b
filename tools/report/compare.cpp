#include "tools/report/compare.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "libpreprocess/exchange/surface_source.h"
#include "libpreprocess/measure/picture_files.h"
#include "libpreprocess/measure/surface_distance.h"
#include "tools/report/rows.h"

namespace tet4d::report {
namespace {

struct Surface {
  std::vector<measure::Point3> points;
  std::vector<measure::Triangle> triangles;
};

Surface readSurface(const std::string& path) {
  const auto source = exchange::openSurfaces({path});
  Surface surface;
  surface.triangles = source->info().triangles;
  std::vector<Vec3f> positions(source->info().vertices);
  source->readFrame(0, positions);
  for (const Vec3f& p : positions) surface.points.push_back(toWorld(source->info().index_to_world, {p.x, p.y, p.z}));
  return surface;
}

Row rowOf(const measure::OneWayDistance& d) {
  return {{"max", number(d.max)},   {"max_bound", number(d.max_bound)},
          {"p99", number(d.p99)},   {"rms", number(d.rms)},
          {"mean", number(d.mean)}, {"sample_spacing", number(d.sample_spacing)},
          {"samples", d.samples},   {"pieces", d.pieces}};
}

std::string lineOf(const char* what, const measure::OneWayDistance& d) {
  return fmt::format("{}  max {:.6g} (at most {:.6g})  p99 {:.6g}  rms {:.6g}  mean {:.6g}\n", what, d.max, d.max_bound,
                     d.p99, d.rms, d.mean);
}

}  // namespace

int compareSurfaces(cli::Session& session, const CompareOptions& options) {
  session.progress().phase("read", 2);
  const Surface a = readSurface(options.a), b = readSurface(options.b);
  session.progress().phase("measure", 1);
  const measure::SurfaceDistance d = measure::surfaceDistance({a.points, a.triangles}, {b.points, b.triangles},
                                                              {options.tolerance, options.samples}, session.executor());
  session.progress().step(1);
  session.stopProgress();
  session.stats().count("triangles", a.triangles.size() + b.triangles.size());
  session.stats().error("max", d.max());
  session.stats().error("rms", d.rms());
  if (options.json) {
    const Row row{{"max", number(d.max())},       {"max_bound", number(d.maxBound())}, {"p99", number(d.p99())},
                  {"rms", number(d.rms())},       {"mean", number(d.mean())},          {"forward", rowOf(d.forward)},
                  {"backward", rowOf(d.backward)}};
    std::fputs((row.dump(2) + "\n").c_str(), stdout);
    return 0;
  }
  std::fputs((lineOf("A to B", d.forward) + lineOf("B to A", d.backward)).c_str(), stdout);
  return 0;
}

int comparePngs(cli::Session& session, const CompareOptions& options) {
  const measure::PictureError error = measure::comparePictureFiles(options.a, options.b);
  session.stopProgress();
  session.stats().error("rmse", error.rmse);
  session.stats().error("max", error.max);
  if (options.json) {
    const Row row{{"rmse", number(error.rmse)}, {"max", number(error.max)}, {"x", error.x}, {"y", error.y}};
    std::fputs((row.dump(2) + "\n").c_str(), stdout);
    return 0;
  }
  std::fputs(
      fmt::format("rmse {:.4f}/255  max {:.2f}/255 at {},{}\n", 255 * error.rmse, 255 * error.max, error.x, error.y)
          .c_str(),
      stdout);
  return 0;
}

}  // namespace tet4d::report
