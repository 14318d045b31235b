#include "tools/report/peer.h"

#include <filesystem>
#include <fstream>

#include "formats/core/vec.h"
#include "libpreprocess/error.h"

namespace tet4d::report {

PeerRun runPeer(const Programs& programs, const std::vector<std::string>& arguments) {
  PeerRun run;
  const auto script = std::filesystem::path(ownFolder()).parent_path() / "share" / "tet4d" / "peers" / "vtk_peer.py";
  if (std::error_code error; !std::filesystem::exists(script, error)) {
    run.absent = script.filename().string() + " is not installed";
    return run;
  }
  run.child = programs.run(script.string(), arguments);
  if (run.child.exit_code == 127) {
    run.absent = "python is not there: " + run.child.fault;
    return run;
  }
  if (run.child.exit_code != 0) return run;
  run.line = nlohmann::json::parse(run.child.output, nullptr, false);
  if (!run.line.is_object()) {
    run.child.exit_code = 1;
    run.child.fault = "vtk_peer.py printed no JSON";
    return run;
  }
  run.absent = run.line.value("absent", "");
  return run;
}

void addPeer(Row& row, const PeerRun& run) {
  row["exit"] = run.absent.empty() ? run.child.exit_code : 0;
  row["fault"] = run.absent.empty() ? run.child.fault : "";
  if (!run.absent.empty()) {
    row["absent"] = run.absent;
    return;
  }
  if (run.child.exit_code != 0) return;
  row["seconds_wall"] = run.number("seconds_wall");
  row["seconds_cpu"] = run.number("seconds_cpu");
  row["peak_bytes"] = run.line.value("peak_bytes", std::uint64_t{0});
  row["peer_version"] = run.line.value("version", "");
  row["threads"] = 1;
}

template <class T>
std::vector<T> readValues(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const auto bytes = static_cast<std::size_t>(std::max<std::streamoff>(0, file.tellg()));
  std::vector<T> values(bytes / sizeof(T));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
  if (!file || bytes % sizeof(T) != 0)
    throw Error(FaultCode::kIo, path, "", "of the peer cannot be read", "run it again");
  return values;
}
template std::vector<Vec4f> readValues<Vec4f>(const std::string& path);
template std::vector<std::array<std::uint32_t, 4>> readValues<std::array<std::uint32_t, 4>>(const std::string& path);

PeerSurface readPeerSurface(const std::string& base, double step) {
  PeerSurface surface;
  for (const auto& p : readValues<std::array<float, 3>>(base + ".points.f32"))
    surface.points.push_back({double{p[0]} * step, double{p[1]} * step, double{p[2]} * step});
  surface.triangles = readValues<measure::Triangle>(base + ".triangles.u32");
  for (const measure::Triangle& t : surface.triangles) {
    for (const std::uint32_t corner : t) {
      if (corner >= surface.points.size())
        throw Error(FaultCode::kIo, base, "", "has a triangle without its points", "run it again");
    }
  }
  return surface;
}

}  // namespace tet4d::report
