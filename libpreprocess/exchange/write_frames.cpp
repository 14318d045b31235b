#include "libpreprocess/exchange/write_frames.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/nrrd_fields.h"
#include "libpreprocess/exchange/number_text.h"
#include "libpreprocess/outofcore/output_file.h"

namespace tet4d::exchange {
namespace {

// NRRD's names of the types.
std::string nrrdType(SampleType type) {
  switch (type) {
    case SampleType::kF32:
      return "float";
    case SampleType::kF64:
      return "double";
    default:
      break;
  }
  const std::string name(sampleName(type));  // u8, i16 …
  return (name[0] == 'u' ? "uint" : "int") + name.substr(1);
}

std::string vectorText(const std::array<double, 3>& v) {
  return "(" + numberText(v[0]) + "," + numberText(v[1]) + "," + numberText(v[2]) + ")";
}

bool areEven(const std::vector<double>& times) {
  const double step = (times.back() - times.front()) / static_cast<double>(std::max<std::size_t>(times.size() - 1, 1));
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (std::abs(times[k] - (times.front() + static_cast<double>(k) * step)) > 1e-9 * step) return false;
  }
  return times.size() > 1;
}

std::string nrrdHeader(const GridInfo& grid, const std::vector<double>& times) {
  std::string text = "NRRD0005\ntype: " + nrrdType(grid.type) + "\ndimension: 4\nspace dimension: 3\nsizes:";
  for (const std::uint64_t size : grid.dims) text += " " + std::to_string(size);
  text += " " + std::to_string(times.size()) + "\nspace directions:";
  for (const auto& axis : grid.index_to_world.axes) text += " " + vectorText(axis);
  text += " none\nspace origin: " + vectorText(grid.index_to_world.origin) + "\n";
  if (areEven(times)) {
    const double step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
    text +=
        "spacings: nan nan nan " + numberText(step) + "\naxis mins: nan nan nan " + numberText(times.front()) + "\n";
  }
  text += "kinds: domain domain domain time\nencoding: raw\n";
  if (sampleBytes(grid.type) > 1) text += "endian: little\n";
  std::string list = "times:=";
  for (std::size_t k = 0; k < times.size(); ++k) list += (k == 0 ? "" : " ") + numberText(times[k]);
  if (list.size() <= kMaxNrrdLineBytes) return text + list + "\n\n";
  if (areEven(times)) return text + "\n";
  throw Error(FaultCode::kUsage, "", "", std::to_string(times.size()) + " uneven times are too many for a NRRD header",
              "write fewer frames, or .t4g");
}

}  // namespace

void writeGrid4(const std::string& path, FrameSource& frames, paged::Codec codec, bool force,
                const std::string& provenance, outofcore::Progress& progress) {
  grid4::GridHeader header{};
  std::copy(frames.grid().dims.begin(), frames.grid().dims.end(), header.dims);
  header.frames = frames.times().size();
  header.sample_type = static_cast<std::uint32_t>(frames.grid().type);
  header.index_to_world = frames.grid().index_to_world;
  auto writer = unwrap(grid4::Writer::create(path, header, frames.times(), codec, force));
  std::vector<std::byte> samples(static_cast<std::size_t>(frames.grid().voxels() * sampleBytes(frames.grid().type)));
  progress.phase("write", header.frames);
  for (std::size_t k = 0; k < header.frames; ++k) {
    frames.readFrame(k, samples);
    unwrap(writer.addFrame(samples));
    progress.step(k + 1);
  }
  unwrap(writer.close(provenance));
}

void writeNrrd(const std::string& path, FrameSource& frames, bool force, outofcore::Progress& progress) {
  static_assert(std::endian::native == std::endian::little);
  outofcore::OutputFile file(path, force);
  file.write(nrrdHeader(frames.grid(), frames.times()));
  std::vector<std::byte> samples(static_cast<std::size_t>(frames.grid().voxels() * sampleBytes(frames.grid().type)));
  progress.phase("write", frames.times().size());
  for (std::size_t k = 0; k < frames.times().size(); ++k) {
    frames.readFrame(k, samples);
    file.write(samples);
    progress.step(k + 1);
  }
  file.commit();
}

}  // namespace tet4d::exchange
