#include "player/host/viewer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>
#include <set>
#include <sstream>

#include "player/scene/shot_file.h"
#include "tests/player/picture.h"
#include "tests/player/viewer_stage.h"

namespace tet4d::host {
namespace {

ViewerOptions small() {
  ViewerOptions options;
  options.width = 900;
  options.height = 560;
  options.samples = 1;
  return options;
}

std::string sphere(const std::string& name, int frames = 4) { return test::writeTestSphere(name, frames); }

std::string textOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// Everything a key may change, as text.
std::string fingerprint(Viewer& viewer) {
  const ViewerState& s = viewer.state();
  std::ostringstream out;
  const Timeline& t = s.timeline;
  out << t.time() << ' ' << t.playing() << t.backward() << int(t.loop()) << ' ' << t.speed() << ' ' << t.begin() << ' '
      << t.end() << ' ' << s.smooth << s.legend << s.panels << s.help << s.quit << ' ' << s.messages.size()
      << (viewer.recorder() != nullptr) << scene::formatShot(viewer.shot());
  for (const auto& file : viewer.files().all()) out << (file != nullptr ? file->coloring.lit : false);
  return out.str();
}

double darkShare(const render::Image& image, const scene::Frame& frame) {
  double dark = 0, all = 0;
  for (auto y = static_cast<std::uint32_t>(frame.top); y < frame.top + frame.height; ++y) {
    for (auto x = static_cast<std::uint32_t>(frame.left); x < frame.left + frame.width; ++x, ++all)
      dark += image.row(y)[4 * x] < 90 && image.row(y)[4 * x + 2] < 110 ? 1 : 0;
  }
  return dark / all;
}

TEST(Viewer, PanelsAreSeenAndTabHidesThem) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_panels.t4d"));
  const scene::Frame side{20, 20, 250, 250}, bar{20, 480, 860, 60}, middle{500, 100, 200, 200};
  const render::Image with = stage.screenshot();
  EXPECT_GT(darkShare(with, side), 0.7);
  EXPECT_GT(darkShare(with, bar), 0.6);
  EXPECT_LT(darkShare(with, middle), 0.2);
  stage.key(Key::kTab);
  const render::Image without = stage.screenshot();
  EXPECT_LT(darkShare(without, side), 0.05);
  EXPECT_LT(darkShare(without, bar), 0.05);
  EXPECT_EQ(test::compare(without, stage->picture()).largest, 0) << "without panels the window is the picture";
}

TEST(Viewer, TheDataStandsWhereThePanelsLeaveRoom) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_room.t4d"));
  const scene::Frame free = stage->freeFrame();
  const scene::WorldBox box = stage->files().box();
  for (const glm::dvec3& corner : box.corners) {
    const glm::dvec2 at = scene::project(stage->state().shot.view, {900, 560}, box.centre + corner).pixel;
    EXPECT_GE(at.x, free.left);
    EXPECT_LE(at.x, free.left + free.width);
    EXPECT_GE(at.y, free.top);
    EXPECT_LE(at.y, free.top + free.height);
  }
}

TEST(Viewer, ClickingPlayPlaysAndPauses) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_play.t4d"));
  const double start = stage->state().timeline.time();
  ASSERT_FALSE(stage->state().timeline.playing());
  stage.click("play");
  EXPECT_TRUE(stage->state().timeline.playing());
  EXPECT_NE(stage->state().timeline.time(), start);
  stage.click("play");
  EXPECT_FALSE(stage->state().timeline.playing());
  stage.rest();
  EXPECT_EQ(stage.rest(), 0) << "nothing moves, nothing is drawn";
}

TEST(Viewer, AQuickClickWithinOneFrameCounts) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_quick.t4d"));
  const auto centre = stage->state().places.at("forward").centre();
  stage.moveTo(centre.x, centre.y);
  stage.press(true);
  stage.press(false);
  stage->frame(0.01);
  stage.rest();
  EXPECT_NEAR(stage->state().timeline.frame(), 1, 1e-9);
}

