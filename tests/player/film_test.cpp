#include "player/host/film.h"

#include <gtest/gtest.h>
#include <spng.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "player/host/contact_sheet.h"
#include "player/host/offscreen_gl.h"
#include "player/host/output_file.h"
#include "player/host/playback.h"
#include "player/host/png.h"
#include "tests/player/swept_mesh.h"

namespace tet4d::host {
namespace {

namespace fs = std::filesystem;

render::Image gradient(std::uint32_t width, std::uint32_t height) {
  render::Image image(width, height);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      std::uint8_t* pixel = image.row(y) + std::size_t{4} * x;
      pixel[0] = static_cast<std::uint8_t>(7 * x), pixel[1] = static_cast<std::uint8_t>(11 * y);
      pixel[2] = static_cast<std::uint8_t>(x ^ y), pixel[3] = 255;
    }
  }
  return image;
}

std::string bytesOf(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

render::Image decodePng(const std::string& bytes) {
  spng_ctx* context = spng_ctx_new(0);
  spng_set_png_buffer(context, bytes.data(), bytes.size());
  spng_ihdr header{};
  EXPECT_EQ(spng_get_ihdr(context, &header), 0);
  render::Image image(header.width, header.height);
  EXPECT_EQ(spng_decode_image(context, image.rgba.data(), image.rgba.size(), SPNG_FMT_RGBA8, 0), 0);
  spng_ctx_free(context);
  return image;
}

class Film : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(test::temporaryDirectory()) / "film";
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  std::string in(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t filesIn(const std::string& name = "") const {
    const fs::path folder = folder_ / name;
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
  }

 private:
  fs::path folder_;
};

TEST_F(Film, PngReadsBackTheSamePixels) {
  const render::Image image = gradient(37, 23);
  auto sink = makePngFrames(in("sub/f_%03d.png"), 2, false);
  ASSERT_TRUE(sink.ok());
  ASSERT_TRUE(sink.value()->add(image).ok());
  ASSERT_TRUE(sink.value()->add(gradient(37, 23)).ok());
  ASSERT_TRUE(sink.value()->finish().ok());
  EXPECT_EQ(filesIn("sub"), 2u);
  const render::Image back = decodePng(bytesOf(in("sub/f_000.png")));
  EXPECT_EQ(back.width, 37u);
  EXPECT_EQ(back.height, 23u);
  EXPECT_EQ(back.rgba, image.rgba);
  EXPECT_EQ(bytesOf(in("sub/f_000.png")), bytesOf(in("sub/f_001.png"))) << "bytes depend on the picture alone";
}

TEST_F(Film, FrameNames) {
  EXPECT_EQ(frameName("a_%05d.png", 42).value(), "a_00042.png");
  EXPECT_EQ(frameName("%d", 7).value(), "7");
  EXPECT_EQ(frameName("50%%_%02d", 123).value(), "50%_123");
  EXPECT_EQ(frameName("one.png", 9).value(), "one.png");
  for (const char* bad : {"%s.png", "%5d.png", "%03d_%03d.png", "%.png", "f%", "%00000005d.png", "%03x.png"}) {
    auto name = frameName(bad, 0);
    ASSERT_FALSE(name.ok()) << bad;
    EXPECT_EQ(name.fault().code, FaultCode::kUsage);
  }
  EXPECT_TRUE(makePngFrames(in("one.png"), 1, false).ok());
  EXPECT_FALSE(makePngFrames(in("one.png"), 2, false).ok()) << "two frames need two names";
}

TEST_F(Film, ExistingFramesAreKeptUnlessForced) {
  std::ofstream(in("f_001.png")) << "precious";
  auto refused = makePngFrames(in("f_%03d.png"), 2, false);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.fault().remedy.find("--force"), std::string::npos);
  EXPECT_EQ(refused.fault().file, in("f_001.png"));
  EXPECT_TRUE(makePngFrames(in("f_%03d.png"), 1, false).ok()) << "one frame does not touch it";
  EXPECT_TRUE(makePngFrames(in("f_%03d.png"), 2, true).ok());
  EXPECT_EQ(bytesOf(in("f_001.png")), "precious");
  EXPECT_FALSE(makeY4mFilm(in("f_001.png"), 25, false).ok());
}

