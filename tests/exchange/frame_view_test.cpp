// Parts of sequences against picking samples one by one.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "libpreprocess/exchange/frame_view.h"
#include "tests/exchange/nrrd_samples.h"
#include "tests/exchange/support.h"
#include "tests/hypermesh/memory_frames.h"

namespace tet4d::exchange {
namespace {

using testing::faultOf;
using testing::frameByLayers;
using testing::frameOf;
using Frames = hypermesh::testing::MemoryFrames<std::int16_t>;

constexpr std::array<std::uint64_t, 3> kDims{7, 6, 5};
constexpr std::size_t kFrames = 9;

std::int16_t valueAt(std::uint64_t x, std::uint64_t y, std::uint64_t z, std::uint64_t k) {
  return static_cast<std::int16_t>(((k * 5 + z) * 6 + y) * 7 + x);
}

std::unique_ptr<FrameSource> wholeFrames() { return std::make_unique<Frames>(kDims, kFrames, valueAt); }

std::vector<std::int16_t> valuesOf(const std::vector<std::byte>& bytes) {
  std::vector<std::int16_t> values(bytes.size() / 2);
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

TEST(FrameView, AnyBoxAndStrideHoldsThePickedSamples) {
  std::mt19937 random(5);
  const auto upTo = [&](std::uint64_t most) { return random() % (most + 1); };
  for (int round = 0; round < 300; ++round) {
    FrameViewOptions view;
    view.crop.emplace();
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint64_t first = upTo(kDims[c] - 1);
      (*view.crop)[c] = {first, first + upTo(kDims[c] - 1 - first)};
      if (round % 4 == 0 && c < 2) (*view.crop)[c] = {};  // whole layers
      view.stride[c] = round % 3 == 0 ? 1 : 1 + upTo(3);
    }
    view.frames.first = upTo(kFrames - 1);
    view.frames.last = view.frames.first + upTo(kFrames - 1 - view.frames.first);
    view.frame_step = 1 + upTo(3);
    const auto source = viewFrames(wholeFrames(), view);
    std::size_t j = 0;
    for (std::uint64_t k = view.frames.first; k <= view.frames.last; k += view.frame_step, ++j) {
      std::vector<std::int16_t> expected;
      const auto& box = *view.crop;
      for (std::uint64_t z = box[2].first; z <= std::min(box[2].last, kDims[2] - 1); z += view.stride[2])
        for (std::uint64_t y = box[1].first; y <= std::min(box[1].last, kDims[1] - 1); y += view.stride[1])
          for (std::uint64_t x = box[0].first; x <= std::min(box[0].last, kDims[0] - 1); x += view.stride[0])
            expected.push_back(valueAt(x, y, z, k));
      ASSERT_EQ(source->grid().voxels(), expected.size());
      ASSERT_EQ(valuesOf(frameOf(*source, j)), expected);
      ASSERT_EQ(valuesOf(frameByLayers(*source, j)), expected);
      ASSERT_EQ(source->times()[j], static_cast<double>(k));
      ASSERT_EQ(source->frameName(j), "memory frame " + std::to_string(k));
    }
    ASSERT_EQ(source->times().size(), j);
    ASSERT_FALSE(source->hasFrame(j));
  }
}

TEST(FrameView, PositionsStayWhereTheyWere) {
  const testing::Scratch scratch;
  const std::string path = scratch.write(
      "a.nrrd",
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 7 6 5\nspace dimension: 3\nspace directions: (0,0.25,0) (-2,0,0.5) "
      "(0,0,8)\nspace origin: (1,2,3)\nencoding: raw\n\n" +
          testing::sampleText(SampleType::kU8, 210, false));
  const auto whole = openFrames({path});
  FrameViewOptions view;
  view.crop = {{{1, 6}, {2, 5}, {1, 4}}};
  view.stride = {2, 3, 1};
  const auto part = viewFrames(openFrames({path}), view);
  for (std::uint64_t z = 0; z < part->grid().dims[2]; ++z)
    for (std::uint64_t y = 0; y < part->grid().dims[1]; ++y)
      for (std::uint64_t x = 0; x < part->grid().dims[0]; ++x) {
        const std::array<double, 3> here{double(x), double(y), double(z)};
        const std::array<double, 3> there{double(1 + 2 * x), double(2 + 3 * y), double(1 + z)};
        EXPECT_EQ(toWorld(part->grid().index_to_world, here), toWorld(whole->grid().index_to_world, there));
      }
}

TEST(FrameView, AWholeViewIsTheSourceItself) {
  auto source = wholeFrames();
  const FrameSource* const before = source.get();
  EXPECT_EQ(viewFrames(std::move(source), {}).get(), before);
}

TEST(FrameView, RangesOutsideAreNamed) {
  const auto refused = [](auto change, const std::vector<std::string>& words) {
    FrameViewOptions view;
    view.crop.emplace();
    change(view);
    const Fault fault = faultOf([&] { viewFrames(wholeFrames(), view); });
    const std::string message = fault.place + ": " + fault.what;
    EXPECT_EQ(fault.code, FaultCode::kUsage);
    for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << " in " << message;
  };
  constexpr std::uint64_t kHuge = std::numeric_limits<std::uint64_t>::max() - 1;
  refused([](FrameViewOptions& view) { (*view.crop)[1] = {2, 6}; }, {"--crop", "2:6", "along y", "0:5"});
  refused([](FrameViewOptions& view) { (*view.crop)[2] = {5, 5}; }, {"--crop", "5:5", "along z", "0:4"});
  refused([](FrameViewOptions& view) { (*view.crop)[0] = {3, 2}; }, {"--crop", "3:2", "empty"});
  refused([](FrameViewOptions& view) { (*view.crop)[0] = {0, kHuge}; }, {"--crop", "along x"});
  refused([](FrameViewOptions& view) { view.frames = {4, 9}; }, {"--frames", "4:9", "0:8"});
  refused(
      [](FrameViewOptions& view) {
        view.frames = {9, std::numeric_limits<std::uint64_t>::max()};
      },
      {"--frames", "9:", "0:8"});
  refused([](FrameViewOptions& view) { view.frames = {5, 4}; }, {"--frames", "5:4", "empty"});
  refused([](FrameViewOptions& view) { view.stride = {1, 0, 1}; }, {"--stride", "0"});
  refused([](FrameViewOptions& view) { view.frame_step = 0; }, {"--time-stride", "0"});
}

TEST(FrameViewStiff, HugeStepsLeaveOneSampleAndOneFrame) {
  FrameViewOptions view;
  constexpr std::uint64_t kHuge = std::numeric_limits<std::uint64_t>::max();
  view.stride = {kHuge, kHuge, kHuge};
  view.frame_step = kHuge;
  const auto source = viewFrames(wholeFrames(), view);
  EXPECT_EQ(source->grid().voxels(), 1u);
  EXPECT_EQ(source->times(), std::vector<double>{0});
  EXPECT_EQ(valuesOf(frameOf(*source, 0)), std::vector<std::int16_t>{0});
}

}  // namespace
}  // namespace tet4d::exchange
