#include "libpreprocess/exchange/write_frames.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/header_text.h"
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

void appendVector(std::string& text, const std::array<double, 3>& v) {
  text.append(" (").append(numberText(v[0]));
  text.append(",").append(numberText(v[1]));
  text.append(",").append(numberText(v[2])).append(")");
}

bool areEven(const std::vector<double>& times) {
  const double step = (times.back() - times.front()) / static_cast<double>(std::max<std::size_t>(times.size() - 1, 1));
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (std::abs(times[k] - (times.front() + static_cast<double>(k) * step)) > 1e-9 * step) return false;
  }
  return times.size() > 1;
}

std::string nrrdHeader(const GridInfo& grid, const std::vector<double>& times) {
  std::string text("NRRD0005\ntype: ");
  text.append(nrrdType(grid.type)).append("\ndimension: 4\nspace dimension: 3\nsizes:");
  for (const std::uint64_t size : grid.dims) text.append(" ").append(std::to_string(size));
  text.append(" ").append(std::to_string(times.size())).append("\nspace directions:");
  for (const auto& axis : grid.index_to_world.axes) appendVector(text, axis);
  text.append(" none\nspace origin:");
  appendVector(text, grid.index_to_world.origin);
  if (areEven(times)) {
    const double step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
    text.append("\nspacings: nan nan nan ").append(numberText(step));
    text.append("\naxis mins: nan nan nan ").append(numberText(times.front()));
  }
  text.append("\nkinds: domain domain domain time\nencoding: raw\n");
  if (sampleBytes(grid.type) > 1) text.append("endian: little\n");
  std::string list("times:=");
  for (const double time : times) list.append(numberText(time)).append(" ");
  list.back() = '\n';
  if (list.size() <= kMaxHeaderLineBytes) return text.append(list).append("\n");
  if (areEven(times)) return text.append("\n");
  throw Error(FaultCode::kUsage, "", "", std::to_string(times.size()) + " uneven times are too many for a NRRD header",
              "write fewer frames, or .t4g");
}

}  // namespace

void writeGrid4(const std::string& path, FrameSource& frames, paged::Codec codec, bool force,
                const ProvenanceOf& provenance, outofcore::Progress& progress) {
  grid4::GridHeader header{};
  std::copy(frames.grid().dims.begin(), frames.grid().dims.end(), header.dims);
  header.sample_type = static_cast<std::uint32_t>(frames.grid().type);
  header.index_to_world = frames.grid().index_to_world;
  const bool stream = frames.isStream();
  auto writer =
      unwrap(grid4::Writer::create(path, header, stream ? std::vector<double>{} : frames.times(), codec, force));
  std::vector<std::byte> samples(static_cast<std::size_t>(frames.grid().frameBytes()));
  std::vector<std::uint64_t> digests;
  progress.phase("write", stream ? 0 : frames.times().size());
  for (std::size_t k = 0; frames.hasFrame(k); ++k) {
    frames.readFrame(k, samples);
    unwrap(stream ? writer.addFrame(samples, frames.times()[k]) : writer.addFrame(samples));
    digests.push_back(container::xxh3(samples));
    progress.step(k + 1);
  }
  unwrap(writer.close(provenance(container::xxh3(std::as_bytes(std::span(digests))))));
}

void writeNrrd(const std::string& path, FrameSource& frames, bool force, outofcore::Progress& progress) {
  static_assert(std::endian::native == std::endian::little);
  if (frames.isStream()) {
    throw Error(FaultCode::kUsage, path, "",
                "a NRRD begins with the count of its frames, which a stream tells at its end", "write a .t4g first");
  }
  outofcore::OutputFile file(path, force);
  file.write(nrrdHeader(frames.grid(), frames.times()));
  std::vector<std::byte> layer(static_cast<std::size_t>(frames.grid().layerBytes()));
  progress.phase("write", frames.times().size());
  for (std::size_t k = 0; k < frames.times().size(); ++k) {
    for (std::uint64_t z = 0; z < frames.grid().dims[2]; ++z) {
      frames.readLayers(k, z, z + 1, layer);
      file.write(layer);
    }
    progress.step(k + 1);
  }
  file.commit();
}

}  // namespace tet4d::exchange