TEST(Viewer, DraggingTheTimeLineScrubs) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_scrub.t4d"));
  const scene::Frame line = stage->state().places.at("time line");
  const double y = line.centre().y;
  stage.drag(line.left + 10, y, line.left + 6 + 0.75 * (line.width - 12), y);
  EXPECT_NEAR(stage->state().timeline.frame(), 0.75 * 3, 0.02);
  EXPECT_FALSE(stage->state().timeline.playing());
  stage.drag(line.left + 100, y, line.left + line.width + 500, y);
  EXPECT_EQ(stage->state().timeline.time(), stage->state().timeline.last());
  EXPECT_GT(stage->state().stats.drawn, 0u) << "the last moment is drawn";
}

TEST(Viewer, DraggingThePictureTurnsAndMovesTheView) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_drag.t4d"));
  const scene::View before = stage->state().shot.view;
  const glm::dvec3 centre = stage->files().box().centre;
  stage.drag(600, 200, 650, 230);
  const scene::View turned = stage->state().shot.view;
  EXPECT_GT(glm::length(turned.eye - before.eye), 0.1);
  EXPECT_NEAR(glm::length(turned.eye - centre), glm::length(before.eye - centre), 1e-9);
  const glm::dvec2 at = scene::project(turned, {900, 560}, centre).pixel;
  stage.drag(600, 200, 500, 300, 1);
  const glm::dvec2 moved = scene::project(stage->state().shot.view, {900, 560}, centre).pixel;
  EXPECT_NEAR(moved.x - at.x, -100, 1e-6);
  EXPECT_NEAR(moved.y - at.y, 100, 1e-6);
  // Over a panel the mouse is the panel's.
  const std::string still = fingerprint(*stage);
  stage.drag(150, 30, 180, 34);
  EXPECT_EQ(fingerprint(*stage), still);
}

TEST(Viewer, TheWheelGoesNearerAboutTheCursor) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_wheel.t4d"));
  const scene::View before = stage->state().shot.view;
  const glm::dvec3 centre = stage->files().box().centre;
  const glm::dvec3 under = scene::pointUnder(before, {900, 560}, centre, {640, 210});
  stage.moveTo(640, 210);
  stage->handle(Scrolled{3});
  stage.rest();
  const scene::View& view = stage->state().shot.view;
  EXPECT_LT(glm::length(view.eye - centre), glm::length(before.eye - centre));
  EXPECT_NEAR(glm::length(scene::project(view, {900, 560}, under).pixel - glm::dvec2(640, 210)), 0, 1e-6);
}

TEST(Viewer, QuestionMarkShowsTheKeys) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_help.t4d"));
  stage.key(Key::kEscape);  // the hint for newcomers goes
  const render::Image before = stage.screenshot();
  stage.type(U'?');
  EXPECT_TRUE(stage->state().help);
  EXPECT_GT(darkShare(stage.screenshot(), {350, 100, 400, 300}), 0.6);
  stage.key(Key::kEscape);
  EXPECT_FALSE(stage->state().help);
  EXPECT_LT(test::compare(before, stage.screenshot()).rms, 6) << "but for the graph";
}

TEST(Viewer, EveryKeyOfTheTableDoesSomething) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_keys.t4d"));
  const scene::WorldBox box = stage->files().box();
  for (const KeyBinding& binding : keyTable()) {
    // A state in which every key has something to do.
    stage->state().timeline.setTime(stage->state().timeline.table()[2]);
    scene::View& view = stage->state().shot.view;
    view = scene::zoom(view, {900, 560}, box, box.centre, {400, 300}, 0.9);
    if (binding.action == Action::kClose) stage->say("a message");
    const std::string before = fingerprint(*stage);
    if (binding.character != 0) {
      stage->handle(Typed{binding.character});
    } else {
      stage->handle(KeyChanged{binding.key, true, false, false});
    }
    stage->frame(0);
    EXPECT_NE(fingerprint(*stage), before) << binding.label << ": " << binding.meaning;
  }
}

