// VTK images and series of them as frames.
#include <gtest/gtest.h>

#include <numeric>

#include "libpreprocess/exchange/frame_source.h"
#include "libpreprocess/exchange/read_vti.h"
#include "libpreprocess/exchange/write_frames.h"
#include "tests/exchange/nrrd_samples.h"
#include "tests/exchange/support.h"
#include "tests/exchange/vtk_samples.h"

namespace tet4d::exchange {
namespace {

using testing::bytesOf;
using testing::faultOf;
using testing::nativeSamples;
using testing::Scratch;
using testing::VtkForm;
using testing::VtkStyle;
using testing::VtkText;

std::vector<std::byte> layersOf(FrameFile& file, std::uint64_t begin, std::uint64_t end) {
  std::vector<std::byte> samples((end - begin) * file.header().grid.layerBytes());
  file.readLayers(0, begin, end, samples);
  return samples;
}

template <class T>
std::vector<T> valuesOf(FrameFile& file) {
  std::vector<T> values(file.header().grid.voxels());
  file.readFrame(0, std::as_writable_bytes(std::span(values)));
  return values;
}

TEST(Vti, IsReadInEveryStyle) {
  const Scratch scratch;
  for (const VtkStyle& style : testing::allVtkStyles()) {
    const auto file = openFrameFile(scratch.write("a.vti", testing::smallVti(style)));
    const FrameFileHeader& header = file->header();
    EXPECT_EQ(header.grid.dims, (std::array<std::uint64_t, 3>{4, 3, 2}));
    EXPECT_EQ(header.grid.type, SampleType::kF32);
    EXPECT_EQ(header.grid.index_to_world.origin, (std::array<double, 3>{1, 2, 3}));
    EXPECT_EQ(header.grid.index_to_world.axes[2], (std::array<double, 3>{0, 0, 2}));
    EXPECT_EQ(header.times, std::vector<double>{2.5});
    EXPECT_EQ(layersOf(*file, 0, 2), nativeSamples(SampleType::kF32, 24)) << style.name();
    EXPECT_EQ(layersOf(*file, 1, 2), nativeSamples(SampleType::kF32, 12, 12)) << style.name();
    file->close();
    EXPECT_EQ(layersOf(*file, 0, 1), nativeSamples(SampleType::kF32, 12)) << style.name();
  }
}

// An image of 5 x 4 x 4 points at an extent that does not begin at 0, in eight pieces, with cells and a vector.
std::string pieces(const VtkStyle& style) {
  VtkText text(style);
  std::string body;
  for (unsigned corner = 0; corner < 8; ++corner) {
    // Pieces share their points: x 2..4, 4..6; y -1..0, 0..2; z 0..1, 1..3.
    const std::array<int, 3> first{corner & 1 ? 4 : 2, corner & 2 ? 0 : -1, corner & 4 ? 1 : 0};
    const std::array<int, 3> last{corner & 1 ? 6 : 4, corner & 2 ? 2 : 0, corner & 4 ? 3 : 1};
    std::vector<std::int16_t> points, cells;
    std::vector<float> vectors;
    std::string extent;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      extent += std::to_string(first[axis]) + " " + std::to_string(last[axis]) + " ";
    }
    for (int z = first[2]; z <= last[2]; ++z) {
      for (int y = first[1]; y <= last[1]; ++y) {
        for (int x = first[0]; x <= last[0]; ++x) {
          const auto value = static_cast<std::int16_t>(x + 10 * y + 100 * z);
          points.push_back(value);
          for (const int c : {1, 2, 3}) vectors.push_back(static_cast<float>(c * 1000 + value));
          if (x < last[0] && y < last[1] && z < last[2]) cells.push_back(static_cast<std::int16_t>(-value));
        }
      }
    }
    body += "<Piece Extent=\"" + extent + "\">\n<PointData Vectors=\"U\">\n" +
            text.array(SampleType::kI16, "p", 1, bytesOf(points)) +
            text.array(SampleType::kF32, "U", 3, bytesOf(vectors)) + "</PointData>\n<CellData>\n" +
            text.array(SampleType::kI16, "c", 1, bytesOf(cells)) + "</CellData></Piece>\n";
  }
  return text.file("ImageData",
                   "<ImageData WholeExtent=\"2 6 -1 2 0 3\" Origin=\"10 20 30\" Spacing=\"1 2 4\" "
                   "Direction=\"0 -1 0 1 0 0 0 0 1\">\n" +
                       body + "</ImageData>\n");
}

TEST(Vti, PiecesPointsCellsAndComponents) {
  const Scratch scratch;
  for (const VtkStyle& style : testing::allVtkStyles()) {
    const std::string path = scratch.write("a.vti", pieces(style));
    const auto points = openVti(path, "p"), cells = openVti(path, "c"), second = openVti(path, "U:1");
    EXPECT_EQ(points->header().grid.dims, (std::array<std::uint64_t, 3>{5, 4, 4}));
    EXPECT_EQ(cells->header().grid.dims, (std::array<std::uint64_t, 3>{4, 3, 3}));
    // Direction turns x to y and y to -x; point (2, -1, 0) of the extent is the first.
    const auto origin = std::array<double, 3>{10 + 2, 20 + 2, 30};
    EXPECT_EQ(points->header().grid.index_to_world.origin, origin);
    EXPECT_EQ(points->header().grid.index_to_world.axes[1], (std::array<double, 3>{-2, 0, 0}));
    EXPECT_EQ(cells->header().grid.index_to_world.origin, (std::array<double, 3>{12 - 1, 22 + 0.5, 32}));
    const auto p = valuesOf<std::int16_t>(*points), c = valuesOf<std::int16_t>(*cells);
    const auto u = valuesOf<float>(*second);
    for (int z = 0; z < 4; ++z) {
      for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 5; ++x) {
          const auto value = static_cast<std::int16_t>(x + 2 + 10 * (y - 1) + 100 * z);
          ASSERT_EQ(p[static_cast<std::size_t>((z * 4 + y) * 5 + x)], value);
          ASSERT_EQ(u[static_cast<std::size_t>((z * 4 + y) * 5 + x)], static_cast<float>(2000 + value));
          if (x < 4 && y < 3 && z < 3) {
            ASSERT_EQ(c[static_cast<std::size_t>((z * 3 + y) * 4 + x)], -value);
          }
        }
      }
    }
  }
}