TEST_F(Film, Y4mHasItsHeaderAndItsBytes) {
  for (const auto& [width, height] : {std::pair{16u, 8u}, std::pair{17u, 9u}}) {
    const std::string path = in("film" + std::to_string(width) + ".y4m");
    auto film = makeY4mFilm(path, 29.97, false);
    ASSERT_TRUE(film.ok());
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(film.value()->add(gradient(width, height)).ok());
    EXPECT_FALSE(fs::exists(path)) << "not under its name before it is whole";
    ASSERT_TRUE(film.value()->finish().ok());
    const std::string bytes = bytesOf(path);
    const std::string header = "YUV4MPEG2 W" + std::to_string(width) + " H" + std::to_string(height) +
                               " F2997:100 Ip A1:1 C420jpeg XCOLORRANGE=LIMITED\n";
    EXPECT_EQ(bytes.substr(0, header.size()), header);
    const std::size_t frame = 6 + width * height + 2 * ((width + 1) / 2) * ((height + 1) / 2);
    EXPECT_EQ(bytes.size(), header.size() + 3 * frame);
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(bytes.substr(header.size() + static_cast<std::size_t>(i) * frame, 6), "FRAME\n");
  }
}

TEST_F(Film, Y4mColoursAreBt601) {
  const std::string path = in("colour.y4m");
  render::Image red(2, 2);
  for (std::size_t i = 0; i < 16; i += 4) red.rgba[i] = 255, red.rgba[i + 3] = 255;
  auto film = makeY4mFilm(path, 25, false);
  ASSERT_TRUE(film.value()->add(red).ok());
  ASSERT_TRUE(film.value()->finish().ok());
  const std::string bytes = bytesOf(path);
  const std::string planes = bytes.substr(bytes.size() - 6);
  // Red in BT.601, limited range: Y 81, Cb 90, Cr 240.
  EXPECT_EQ(static_cast<unsigned char>(planes[0]), 81);
  EXPECT_EQ(static_cast<unsigned char>(planes[4]), 90);
  EXPECT_EQ(static_cast<unsigned char>(planes[5]), 240);
}

TEST_F(Film, UnfinishedFilmLeavesNothing) {
  {
    auto film = makeY4mFilm(in("film.y4m"), 25, false);
    ASSERT_TRUE(film.value()->add(gradient(8, 8)).ok());
    EXPECT_EQ(filesIn(), 1u);
  }
  EXPECT_EQ(filesIn(), 0u);
  EXPECT_FALSE(makeY4mFilm(in("film.y4m"), 0, false).ok());
  EXPECT_EQ(filesIn(), 0u);
}

TEST_F(Film, ContactSheetPlacesTiles) {
  ContactSheet sheet(2, 3, 0);
  for (const int level : {10, 100, 200}) {
    render::Image frame(40, 20);
    for (std::size_t i = 0; i < frame.rgba.size(); ++i)
      frame.rgba[i] = static_cast<std::uint8_t>(i % 4 == 3 ? 255 : level);
    sheet.add(frame);
  }
  const render::Image image = sheet.compose();
  EXPECT_EQ(image.width, 2 * 40 + 3 * 6u);
  EXPECT_EQ(image.height, 2 * 20 + 3 * 6u);
  EXPECT_EQ(image.row(10)[4 * 10], 10);
  EXPECT_EQ(image.row(10)[4 * 60], 100);
  EXPECT_EQ(image.row(40)[4 * 10], 200);
  EXPECT_EQ(image.row(40)[4 * 60], 255) << "no fourth frame: white";
}

TEST_F(Film, ContactSheetTakesFramesEvenlyWithBothEnds) {
  ContactSheet sheet(3, 11, 3);
  for (int i = 0; i <= 10; ++i) {
    render::Image frame(30, 20);
    std::fill(frame.rgba.begin(), frame.rgba.end(), static_cast<std::uint8_t>(20 * i));
    sheet.add(frame);
  }
  const render::Image image = sheet.compose();
  EXPECT_EQ(image.row(10)[4 * 10], 0);
  EXPECT_EQ(image.row(10)[4 * 46], 100);
  EXPECT_EQ(image.row(10)[4 * 82], 200);
}

TEST_F(Film, ScalingAveragesInLinearLight) {
  render::Image checker(2, 2);
  for (std::size_t i = 0; i < 16; ++i) checker.rgba[i] = (i / 4 == 0 || i / 4 == 3 || i % 4 == 3) ? 255 : 0;
  EXPECT_EQ(render::boxFilter(checker, 2).rgba[0], 188) << "half the light, not half the code";
  const render::Image third = render::scaleDown(gradient(90, 60), 31, 17);
  EXPECT_EQ(third.width, 31u);
  EXPECT_EQ(third.rgba[3], 255);
}