TEST(Viewer, KeysAreBoundOnceAndTheManualListsThem) {
  std::set<std::pair<Key, char32_t>> seen;
  for (const KeyBinding& binding : keyTable()) {
    EXPECT_NE(binding.key == Key::kNone, binding.character == 0) << binding.label;
    EXPECT_TRUE(seen.emplace(binding.key, binding.character).second) << binding.label;
  }
  const std::string manual = textOf(TET4D_SOURCE_DIR "/docs/playing.md");
  EXPECT_NE(manual.find(keysAsMarkdown()), std::string::npos) << "docs/playing.md must hold exactly this list:\n"
                                                              << keysAsMarkdown();
}

TEST(Viewer, ColoursChangeThePicture) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_colours.t4d"));
  const render::Image before = stage->picture();
  stage.click("outside");  // opens the picker
  stage->files().all()[0]->material.color = {0.9, 0.1, 0.1};
  stage->changed();
  stage.rest();
  EXPECT_GT(test::compare(before, stage->picture()).rms, 5);
  EXPECT_EQ(stage->shot().material.color, glm::dvec3(0.9, 0.1, 0.1)) << "the camera file has it too";
  stage.key(Key::kEscape);
  const bool had_room = stage->state().shot.background.room.has_value();
  stage.type(U'b');
  EXPECT_NE(stage->state().shot.background.room.has_value(), had_room);
}

TEST(Viewer, PicturesAreNumberedAndNeverOverwritten) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_save.t4d"));
  std::ofstream(stage.directory + "/picture-0001.png") << "mine";
  stage.click("save picture");
  stage.type(U's');
  EXPECT_EQ(stage.saved(), (std::vector<std::string>{"picture-0001.png", "picture-0002.png", "picture-0003.png"}));
  EXPECT_EQ(textOf(stage.directory + "/picture-0001.png"), "mine");
  EXPECT_EQ(textOf(stage.directory + "/picture-0002.png"), textOf(stage.directory + "/picture-0003.png"));
  EXPECT_EQ(textOf(stage.directory + "/picture-0002.png").substr(1, 3), "PNG");
  ASSERT_FALSE(stage->state().messages.empty());
  EXPECT_NE(stage->state().messages.back().text.find("picture-0003.png"), std::string::npos);
}

TEST(Viewer, TheCameraFileGivesTheViewBack) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_camera.t4d"));
  stage.drag(600, 200, 650, 230);
  stage.type(U'w');
  const auto shot = scene::readShot(stage.directory + "/camera-0001.json", {});
  ASSERT_TRUE(shot.ok());
  EXPECT_EQ(scene::formatShot(shot.value()), scene::formatShot(stage->shot()));
}

TEST(Viewer, AFilmIsTakenOnePictureAFrame) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_film.t4d"));
  stage->state().film_between = 1;
  stage.type(U'v');
  stage.rest(40);
  EXPECT_EQ(stage->recorder(), nullptr);
  EXPECT_EQ(stage.saved(), std::vector<std::string>{"film-0001"});
  std::size_t pictures = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(stage.directory + "/film-0001"))
    ++pictures;
  EXPECT_EQ(pictures, 7u) << "four frames and one between each two";
  // As y4m, stopped half-way: what was taken is kept.
  stage->state().film_kind = FilmKind::kY4m;
  stage->handle(Typed{U'v'});
  stage->frame(0.01);
  stage->frame(0.01);
  ASSERT_NE(stage->recorder(), nullptr);
  const auto taken = stage->recorder()->taken();
  stage->handle(Typed{U'v'});
  stage->frame(0.01);
  const std::string film = textOf(stage.directory + "/film-0001.y4m");
  EXPECT_EQ(film.substr(0, 9), "YUV4MPEG2");
  EXPECT_GE(film.size(), taken * 900 * 560 * 3 / 2);
}

