// tet4d-play: dynamic triangles → a window, pictures, films. Ponchio & Hormann 2008, sec. 7.1.
#include "libpreprocess/error.h"
#include "tools/common/cli.h"
#include "tools/play/baseline.h"
#include "tools/play/film.h"
#include "tools/play/options.h"
#include "tools/play/window.h"

namespace {

using namespace tet4d;

int playFiles(cli::Session& session, const play::Options& options) {
  if (!options.offscreen) return play::playInWindow(session, options);
  if (options.panels) return play::drawPanels(session, options);
  if (options.inputs.empty())
    throw Error(FaultCode::kUsage, "", "FILE", "no file is named, and there is no window to open one in",
                "give tet4d-play FILE.t4d --offscreen -o frames/%05d.png");
  if (options.ui_scale)
    throw Error(FaultCode::kUsage, "", "--ui-scale", "scales panels, and there are none", "give --panels too");
  if (options.renderer == "tets") return play::playBaseline(session, options);
  return play::playFilm(session, options);
}

}  // namespace

int main(int argc, char** argv) {
  play::Options o;
  cli::Command command("tet4d-play", "Plays dynamic triangles: pictures or a film at any time, between frames too.");
  play::addOptions(command, o);
  return cli::run(argc, argv, command, [&](cli::Session& session) {
    if (o.renderer == "auto") o.renderer = o.offscreen ? "cpu" : "gl";
    return playFiles(session, o);
  });
}
