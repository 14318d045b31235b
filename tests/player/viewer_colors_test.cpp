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

// The length of normals is 1 but for rounding: c comes to a component, and what is one value is one colour.
TEST(ViewerColors, NormalsAreColouredByAComponentAndOneValueByOneColour) {
  test::ViewerStage stage(large());
  stage.open(test::writeColumnSphere("colors_c.t4d", 3));
  for (int i = 0; i < 3; ++i) stage.type(U'c');
  ASSERT_EQ(coloringOf(stage).column, 2u);
  EXPECT_EQ(coloringOf(stage).component, 0);
  ASSERT_EQ(stage->files().legends().size(), 1u);
  EXPECT_EQ(stage->files().legends()[0].title, "normal: x");
  EXPECT_GT(stage->files().legends()[0].high - stage->files().legends()[0].low, 1.5);
  coloringOf(stage).component = scene::kMagnitude;
  stage->changed();
  stage.rest();
  const auto* spread = stage->files().all()[0]->scans->known(2, scene::kMagnitude);
  ASSERT_NE(spread, nullptr);
  ASSERT_LT(spread->least, spread->most) << "rounding, for this test to be one";
  ASSERT_EQ(stage->files().legends().size(), 1u);
  const Legend legend = stage->files().legends()[0];
  EXPECT_EQ(legend.low, legend.high);
  EXPECT_TRUE(std::all_of(legend.bar.begin(), legend.bar.end(), [&](const Rgb& c) { return c == legend.bar[0]; }));
  const auto ticks = ticksOf(legend.low, legend.high, false, 8);
  ASSERT_EQ(ticks.size(), 1u);
  EXPECT_EQ(ticks[0].label, "1.000");
  const auto drawn = *stage->files().all()[0]->drawn();
  EXPECT_EQ(scene::colorOf(drawn, spread->least), scene::colorOf(drawn, spread->most));
  coloringOf(stage).range = scene::RangeOf::kGiven;
  coloringOf(stage).low = 0, coloringOf(stage).high = 2;
  EXPECT_EQ(stage->files().all()[0]->drawn()->high, 2) << "what is asked for by hand stays";
}

// A view that nobody has moved leaves room for the legend, and comes back without it.
TEST(ViewerColors, TheLegendStandsBesideTheData) {
  test::ViewerStage stage(large());
  stage.open(test::writeColumnSphere("colors_room.t4d", 3));
  const scene::View plain = stage->state().shot.view;
  const double left = stage->freeFrame().left, free = stage->freeFrame().width;
  stage.click("column 1");
  const double room = stage->fitFrame().width;
  EXPECT_LT(room, free - 60);
  for (const glm::dvec3& corner : stage->files().box().corners) {
    const glm::dvec2 at =
        scene::project(stage->state().shot.view, {1280, 1000}, stage->files().box().centre + corner).pixel;
    EXPECT_LE(at.x, left + room);
  }
  // What differs without the legend differs right of there.
  const render::Image with = stage->picture();
  stage.type(U'k');
  const render::Image without = stage->picture();
  double first = 1280;
  for (std::uint32_t y = 0; y < with.height; ++y) {
    for (std::uint32_t x = 0; x < with.width; ++x) {
      if (with.row(y)[4 * x] != without.row(y)[4 * x]) first = std::min(first, double{1} * x);
    }
  }
  EXPECT_LT(first, 1280);
  EXPECT_GE(first, left + room);
  stage.click("column 1");
  EXPECT_NEAR(stage->state().shot.view.eye.x, plain.eye.x, 1e-9);
  // A view of one's own stays.
  stage.drag(700, 300, 720, 310);
  const scene::View own = stage->state().shot.view;
  stage.click("column 1");
  EXPECT_EQ(stage->state().shot.view.eye, own.eye);
}

// Only columns whose rows are seen are read for the list, and what that cost is told apart from what is drawn.
TEST(ViewerColors, RangesAreReadOfColumnsSeenAndCounted) {
  test::FileSpec spec{{}, {0, 1}, paged::Codec::kRaw};
  for (int c = 0; c < 40; ++c)
    spec.columns.push_back(
        {{"column " + std::to_string(c), 1}, [c](const Vec4f& v) { return std::vector{v.x + float(c)}; }});
  const test::Page page = test::sweep(test::icosphere(2), test::kTestSphere.motion(), 0, 1);
  test::ViewerStage stage(large());
  stage.open(test::writeFile("colors_many.t4d", {page}, spec));
  stage.rest();
  const ViewerFile& file = *stage->files().all()[0];
  std::uint64_t known = 0;
  for (std::size_t c = 0; c < 40; ++c) known += file.scans->known(c, 0) != nullptr ? 1 : 0;
  EXPECT_GT(known, 2u);
  EXPECT_LT(known, 30u);
  EXPECT_NE(file.scans->known(0, 0), nullptr);
  EXPECT_EQ(file.scans->known(39, 0), nullptr);
  EXPECT_EQ(stage->files().scannedBytes(), known * file.file.pages().entries()[file.file.tablePage(0) + 1].bytes);
  EXPECT_TRUE(file.pager->residentColumn(0, 0).empty()) << "none is kept";
  // Closed, the list reads nothing.
  ViewerOptions low = large();
  low.height = 600;
  test::ViewerStage closed(low);
  closed.open(test::temporaryDirectory() + "/colors_many.t4d");
  EXPECT_EQ(closed->files().scannedBytes(), 0u);
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