// A film runs as fast as it was seen to, within what players of films take, unless its rate is set.
TEST(Viewer, FilmsRunAsFastAsTheyAreSeen) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_rate.t4d"));
  ViewerState& state = stage->state();
  EXPECT_EQ(stage->filmFps(), 12);
  state.timeline.setSpeed(0.5);
  state.film_between = 3;
  EXPECT_EQ(stage->filmFps(), 24);
  state.film_kind = FilmKind::kY4m;
  stage.type(U'v');
  stage.rest(40);
  EXPECT_NE(textOf(stage.directory + "/film-0001.y4m").substr(0, 40).find(" F24:1 "), std::string::npos);
  state.timeline.setSpeed(1.0 / 64);
  state.film_between = 0;
  EXPECT_EQ(stage->filmFps(), Viewer::kLeastFps);
  state.timeline.setSpeed(64);
  EXPECT_EQ(stage->filmFps(), Viewer::kMostFps);
  stage.click("film options");
  const scene::Frame rate = state.places.at("film fps");
  stage.drag(rate.left + 140, rate.centre().y, rate.left + 60, rate.centre().y);
  ASSERT_TRUE(state.film_fps);
  EXPECT_LT(*state.film_fps, 100);
  EXPECT_EQ(stage->filmFps(), *state.film_fps);
  stage.click("as played");
  EXPECT_FALSE(state.film_fps);
}

// Without dropping: a path that is typed. Letters are the field's as long as it has them.
TEST(Viewer, AFileIsOpenedByItsPathAndTheTitleFollows) {
  test::ViewerStage stage(small());
  stage.rest();
  EXPECT_EQ(stage->title(), "tet4d");
  const auto enter = [&](const std::string& path) {
    stage.click("path");
    for (const char c : path) stage->handle(Typed{static_cast<char32_t>(static_cast<unsigned char>(c))});
    stage.rest();
    stage.key(Key::kEnter);
  };
  const std::string one = sphere("viewer_typed.t4d"), two = sphere("viewer_typed_2.t4d");
  enter(one);
  ASSERT_EQ(stage->files().count(), 1u);
  EXPECT_EQ(stage->files().all()[0]->path, one);
  EXPECT_FALSE(stage->state().quit) << "no letter was a key";
  EXPECT_EQ(stage->title(), "tet4d - " + one);
  enter(test::temporaryDirectory() + "/nowhere.t4d");
  EXPECT_EQ(stage->files().count(), 1u);
  ASSERT_FALSE(stage->state().messages.empty());
  EXPECT_TRUE(stage->state().messages.back().is_error);
  EXPECT_NE(stage->state().messages.back().text.find("nowhere.t4d"), std::string::npos);
  EXPECT_NE(std::string(stage->state().path_to_open.data()).find("nowhere.t4d"), std::string::npos) << "to be mended";
  stage->state().path_to_open.fill('\0');
  enter(two);
  ASSERT_EQ(stage->files().count(), 2u);
  EXPECT_EQ(stage->title(), "tet4d - " + two + " and 1 more");
  stage.click("name 0");
  EXPECT_EQ(stage->title(), "tet4d - " + one + " and 1 more");
}

// Pointing at the time line tells what is there, and hides nothing of what the bar says.
TEST(Viewer, TheTimeToldStandsAboveTheTimeLine) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_told.t4d"));
  const scene::Frame line = stage->state().places.at("time line");
  for (const double part : {0.01, 0.5, 0.99}) {
    stage.moveTo(line.left + part * line.width, line.centre().y);
    for (int i = 0; i < 4; ++i) stage->frame(0.02);
    ASSERT_TRUE(stage->state().places.contains("time told"));
    const scene::Frame told = stage->state().places.at("time told"), where = stage->state().places.at("where");
    EXPECT_LE(told.top + told.height, line.top) << part;
    EXPECT_LE(told.top + told.height, where.top) << part;
    EXPECT_GE(told.left, 0) << part;
    EXPECT_LE(told.left + told.width, 900) << part;
  }
}