TEST(Vti, ChoosesArraysByName) {
  const Scratch scratch;
  const std::string path = scratch.write("a.vti", pieces({}));
  const auto messageOf = [&](const std::string& array) {
    const Fault fault = faultOf([&] { openVti(path, array); });
    return fault.what + "; " + fault.remedy;
  };
  const auto expect = [&](const std::string& array, const std::string& words) {
    EXPECT_NE(messageOf(array).find(words), std::string::npos) << messageOf(array);
  };
  expect("", "2 scalar arrays, none of them the active one; choose one of: p, U (3 components), c (of cells)");
  expect("U", "has 3 components, one is needed; choose one of them: U:0 is the first");
  expect("U:3", "has 3 components, not 3");
  expect("P", "has no array \"P\"");
  const std::string one = testing::smallVti({});
  EXPECT_NE(faultOf([&] { openVti(scratch.write("b.vti", one), "pressure"); }).what.find("pressure"),
            std::string::npos);
  EXPECT_EQ(openVti(scratch.write("b.vti", one), "a:0")->header().grid.voxels(), 24U);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), std::string::npos) << from;
  return text.replace(text.find(from), from.size(), to);
}

TEST(VtkHostile, ImagesThatDoNotFitTogether) {
  const Scratch scratch;
  const std::string good = testing::smallVti({VtkForm::kAscii});
  const std::string extent = "<Piece Extent=\"0 3 0 2 0 1\">", whole = "WholeExtent=\"0 3 0 2 0 1\"";
  const std::string piece = good.substr(good.find("<Piece"), good.find("</ImageData>") - good.find("<Piece"));
  const std::vector<std::pair<std::string, std::string>> refusals{
      {replaced(good, whole, ""), "WholeExtent is missing"},
      {replaced(good, whole, "WholeExtent=\"0 3 0 2 0\""), "six whole numbers"},
      {replaced(good, whole, "WholeExtent=\"0 3 0 2 1 0\""), "six whole numbers"},
      {replaced(good, whole, "WholeExtent=\"0 3 0 2 0 99999999999\""), "six whole numbers"},
      {replaced(good, whole, "WholeExtent=\"0 2147483648 0 2147483648 0 2147483648\""), "2^60"},
      {replaced(good, whole, "WholeExtent=\"0 3 0 2 0 2\""), "6 of the 12 cells"},
      {replaced(good, whole, "WholeExtent=\"1 3 0 2 0 1\""), "leaves the image's WholeExtent"},
      {replaced(good, extent, "<Piece Extent=\"0 3 0 2 0 x\">"), "six whole numbers"},
      {replaced(good, piece, piece + piece), "pieces 0 and 1 overlap"},
      {replaced(good, piece, ""), "no <Piece>"},
      {replaced(good, "Spacing=\"0.5 1 2\"", "Spacing=\"0.5 0 2\""), "do not span space"},
      {replaced(good, "Spacing=\"0.5 1 2\"", "Spacing=\"0.5 nan 2\""), "3 finite numbers"},
      {replaced(good, "Spacing=\"0.5 1 2\"", "Spacing=\"0.5 1\""), "3 finite numbers"},
      {replaced(good, "Spacing=\"0.5 1 2\"", "Direction=\"1 0 0 1 0 0 0 0 1\""), "do not span space"},
      {replaced(good, "\"Float32\"", "\"Bit\""), "no numeric array"},
      {replaced(good, "2.5", "inf"), "time is inf"},
      {replaced(good, "ImageData", "PolyData"), "of type \"PolyData\", expected ImageData"},
  };
  for (const auto& [text, words] : refusals) {
    const std::string path = scratch.write("a.vti", text);
    const Fault fault = faultOf([&] { openVti(path, ""); });
    const std::string message = fault.place + ": " + fault.what + "; " + fault.remedy;
    EXPECT_NE(message.find(words), std::string::npos) << message << "\n for " << text.substr(0, 400);
    EXPECT_EQ(fault.file, path);
  }
}