TEST_F(Film, PlaysWithCostsAndOrbit) {
  auto file = dyntri::File::open(test::writeTestSphere("film_play.t4d", 4));
  ASSERT_TRUE(file.ok());
  const scene::WorldBox box = scene::worldBox(file.value().header().index_to_world, file.value().header().bounds);
  host::Film film{{{&file.value(), std::nullopt, true}}, scene::defaultShot(box, 1.6), {160, 100, 1}, true, 90, {}};
  for (const double time : {0.0, 0.5, 1.0, 3.0}) film.times.push_back(pictureTime(film.files, time));
  stream::Pager source(file.value(), {});
  const std::array<stream::Pager*, 1> sources{&source};
  auto renderer = makeOffscreenRenderer("cpu", 1, 0);
  auto sink = makePngFrames(in("f%d.png"), film.times.size(), false);
  ContactSheet sheet(2, film.times.size(), 0);
  std::vector<FrameCost> costs;
  const Status played = play(film, sources, *renderer.value(), sink.value().get(), &sheet,
                             [&](const FrameCost& cost) { costs.push_back(cost); });
  ASSERT_TRUE(played.ok()) << played.fault().what;
  EXPECT_EQ(filesIn(), 4u);
  ASSERT_EQ(costs.size(), 4u);
  EXPECT_GT(costs[0].bytes_touched, 0u);
  EXPECT_EQ(costs[1].bytes_touched, 0u) << "the page of the frame before";
  EXPECT_GT(costs[3].drawn, 0u) << "the last time is not empty";
  for (const FrameCost& cost : costs) EXPECT_GE(cost.processed, cost.drawn);
  EXPECT_EQ(sheet.compose().width, 2 * 160 + 3 * 6u);
}

// Keeps the pictures.
class KeptFilm final : public FrameSink {
 public:
  Status add(const render::Image& image) override { return pictures.push_back(image), Status{}; }
  Status finish() override { return finished = true, Status{}; }
  std::vector<render::Image> pictures;
  bool finished = false;
};

// OpenGL starts a picture before the one in front of it is read: the film has the same pictures, in order.
TEST_F(Film, PicturesDrawnAheadAreThoseDrawnOneByOne) {
  auto file = dyntri::File::open(test::writeTestSphere("film_ahead.t4d", 4));
  ASSERT_TRUE(file.ok());
  const scene::WorldBox box = scene::worldBox(file.value().header().index_to_world, file.value().header().bounds);
  for (const std::string name : {"cpu", "gl"}) {
    if (name == "gl" && !hasOffscreenGl()) continue;
    for (const std::size_t count : {0u, 1u, 2u, 7u}) {
      host::Film film{{{&file.value(), std::nullopt, true}}, scene::defaultShot(box, 1.6), {90, 60, 4}, true, 120, {}};
      for (std::size_t i = 0; i < count; ++i)
        film.times.push_back(pictureTime(film.files, 3.0 * static_cast<double>(i) / 7));
      stream::Pager source(file.value(), {});
      const std::array<stream::Pager*, 1> sources{&source};
      auto ahead = makeOffscreenRenderer(name, 1, 1u << 30), one_by_one = makeOffscreenRenderer(name, 1, 1u << 30);
      ASSERT_TRUE(ahead.ok() && one_by_one.ok());
      EXPECT_EQ(ahead.value()->picturesAhead(), name == "gl" ? 1u : 0u);
      KeptFilm kept, single;
      std::vector<std::size_t> told;
      ASSERT_TRUE(play(film, sources, *ahead.value(), &kept, nullptr, [&](const FrameCost& cost) {
                    told.push_back(cost.index);
                  }).ok());
      EXPECT_TRUE(kept.finished);
      ASSERT_EQ(kept.pictures.size(), count);
      ASSERT_EQ(told.size(), count);
      for (std::size_t i = 0; i < count; ++i) {
        host::Film alone = film;
        alone.orbit_degrees = 0;
        alone.shot = shotOfFrame(film, i);
        alone.times = {film.times[i]};
        ASSERT_TRUE(play(alone, sources, *one_by_one.value(), &single, nullptr, [](const FrameCost&) {}).ok());
        EXPECT_EQ(kept.pictures[i].rgba, single.pictures.back().rgba) << name << ", picture " << i << " of " << count;
        EXPECT_EQ(told[i], i);
        if (i > 0) {
          EXPECT_NE(kept.pictures[i].rgba, kept.pictures[i - 1].rgba);
        }
      }
    }
  }
}

TEST(Offscreen, RendererNames) {
  EXPECT_TRUE(makeOffscreenRenderer("cpu", 1, 0).ok());
  auto other = makeOffscreenRenderer("vulkan", 1, 0);
  ASSERT_FALSE(other.ok());
  EXPECT_EQ(other.fault().code, FaultCode::kUsage);
  auto gl = makeOffscreenRenderer("gl", 1, 0);
  EXPECT_EQ(gl.ok(), hasOffscreenGl());
  if (!gl.ok()) {
    EXPECT_EQ(gl.fault().code, FaultCode::kNotBuilt);
    EXPECT_NE(gl.fault().remedy.find("--renderer cpu"), std::string::npos);
    EXPECT_NE(gl.fault().remedy.find("TET4D_WITH_OSMESA"), std::string::npos);
  }
}

}  // namespace
}  // namespace tet4d::host
