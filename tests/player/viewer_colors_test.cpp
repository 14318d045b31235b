// The panels about colours, columns, the legend and glass, as a user meets them: clicks in, pictures and state out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/player/picture.h"
#include "tests/player/viewer_stage.h"

namespace tet4d::host {
namespace {

ViewerOptions large() {
  ViewerOptions options;
  options.width = 1280;
  options.height = 1000;
  options.samples = 1;
  return options;
}

scene::Coloring& coloringOf(test::ViewerStage& stage) { return stage->files().all()[0]->coloring; }

// Opens a combo box and clicks one of its choices.
void choose(test::ViewerStage& stage, const std::string& box, const std::string& choice) {
  stage.click(box);
  stage.click(choice);
}

TEST(ViewerColors, AColumnIsChosenByItsNameAndTheLegendSaysSo) {
  test::ViewerStage stage(large());
  stage.open(test::writeColumnSphere("colors_choose.t4d", 4));
  stage->state().timeline.setTime(1.5);
  stage->changed();
  stage.rest();
  const render::Image material = stage->picture();
  choose(stage, "coloured by", "by speed [m/s]");
  EXPECT_EQ(coloringOf(stage).by, scene::ColorBy::kColumn);
  const render::Image colored = stage->picture();
  EXPECT_GT(test::compare(material, colored).rms, 5);
  stage.click("legend");
  EXPECT_FALSE(stage->state().legend);
  const render::Image without = stage->picture();
  const double legend = test::compare(colored, without).share_above_8;
  EXPECT_GT(legend, 0.005);
  EXPECT_LT(legend, 0.1) << "the legend and nothing else";
  stage.type(U'k');
  EXPECT_EQ(test::compare(stage->picture(), colored).largest, 0) << "the key does what the box does";
  choose(stage, "coloured by", "by one colour");
  EXPECT_EQ(test::compare(stage->picture(), material).largest, 0);
}

TEST(ViewerColors, TheListOfColumnsShowsAndChooses) {
  test::ViewerStage stage(large());
  stage.open(test::writeColumnSphere("colors_list.t4d", 4));
  ASSERT_TRUE(stage->state().places.contains("column 2"));
  const auto* spread = stage->files().all()[0]->scans->known(1, scene::kMagnitude);
  ASSERT_NE(spread, nullptr) << "small columns are read for the list";
  EXPECT_NEAR(double{spread->most}, 3 * std::sqrt(1.25), 1e-5);
  EXPECT_TRUE(stage->files().all()[0]->pager->residentColumn(0, 1).empty()) << "and are not kept for it";
  stage.click("column 1");
  EXPECT_EQ(coloringOf(stage).by, scene::ColorBy::kColumn);
  EXPECT_EQ(coloringOf(stage).column, 1u);
  EXPECT_EQ(coloringOf(stage).component, scene::kMagnitude) << "of a vector first its length";
  EXPECT_FALSE(stage->files().all()[0]->pager->residentColumn(0, 1).empty()) << "what is drawn is loaded";
  EXPECT_TRUE(stage->files().all()[0]->pager->residentColumn(0, 0).empty());
  stage.click("column 1");
  EXPECT_EQ(coloringOf(stage).by, scene::ColorBy::kMaterial) << "again: the material";
}

TEST(ViewerColors, MapsAreSwatchesToClick) {
  test::ViewerStage stage(large());
  stage.open(test::writeColumnSphere("colors_maps.t4d", 4));
  stage->state().timeline.setTime(1.5);
  stage.click("column 0");
  render::Image before = stage->picture();
  for (const ColorMap& map : colorMaps()) {
    if (map.name == "viridis") continue;
    stage.click("map " + std::string(map.name));
    EXPECT_EQ(coloringOf(stage).map->name, map.name);
    EXPECT_GT(test::compare(stage->picture(), before).rms, 1) << map.name;
    before = stage->picture();
  }
  // What is drawn in the panel are the map's own colours (the cursor away, or its name covers them).
  stage.moveTo(900, 300);
  stage.rest();
  const scene::Frame place = stage->state().places.at("map grey");
  const render::Image window = stage.screenshot();
  const auto y = static_cast<std::uint32_t>(place.centre().y);
  const auto at = [&](double part) {
    return int{window.row(y)[4 * static_cast<std::uint32_t>(place.left + part * place.width)]};
  };
  EXPECT_NEAR(at(0.5), 128, 6);
  EXPECT_LT(at(0.08), at(0.5));
  EXPECT_GT(at(0.92), at(0.5));
  for (const char* box : {"reversed", "logarithmic", "shading"}) {
    stage.click(box);
    EXPECT_GT(test::compare(stage->picture(), before).rms, 0.5) << box;
    before = stage->picture();
  }
  EXPECT_TRUE(coloringOf(stage).reversed);
  EXPECT_TRUE(coloringOf(stage).logarithmic);
  EXPECT_FALSE(coloringOf(stage).lit);
}

TEST(ViewerColors, TheRangeIsOfTheDataOrByHand) {
  test::ViewerStage stage(large());
  stage.open(test::writeColumnSphere("colors_range.t4d", 4));
  stage.click("column 0");
  const auto drawn = [&] { return *stage->files().all()[0]->drawn(); };
  const auto* spread = stage->files().all()[0]->scans->known(0, 0);
  ASSERT_NE(spread, nullptr);
  EXPECT_EQ(drawn().low, spread->low);
  EXPECT_EQ(drawn().high, spread->high);
  choose(stage, "range", "range all values");
  EXPECT_EQ(drawn().low, spread->least);
  EXPECT_EQ(drawn().high, spread->most);
  choose(stage, "range", "range by hand");
  EXPECT_EQ(drawn().low, spread->least) << "begins where it stood";
  const scene::Frame ends = stage->state().places.at("ends");
  stage.drag(ends.left + 30, ends.centre().y, ends.left + 90, ends.centre().y);
  EXPECT_NE(drawn().low, spread->least);
  EXPECT_LE(drawn().low, drawn().high);
}

TEST(ViewerColors, NormalsOfTheFileAreChosenAmongItsColumns) {
  test::ViewerStage stage(large());
  stage.open(test::writeColumnSphere("colors_normals.t4d", 3));
  choose(stage, "normals", "normals column normal");
  EXPECT_EQ(coloringOf(stage).normal_column, 2u);
  EXPECT_FALSE(stage->files().all()[0]->pager->residentColumn(0, 2).empty());
  choose(stage, "normals", "normals flat");
  EXPECT_FALSE(stage->state().smooth);
  EXPECT_FALSE(coloringOf(stage).normal_column);
}

TEST(ViewerColors, PartsHaveColoursOfTheirOwn) {
  test::ViewerStage stage(large());
  stage.open(test::writeParts("colors_parts.t4d"));
  const render::Image before = stage->picture();
  stage.type(U'c');
  EXPECT_EQ(coloringOf(stage).by, scene::ColorBy::kPart) << "the first that c comes to";
  EXPECT_GT(test::compare(before, stage->picture()).rms, 3);
  ASSERT_EQ(stage->files().legends().size(), 1u);
  EXPECT_EQ(stage->files().legends()[0].entries.size(), 3u);
  stage.type(U'c');
  EXPECT_EQ(coloringOf(stage).by, scene::ColorBy::kMaterial) << "no columns: once round";
}

TEST(ViewerColors, GlassHasItsSliders) {
  test::ViewerStage stage(large());
  stage.open(test::writeTestSphere("colors_glass.t4d", 3));
  stage.click("Material");
  scene::Material& material = stage->files().all()[0]->material;
  const render::Image opaque = stage->picture();
  stage.click("transparent");
  EXPECT_NEAR(material.refraction, 1.333, 1e-3);
  render::Image before = stage->picture();
  EXPECT_GT(test::compare(opaque, before).rms, 3);
  const auto slide = [&](const char* name, double part) {
    const scene::Frame place = stage->state().places.at(name);
    stage.drag(place.left + 20, place.centre().y, place.left + part * 140, place.centre().y);
    EXPECT_GT(test::compare(before, stage->picture()).rms, 0.1) << name;
    before = stage->picture();
  };
  slide("checker", 0.4);
  EXPECT_GT(stage->state().shot.background.checker, 4u);
  slide("index", 0.8);
  EXPECT_GT(material.refraction, 2);
  slide("tint", 0.7);
  EXPECT_GT(material.tint, 0.4);
  slide("depth", 0.9);
  EXPECT_GT(material.depth, 2);
  stage.click("transparent");
  EXPECT_EQ(material.refraction, 0);
}

TEST(ViewerColors, SavedPicturesCarryTheLegendAtTheirRightEnd) {
  test::ViewerStage stage(large());
  stage.open(test::writeColumnSphere("colors_save.t4d", 3));
  stage.click("column 1");
  stage.type(U's');
  stage.type(U'k');
  stage.type(U's');
  EXPECT_EQ(stage.saved(), (std::vector<std::string>{"picture-0001.png", "picture-0002.png"}));
  EXPECT_NE(std::filesystem::file_size(stage.directory + "/picture-0001.png"),
            std::filesystem::file_size(stage.directory + "/picture-0002.png"));
}

TEST(ViewerColors, AFileReadAnewKeepsItsColours) {
  test::ViewerStage stage(large());
  const std::string path = test::writeColumnSphere("colors_anew.t4d", 3);
  stage.open(path);
  stage.click("column 1");
  stage->handle(Dropped{{path}});
  stage.rest();
  ASSERT_EQ(stage->files().count(), 1u);
  const ViewerFile& file = *stage->files().all().back();
  EXPECT_EQ(file.coloring.by, scene::ColorBy::kColumn);
  EXPECT_EQ(file.coloring.column, 1u);
  // What has no such column any more is of one colour.
  std::filesystem::copy_file(test::writeTestSphere("colors_plain.t4d", 3), path,
                             std::filesystem::copy_options::overwrite_existing);
  stage->handle(Dropped{{path}});
  stage.rest();
  EXPECT_EQ(stage->files().all().back()->coloring.by, scene::ColorBy::kMaterial);
  EXPECT_GT(stage->state().stats.drawn, 0u);
}

// All of the time line by mouse alone.
TEST(ViewerColors, TimeIsInReachOfTheMouse) {
  for (const auto& [width, height] : {std::pair{1280u, 800u}, {640u, 480u}}) {
    ViewerOptions options = large();
    options.width = width, options.height = height;
    test::ViewerStage stage(options);
    stage.open(test::writeTestSphere("colors_time.t4d", 9));
    Timeline& timeline = stage->state().timeline;
    const scene::Frame line = stage->state().places.at("time line");
    for (const char* name :
         {"first", "back", "play", "forward", "last", "speed", "backward", "loop", "from here", "to here", "all"}) {
      ASSERT_TRUE(stage->state().places.contains(name)) << name << " at " << width;
      const scene::Frame place = stage->state().places.at(name);
      EXPECT_LE(place.left + place.width, width - 20) << name;
      EXPECT_LE(place.top + place.height, height) << name;
    }
    stage.click(line.left + line.width / 4, line.centre().y);
    stage.click("from here");
    EXPECT_NEAR(timeline.begin(), 2, 0.1);
    stage.click(line.left + 3 * line.width / 4, line.centre().y);
    stage.click("to here");
    EXPECT_NEAR(timeline.end(), 6, 0.1);
    stage.click("first");
    EXPECT_EQ(timeline.time(), timeline.begin());
    stage.click("all");
    EXPECT_EQ(timeline.end(), 8);
    stage.click("backward");
    EXPECT_TRUE(timeline.backward());
    choose(stage, "loop", "once");
    EXPECT_EQ(timeline.loop(), Loop::kOnce);
    const scene::Frame speed = stage->state().places.at("speed");
    stage.click(speed.left + 0.9 * speed.width, speed.centre().y);
    EXPECT_GT(timeline.speed(), 4);
  }
}

// At both sizes every panel's header can be reached, and nothing stands outside the window or over the time line.
TEST(ViewerColors, PanelsAreOneTidyColumnAtEverySize) {
  for (const auto& [width, height] : {std::pair{1280u, 800u}, {640u, 480u}}) {
    ViewerOptions options = large();
    options.width = width, options.height = height;
    test::ViewerStage stage(options);
    stage.open(test::writeColumnSphere("colors_tidy.t4d", 4));
    for (const char* name : {"save picture", "coloured by", "Colours", "Files", "film"}) {
      ASSERT_TRUE(stage->state().places.contains(name)) << name << " at " << width;
      const scene::Frame place = stage->state().places.at(name);
      EXPECT_GE(place.left, 0) << name;
      EXPECT_LE(place.top + place.height, stage->freeFrame().height) << name << " at " << width;
    }
    EXPECT_GE(stage->freeFrame().width, 340) << "the picture keeps its room";
  }
}

TEST(ViewerColors, AHintIsThereUntilTheFirstTouch) {
  test::ViewerStage stage(large());
  stage.rest();
  EXPECT_TRUE(stage->state().places.contains("hint")) << "what to do with an empty window";
  stage.open(test::writeTestSphere("colors_hint.t4d", 3));
  EXPECT_TRUE(stage->state().places.contains("hint"));
  stage.drag(700, 300, 720, 310);
  EXPECT_FALSE(stage->state().places.contains("hint"));
}

}  // namespace
}  // namespace tet4d::host