TEST(VtkStiff, AFlatImageOfCellsHasOneLayer) {
  const Scratch scratch;
  VtkText text({});
  const std::string values = text.array(SampleType::kU8, "c", 1, std::string("\1\2\3\4\5\6", 6));
  const std::string path =
      scratch.write("a.vti", text.file("ImageData",
                                       "<ImageData WholeExtent=\"0 3 0 2 7 7\" Origin=\"0 0 0\" Spacing=\"1 1 3\">"
                                       "<Piece Extent=\"0 3 0 2 7 7\"><CellData>" +
                                           values + "</CellData></Piece></ImageData>"));
  const auto file = openVti(path, "");
  EXPECT_EQ(file->header().grid.dims, (std::array<std::uint64_t, 3>{3, 2, 1}));
  EXPECT_EQ(file->header().grid.index_to_world.origin, (std::array<double, 3>{0.5, 0.5, 21}));
  EXPECT_EQ(valuesOf<std::uint8_t>(*file), (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6}));
}

std::string pvd(const std::string& steps) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\"><Collection>\n" + steps + "</Collection></VTKFile>\n";
}

TEST(Pvd, NamesFramesAndTheirTimes) {
  const Scratch scratch;
  const std::string first = testing::smallVti({}), second = testing::smallVti({VtkForm::kInline, true, false, true});
  scratch.write("run/one.vti", first);
  scratch.write("run/two.vti", second);
  const std::string series =
      scratch.write("s.pvd", pvd("<DataSet timestep=\"0.5\" part=\"0\" file=\"run/two.vti\"/>\n"
                                 "<DataSet timestep=\"-1e9\" part=\"0\" file=\"run/one.vti\"/>"));
  const auto frames = openFrames({series});
  EXPECT_EQ(frames->times(), (std::vector<double>{-1e9, 0.5}));  // the series' times, not those of the files
  EXPECT_EQ(frames->frameName(1), scratch.path("run/two.vti"));
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(testing::frameOf(*frames, k), nativeSamples(SampleType::kF32, 24));
  EXPECT_EQ(openFrames({series}, {false, {1, 2}, {}})->times(), (std::vector<double>{1, 2}));
}

TEST(Pvd, Refusals) {
  const Scratch scratch;
  scratch.write("one.vti", testing::smallVti({}));
  const std::string one = "<DataSet timestep=\"1\" file=\"one.vti\"/>";
  const std::vector<std::pair<std::string, std::string>> refusals{
      {pvd(""), "names no files"},
      {pvd("<DataSet timestep=\"x\" file=\"one.vti\"/>"), "timestep is \"x\""},
      {pvd("<DataSet timestep=\"nan\" file=\"one.vti\"/>"), "timestep is \"nan\""},
      {pvd("<DataSet file=\"one.vti\"/>"), "timestep is missing"},
      {pvd("<DataSet timestep=\"1\"/>"), "file is missing"},
      {pvd("<DataSet timestep=\"1\" file=\"gone.vti\"/>"), "cannot be opened"},
      {pvd(one + one), "several files are of this time"},
      {"<VTKFile type=\"ImageData\"/>", "expected Collection"},
  };
  for (const auto& [text, words] : refusals) {
    const std::string path = scratch.write("s.pvd", text);
    const Fault fault = faultOf([&] { openFrames({path}); });
    EXPECT_NE(fault.what.find(words), std::string::npos) << fault.what;
  }
}

TEST(Vti, AFolderOfImagesIsASequence) {
  const Scratch scratch;
  for (const int k : {9, 10}) {
    std::string text = testing::smallVti({VtkForm::kAscii});
    scratch.write("f/a" + std::to_string(k) + ".vti", replaced(text, "2.5", std::to_string(k)));
  }
  EXPECT_EQ(openFrames({scratch.path("f")})->times(), (std::vector<double>{9, 10}));
  EXPECT_EQ(openFrames({scratch.path("f/a%d.vti")})->times(), (std::vector<double>{9, 10}));
}

}  // namespace
}  // namespace tet4d::exchange
