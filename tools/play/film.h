// tet4d-play --offscreen: pictures and films into files.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "player/host/film.h"
#include "player/host/playback.h"
#include "player/scene/shot.h"
#include "tools/play/options.h"

namespace tet4d::play {

// --at, --times, or every frame of the files. Frame numbers count in the table of all files' times.
std::vector<host::PictureTime> timesOf(const Options& options, std::span<const scene::SceneFile> files);
// --camera, or fitted to the files.
scene::Shot shotOf(const Options& options, std::span<const scene::SceneFile> files);
// Null if no film is asked for, only a contact sheet or a camera file.
std::unique_ptr<host::FrameSink> sinkOf(const Options& options, const cli::CommonOptions& common, std::size_t frames);

// Draws what is asked for into files; returns the program's exit code.
int playFilm(cli::Session& session, const Options& options);

}  // namespace tet4d::play