TEST(Viewer, ABrokenFileIsAMessage) {
  test::ViewerStage stage(small());
  const std::string good = sphere("viewer_good.t4d"), bad = test::temporaryDirectory() + "/viewer_bad.t4d";
  stage.open(good);
  std::ofstream(bad, std::ios::binary) << textOf(good).substr(0, 777);
  const render::Image before = stage.screenshot();
  stage->handle(Dropped{{bad, test::temporaryDirectory() + "/nowhere.t4d"}});
  stage.rest();
  ASSERT_EQ(stage->state().messages.size(), 2u);
  EXPECT_NE(stage->state().messages[0].text.find("viewer_bad.t4d"), std::string::npos);
  EXPECT_FALSE(stage->state().messages[0].remedy.empty());
  EXPECT_TRUE(stage->state().messages[0].is_error);
  EXPECT_NE(stage->state().messages[1].text.find("nowhere.t4d"), std::string::npos);
  EXPECT_EQ(stage->files().count(), 1u);
  EXPECT_GT(test::compare(before, stage.screenshot()).rms, 1) << "it is seen";
  for (int i = 0; i < 20; ++i) stage->frame(1);
  EXPECT_TRUE(stage->state().messages.empty()) << "it goes after a while";
}

TEST(Viewer, ADamagedPageIsNamedOnceAndLeftOut) {
  const std::string path = sphere("viewer_page.t4d");
  std::uint64_t offset = 0;
  {
    const auto file = dyntri::File::open(path);
    ASSERT_TRUE(file.ok());
    offset = file.value().pages().entries()[1].offset;
  }
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(offset + 200));
  file.write("\x7f\x7f\x7f\x7f", 4);
  file.close();
  test::ViewerStage stage(small());
  stage.open(path);
  EXPECT_GT(stage->state().stats.drawn, 0u);
  const auto& timeline = stage->state().timeline;
  for (int i = 0; i < 3; ++i) {
    stage->state().timeline.setTime((timeline.table()[1] + timeline.table()[2]) / 2);
    stage->changed();
    stage.rest();
    EXPECT_EQ(stage->state().stats.drawn, 0u);
    EXPECT_EQ(stage->state().stats.pages_damaged, 1u);
  }
  ASSERT_EQ(stage->state().messages.size(), 1u);
  EXPECT_NE(stage->state().messages[0].text.find("page 1"), std::string::npos) << stage->state().messages[0].text;
  EXPECT_EQ(stage->state().messages[0].count, 1);
}

TEST(Viewer, SeveralFilesShareAScene) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_one.t4d"));
  const std::uint64_t one = stage->state().stats.drawn;
  stage->handle(Dropped{{sphere("viewer_two.t4d")}});
  stage.rest();
  EXPECT_EQ(stage->state().stats.drawn, 2 * one);
  EXPECT_NE(stage->files().all()[0]->material.color, stage->files().all()[1]->material.color);
  stage.click("shown 0");
  EXPECT_EQ(stage->state().stats.drawn, one);
  stage.click("remove 1");
  EXPECT_EQ(stage->files().count(), 1u);
  EXPECT_EQ(stage->state().stats.drawn, 0u) << "the other one is hidden";
  stage.click("shown 0");
  EXPECT_EQ(stage->state().stats.drawn, one);
  // The same file again is read anew, not twice.
  stage->handle(Dropped{{test::temporaryDirectory() + "/viewer_one.t4d"}});
  stage.rest();
  EXPECT_EQ(stage->files().count(), 1u);
  EXPECT_EQ(stage->state().stats.drawn, one);
}

