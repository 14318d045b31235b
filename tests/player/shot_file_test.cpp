#include "player/scene/shot_file.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace tet4d::scene {
namespace {

Shot defaults() { return defaultShot(worldBox({}, {{0, 0, 0, 0}, {4, 2, 1, 1}}), 16.0 / 9); }

Shot parsed(const std::string& text) {
  auto shot = parseShot(text, "c.json", defaults());
  EXPECT_TRUE(shot.ok()) << (shot.ok() ? "" : shot.fault().place + ": " + shot.fault().what);
  return shot.ok() ? shot.value() : Shot{};
}

Fault faultOf(const std::string& text) {
  auto shot = parseShot(text, "c.json", defaults());
  EXPECT_FALSE(shot.ok()) << text;
  return shot.ok() ? Fault{} : shot.fault();
}

void expectSame(const Shot& a, const Shot& b) {
  EXPECT_EQ(a.view.eye, b.view.eye);
  EXPECT_EQ(a.view.target, b.view.target);
  EXPECT_EQ(a.view.up, b.view.up);
  EXPECT_EQ(a.view.fov_y_degrees, b.view.fov_y_degrees);
  EXPECT_EQ(a.view.ortho_height, b.view.ortho_height);
  EXPECT_EQ(a.view.near_distance, b.view.near_distance);
  EXPECT_EQ(a.view.far_distance, b.view.far_distance);
  ASSERT_EQ(a.lights.size(), b.lights.size());
  for (std::size_t i = 0; i < a.lights.size(); ++i) {
    EXPECT_EQ(a.lights[i].direction, b.lights[i].direction);
    EXPECT_EQ(a.lights[i].color, b.lights[i].color);
  }
  EXPECT_EQ(a.ambient, b.ambient);
  EXPECT_EQ(a.material.color, b.material.color);
  EXPECT_EQ(a.material.back_color, b.material.back_color);
  EXPECT_EQ(a.material.specular, b.material.specular);
  EXPECT_EQ(a.material.shininess, b.material.shininess);
  EXPECT_EQ(a.material.refraction, b.material.refraction);
  EXPECT_EQ(a.material.tint, b.material.tint);
  EXPECT_EQ(a.material.depth, b.material.depth);
  EXPECT_EQ(a.background.checker, b.background.checker);
  EXPECT_EQ(a.background.top, b.background.top);
  EXPECT_EQ(a.background.bottom, b.background.bottom);
  EXPECT_EQ(a.background.room, b.background.room);
}

TEST(ShotFile, WrittenAndReadBackIsTheSameBitForBit) {
  Shot shot = defaults();
  shot.view.eye = {1e6 / 3, -0.1, 7};
  shot.view.fov_y_degrees = 33.3;
  shot.view.near_distance = 0.125;
  shot.view.far_distance = 1e7 / 3;
  shot.lights[1].color = {0.1, 0.2, 0.7};
  expectSame(parsed(formatShot(shot)), shot);
  shot = defaults();
  shot.view.ortho_height = 10.0 / 3;
  shot.lights.clear();
  shot.background.room.reset();
  shot.background.checker = 12;
  shot.material.refraction = 4.0 / 3;
  shot.material.tint = 0.1;
  shot.material.depth = 1.7;
  expectSame(parsed(formatShot(shot)), shot);
}

TEST(ShotFile, MissingKeysKeepTheDefaults) {
  expectSame(parsed("{}"), defaults());
  Shot expected = defaults();
  expected.view.eye = {0, -9, 0};
  expected.view.target = {0, 0, 1};
  expectSame(parsed(R"({"eye": [0, -9, 0], "target": [0, 0, 1]})"), expected);
}

TEST(ShotFile, ShortForms) {
  const Shot shot = parsed(R"({"background": [1, 0.5, 0], "material": {"color": [0.1, 0.2, 0.3]}, "ortho_height": 5})");
  EXPECT_EQ(shot.background.top, glm::dvec3(1, 0.5, 0));
  EXPECT_EQ(shot.background.bottom, shot.background.top);
  EXPECT_FALSE(shot.background.room) << "one colour is one colour";
  EXPECT_EQ(shot.material.back_color, shot.material.color) << "one colour given is both sides' colour";
  EXPECT_EQ(shot.view.ortho_height, 5.0);
}

struct Bad {
  const char* text;
  const char* place;
  const char* says;  // in what or remedy
};

TEST(ShotFile, FaultsNameTheKeyAndTheExpectation) {
  const Bad cases[] = {
      {R"({"eye": [0, 0], "target": [0, 0, 1]})", "eye", "three finite numbers"},
      {R"({"eye": [0, 0, 0]})", "eye", "\"target\" together"},
      {R"({"eye": [1, 2, 3], "target": [1, 2, 3]})", "target", "equals"},
      {R"({"eye": [0, 0, 5], "target": [0, 0, 0]})", "up", "line of sight"},
      {R"({"up": [0, 0, 0]})", "up", "no direction"},
      {R"({"fov_y_degrees": 180})", "fov_y_degrees", "found 180"},
      {R"({"fov_y_degrees": "wide"})", "fov_y_degrees", "found \"wide\""},
      {R"({"fov_y_degrees": 30, "ortho_height": 2})", "ortho_height", "one of the two"},
      {R"({"ortho_height": 0})", "ortho_height", "> 0"},
      {R"({"near": 5, "far": 4})", "far", "far > near"},
      {R"({"near": -5})", "near", "> 0"},
      {R"({"lights": [{"direction": [0, 0, -1]}, {"color": [1, 1, -1]}]})", "lights[1].color", ">= 0"},
      {R"({"lights": [{"direktion": [0, 0, -1]}]})", "lights[0].direktion", "direction"},
      {R"({"lights": 3})", "lights", "array"},
      {R"({"lights": [3]})", "lights[0]", "object"},
      {R"({"lights": [{},{},{},{},{},{},{},{},{}]})", "lights", "at most 8"},
      {R"({"material": {"color": [0, 0, 1.5]}})", "material.color", "between 0 and 1"},
      {R"({"material": {"depth": 5}})", "material.depth", "between 0 and 4"},
      {R"({"material": {"shinyness": 3}})", "material.shinyness", "\"shininess\""},
      {R"({"background": {"top": 1}})", "background.top", "three numbers"},
      {R"({"background": {"room": true}})", "background.room", "or false"},
      {R"({"eey": [0, 0, 0]})", "eey", "\"eye\""},
      {R"([1, 2])", "", "object"},
  };
  for (const Bad& bad : cases) {
    const Fault fault = faultOf(bad.text);
    EXPECT_EQ(fault.code, FaultCode::kBadInput) << bad.text;
    EXPECT_EQ(fault.file, "c.json") << bad.text;
    EXPECT_EQ(fault.place, bad.place) << bad.text;
    EXPECT_NE((fault.what + fault.remedy).find(bad.says), std::string::npos) << bad.text << "\n"
                                                                             << fault.what << "\n"
                                                                             << fault.remedy;
    EXPECT_FALSE(fault.remedy.empty()) << bad.text;
  }
}

TEST(ShotFile, BrokenJsonNamesLineAndColumn) {
  const Fault fault = faultOf("{\n  \"eye\": [0, 0, 1,,\n}");
  EXPECT_EQ(fault.place, "line 2, column 19");
  EXPECT_NE(faultOf("").place.find("line 1"), std::string::npos);
}

TEST(ShotFile, MissingFileIsAFault) {
  auto shot = readShot("/nonexistent/camera.json", defaults());
  ASSERT_FALSE(shot.ok());
  EXPECT_EQ(shot.fault().code, FaultCode::kIo);
  EXPECT_EQ(shot.fault().file, "/nonexistent/camera.json");
}

TEST(Shot, OrbitKeepsDistanceAndHeight) {
  View view;
  view.eye = {3, 4, 5};
  view.target = {1, 1, 1};
  const View turned = orbit(view, 90);
  EXPECT_NEAR(glm::distance(turned.eye, glm::dvec3(1 - 3, 1 + 2, 5)), 0, 1e-12);
  EXPECT_NEAR(glm::distance(orbit(view, 360).eye, view.eye), 0, 1e-12);
}

}  // namespace
}  // namespace tet4d::scene
