#include "tools/play/window.h"

#include <algorithm>
#include <string>
#include <vector>

#include "libpreprocess/error.h"
#include "player/host/memory_plan.h"
#include "player/host/output_file.h"
#include "player/host/png.h"
#include "player/host/viewer_files.h"
#include "player/host/window.h"
#include "tools/play/coloring.h"
#include "tools/play/film.h"

namespace tet4d::play {
namespace {

// The window's player, or one picture of it.
host::PlayerRequest requestOf(cli::Session& session, const Options& options) {
  host::PlayerRequest request;
  request.files = options.inputs;
  request.renderer = options.renderer;
  request.threads = static_cast<unsigned>(session.executor().threads());
  request.width = options.size[0];
  request.height = options.size[1];
  request.samples = static_cast<std::uint32_t>(options.samples);
  request.smooth = !options.flat && options.coloring.shading != "flat";
  const std::uint64_t half = session.memory().available() / 2;
  const std::uint64_t usual = session.options().memory_bytes != 0 ? half : host::usualPageBytes();
  request.budget_bytes = std::min(half, usual);
  request.gpu_bytes = std::min(half, options.gpu_memory != 0 ? options.gpu_memory : usual);
  request.ui_scale = options.ui_scale;
  request.budget_ms = options.budget_ms;
  request.typed = options.typed;
  request.quit_after = options.quit_after;
  request.stop = outofcore::interruptRequested;
  request.screenshot = options.screenshot;
  if (options.inputs.empty()) return request;
  std::vector<dyntri::File> opened;
  for (const std::string& input : options.inputs) opened.push_back(unwrap(host::openDynamicTriangles(input)));
  for (std::size_t i = 0; i < opened.size(); ++i)
    request.colorings.push_back(coloringOf(options.coloring, options.inputs[i], opened[i]));
  std::vector<scene::SceneFile> files;
  for (const dyntri::File& file : opened) files.push_back({&file, std::nullopt, true});
  if (!options.at.empty()) request.time = timesOf(options, files).front().time;
  if (!options.camera.empty()) request.shot = shotOf(options, files);
  return request;
}

}  // namespace

int playInWindow(cli::Session& session, const Options& options) {
  if (options.panels)
    throw Error(FaultCode::kUsage, "", "--panels", "draws a picture into a file", "give --offscreen and -o too");
  checkWindow(options);
  refuseFilmOptions(options, session.options());
  unwrap(host::runWindow(requestOf(session, options)));
  session.progress().step(0);  // throws after an interrupt
  return 0;
}

int drawPanels(cli::Session& session, const Options& options) {
  const std::string& output = session.options().output;
  refuseFilmOptions(options, session.options());
  checkWindow(options);
  if (output.empty() || output == "-" || !endsIn(output, ".png") || host::hasNumber(output)) {
    throw Error(FaultCode::kUsage, output, "--panels", "draws one picture, as PNG",
                "give -o player.png, and --at for its time");
  }
  unwrap(host::checkMayWrite(output, session.options().force));
  const render::Image image = unwrap(host::drawWithPanels(requestOf(session, options)));
  unwrap(host::writeFile(output, unwrap(host::encodePng(image, output)), session.options().force));
  return 0;
}

}  // namespace tet4d::play