TEST(Viewer, MessagesGoWhenClicked) {
  test::ViewerStage stage(small());
  stage->report({FaultCode::kIo, "file", "place", "what", "remedy"});
  stage->report({FaultCode::kIo, "file", "place", "what", "remedy"});
  stage.rest();
  ASSERT_EQ(stage->state().messages.size(), 1u);
  EXPECT_EQ(stage->state().messages[0].count, 2);
  stage.click("message 0");
  EXPECT_TRUE(stage->state().messages.empty());
}

TEST(Viewer, PanelsScaleWithDenseDisplays) {
  ViewerOptions options = small();
  options.width *= 2;
  options.height *= 2;
  options.scale = 2;
  test::ViewerStage stage(options);
  stage.open(sphere("viewer_dense.t4d"));
  const render::Image image = stage.screenshot();
  ASSERT_EQ(image.width, 1800u);
  EXPECT_GT(darkShare(image, {40, 40, 500, 500}), 0.7);
  EXPECT_EQ(stage->state().places.at("time line").width, 900 - 24 - 20);
  stage.click("forward");
  EXPECT_NEAR(stage->state().timeline.frame(), 1, 1e-9);
}

TEST(ViewerStiff, ResizedWhilePlayingMinimisedAndOnePixel) {
  test::ViewerStage stage(small());
  stage.open(sphere("viewer_resize.t4d"));
  stage.type(U' ');
  ASSERT_TRUE(stage->state().timeline.playing());
  for (const auto& [width, height] :
       {std::pair{900u, 560u}, {1u, 1u}, {640u, 1u}, {1u, 480u}, {0u, 0u}, {333u, 777u}, {1200u, 100u}, {900u, 560u}}) {
    stage->handle(Resized{width, height, 1});
    const double before = stage->state().timeline.time();
    for (int i = 0; i < 3; ++i) {
      const Viewer::Outcome outcome = stage->frame(0.02);
      EXPECT_EQ(std::isinf(outcome.wait_s), width == 0) << "a minimised window sleeps";
    }
    if (width == 0) {
      EXPECT_EQ(stage->state().timeline.time(), before);
      continue;
    }
    EXPECT_NE(stage->state().timeline.time(), before);
    const render::Image image = stage.screenshot();
    EXPECT_EQ(image.width, width);
    EXPECT_EQ(image.height, height);
  }
  EXPECT_TRUE(stage->state().messages.empty());
}

TEST(ViewerStiff, NothingOpenNothingAliveOneFrame) {
  test::ViewerStage stage(small());
  stage.rest();
  for (const KeyBinding& binding : keyTable()) {
    if (binding.action != Action::kQuit) stage->act(binding.action);
    stage.rest();
  }
  stage.drag(600, 200, 650, 230);
  stage->handle(Scrolled{2});
  stage.rest();
  EXPECT_EQ(stage->state().stats.drawn, 0u);
  stage.open(test::writeFile("viewer_empty.t4d", {}, {{}, {0, 1}, paged::Codec::kRaw}));
  stage.type(U' ');
  stage.rest();
  EXPECT_EQ(stage->state().stats.drawn, 0u);
  EXPECT_EQ(stage->state().messages.empty(), false) << "that it has no triangles is said";
}

TEST(ViewerStiff, SavingWhereNothingCanBeWritten) {
  ViewerOptions options = small();
  test::ViewerStage stage(options);
  stage.open(sphere("viewer_nowhere.t4d"));
  std::filesystem::remove_all(stage.directory);
  std::ofstream(stage.directory) << "a file where the folder was";
  for (const char32_t key : {U's', U'w', U'v'}) {
    stage->state().messages.clear();
    stage.type(key);
    ASSERT_FALSE(stage->state().messages.empty());
    EXPECT_TRUE(stage->state().messages.back().is_error);
  }
  EXPECT_EQ(stage->recorder(), nullptr);
}

}  // namespace
}  // namespace tet4d::host
