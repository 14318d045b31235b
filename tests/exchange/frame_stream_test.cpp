// Frames through pipes: in pieces of any size, NRRDs and raw, and what is said of streams that break.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <thread>

#include "libpreprocess/exchange/frame_stream.h"
#include "libpreprocess/exchange/frame_view.h"
#include "tests/exchange/nrrd_samples.h"
#include "tests/exchange/support.h"

namespace tet4d::exchange {
namespace {

using testing::faultOf;
using testing::frameByLayers;
using testing::frameOf;
using testing::gzipped;
using testing::nativeSamples;
using testing::sampleText;
using testing::smallFile;
using testing::smallHeader;

// A pipe that a thread fills with pieces of the text.
class Pipe {
 public:
  Pipe(std::string text, std::size_t piece) {
    std::signal(SIGPIPE, SIG_IGN);  // a reader that stops early is no fault of the test
    if (::pipe(ends_) != 0) throw std::runtime_error("no pipe");
    writer_ = std::thread([text = std::move(text), piece, end = ends_[1]] {
      for (std::size_t at = 0; at < text.size(); at += piece) {
        const std::size_t part = std::min(piece, text.size() - at);
        if (::write(end, text.data() + at, part) != static_cast<ssize_t>(part)) break;
      }
      ::close(end);
    });
  }
  ~Pipe() {
    ::close(ends_[0]);
    writer_.join();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int end() const { return ends_[0]; }

 private:
  int ends_[2];
  std::thread writer_;
};

std::string nrrds(std::size_t count, bool with_times = false) {
  std::string text;
  for (std::size_t k = 0; k < count; ++k)
    text += smallFile(with_times ? "time:=" + std::to_string(10 + k * k) + "\n" : "", 100 * k);
  return text;
}

std::string gzipNrrd(std::uint64_t first) {
  return smallHeader("gzip") + "\n" + gzipped(sampleText(SampleType::kF32, 12, false, first));
}

FrameSourceOptions rawOptions() {
  FrameSourceOptions options;
  options.file.raw = RawLayout{};
  options.file.raw->dims = {2, 3, 2};
  return options;
}

// Reads to the end; frame k must begin with 100 * k.
void expectFrames(FrameSource& source, std::size_t count, bool by_layers = false) {
  EXPECT_TRUE(source.isStream());
  std::size_t k = 0;
  for (; source.hasFrame(k); ++k) {
    ASSERT_EQ(source.times().size(), k + 1);
    ASSERT_EQ(by_layers ? frameByLayers(source, k) : frameOf(source, k), nativeSamples(SampleType::kF32, 12, 100 * k))
        << k;
  }
  EXPECT_EQ(k, count);
  EXPECT_FALSE(source.hasFrame(k));
}

Fault faultOfStream(const std::string& text, const FrameSourceOptions& options = {}) {
  const Pipe pipe(text, text.size() + 1);
  return faultOf([&] {
    const auto source = openFrameStream(pipe.end(), "standard input", options);
    for (std::size_t k = 0; source->hasFrame(k); ++k) frameOf(*source, k);
  });
}

void expectFault(const Fault& fault, const std::vector<std::string>& words) {
  const std::string message = fault.file + ": " + fault.place + ": " + fault.what + "; " + fault.remedy;
  for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << " in " << message;
}

TEST(FrameStream, NrrdsInPiecesOfAnySize) {
  for (const std::size_t piece : {1U, 7U, 150U, 100000U}) {
    const Pipe pipe(nrrds(5), piece);
    const auto source = openFrameStream(pipe.end(), "p", {});
    EXPECT_EQ(source->grid().dims, (std::array<std::uint64_t, 3>{2, 3, 2}));
    EXPECT_EQ(source->frameName(3), "p frame 3");
    expectFrames(*source, 5, piece == 7);
    EXPECT_EQ(source->times(), (std::vector<double>{0, 1, 2, 3, 4}));
  }
}

TEST(FrameStream, LargeFramesAreReadPastTheBuffer) {
  const std::string samples = sampleText(SampleType::kU16, 100 * 100 * 10, false);
  const std::string header =
      "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 100 100 10\nencoding: raw\nendian: little\n\n";
  const Pipe pipe(header + samples + header + samples, 4099);
  const auto source = openFrameStream(pipe.end(), "p", {});
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(frameOf(*source, k), nativeSamples(SampleType::kU16, 100000));
  EXPECT_FALSE(source->hasFrame(2));
}

TEST(FrameStream, TimesAreToldOrGivenOrCounted) {
  const Pipe told(nrrds(3, true), 50);
  const auto source = openFrameStream(told.end(), "p", {});
  expectFrames(*source, 3);
  EXPECT_EQ(source->times(), (std::vector<double>{10, 11, 14}));
  FrameSourceOptions options;
  options.times = {1, 5, 6};
  const Pipe given(nrrds(3, true), 50);
  const auto other = openFrameStream(given.end(), "p", options);
  expectFrames(*other, 3);
  EXPECT_EQ(other->times(), options.times);
  expectFault(faultOfStream(nrrds(4), options), {"3 times are given", "more frames"});
  expectFault(faultOfStream(nrrds(2), options), {"3 times are given for 2 frames"});
}

TEST(FrameStream, GzipMembersAndMixedEncodings) {
  for (const std::size_t piece : {1U, 13U, 100000U}) {
    const Pipe pipe(gzipNrrd(0) + gzipNrrd(100) + smallFile("", 200) + gzipNrrd(300), piece);
    const auto source = openFrameStream(pipe.end(), "p", {});
    expectFrames(*source, 4, piece == 13);
  }
}

TEST(FrameStream, AFileOfManyFramesInTheStream) {
  std::string samples;
  for (std::uint64_t k = 0; k < 3; ++k) samples += sampleText(SampleType::kF32, 12, false, 100 * k);
  const std::string header =
      "NRRD0004\ntype: float\ndimension: 4\nsizes: 2 3 2 3\nendian: little\nspacings: 1 1 1 0.25\nencoding: ";
  for (const std::string& text : {header + "raw\n\n" + samples, header + "gzip\n\n" + gzipped(samples)}) {
    const Pipe pipe(text, 64);
    const auto source = openFrameStream(pipe.end(), "p", {});
    expectFrames(*source, 3);
    EXPECT_EQ(source->times(), (std::vector<double>{0, 0.25, 0.5}));
  }
}

TEST(FrameStream, RawFrames) {
  std::string text = "skipped";
  for (std::uint64_t k = 0; k < 4; ++k) text += sampleText(SampleType::kF32, 12, true, 100 * k);
  FrameSourceOptions options = rawOptions();
  options.file.raw->skip = 7;
  options.file.raw->big_endian = true;
  for (const std::size_t piece : {1U, 48U, 100000U}) {
    const Pipe pipe(text, piece);
    const auto source = openFrameStream(pipe.end(), "p", options);
    expectFrames(*source, 4, piece == 48);
  }
  options.times = {1, 2};
  expectFault(faultOfStream(text, options), {"2 times are given", "more frames"});
}

TEST(FrameStream, FramesAndLayersMayBePassedOver) {
  for (const bool gzip : {false, true}) {
    std::string text;
    for (std::uint64_t k = 0; k < 4; ++k) text += gzip ? gzipNrrd(100 * k) : smallFile("", 100 * k);
    const Pipe pipe(text, 31);
    const auto source = openFrameStream(pipe.end(), "p", {});
    std::vector<std::byte> layer(24);
    source->readLayers(0, 1, 2, layer);
    EXPECT_EQ(layer, nativeSamples(SampleType::kF32, 6, 6));
    source->readLayers(2, 0, 1, layer);
    EXPECT_EQ(layer, nativeSamples(SampleType::kF32, 6, 200));
    EXPECT_EQ(faultOf([&] { source->readLayers(2, 0, 1, layer); }).code, FaultCode::kUsage) << "gone by";
    EXPECT_EQ(faultOf([&] { source->readLayers(1, 0, 1, layer); }).code, FaultCode::kUsage) << "gone by";
    EXPECT_TRUE(source->hasFrame(3));
    EXPECT_EQ(frameOf(*source, 3), nativeSamples(SampleType::kF32, 12, 300));
    EXPECT_EQ(faultOf([&] { source->readLayers(4, 0, 1, layer); }).code, FaultCode::kUsage) << "does not come";
  }
}

TEST(FrameStreamStiff, EveryPrefixIsAWholeSequenceOrAnErrorThatNamesTheFrame) {
  std::string raw;
  for (std::uint64_t k = 0; k < 3; ++k) raw += sampleText(SampleType::kF32, 12, false, 100 * k);
  const std::size_t one = nrrds(1).size();
  const std::string gzip = gzipNrrd(0) + gzipNrrd(100);
  struct Case {
    std::string text;
    std::vector<std::size_t> ends;  // of whole frames
    FrameSourceOptions options;
  };
  const std::vector<Case> cases{{nrrds(3), {one, 2 * one, 3 * one}, {}},
                                {gzip, {gzipNrrd(0).size(), gzip.size()}, {}},
                                {raw, {48, 96, 144}, rawOptions()}};
  for (const Case& c : cases) {
    for (std::size_t length = 0; length <= c.text.size(); ++length) {
      const Pipe pipe(c.text.substr(0, length), 1000);
      const auto read = [&] {
        const auto source = openFrameStream(pipe.end(), "standard input", c.options);
        std::size_t k = 0;
        for (; source->hasFrame(k); ++k) frameOf(*source, k);
        return k;
      };
      const auto end = std::find(c.ends.begin(), c.ends.end(), length);
      if (end != c.ends.end()) {
        ASSERT_EQ(read(), static_cast<std::size_t>(end - c.ends.begin()) + 1) << length;
        continue;
      }
      const Fault fault = faultOf([&] { read(); });
      const auto frame = std::count_if(c.ends.begin(), c.ends.end(), [&](std::size_t e) { return e < length; });
      ASSERT_EQ(fault.code, FaultCode::kBadInput) << length;
      ASSERT_NE((fault.file + " " + fault.place).find("frame " + std::to_string(frame)), std::string::npos)
          << length << " " << fault.file << ": " << fault.place << ": " << fault.what;
    }
  }
}

TEST(FrameStreamStiff, BrokenStreamsAreNamed) {
  expectFault(faultOfStream(""), {"standard input", "frame 0", "the stream is empty"});
  expectFault(faultOfStream(nrrds(3).substr(0, nrrds(3).size() - 5)),
              {"frame 2", "ends after 43 of the frame's 48 bytes"});
  expectFault(faultOfStream(std::string(61, 'x'), rawOptions()), {"frame 1", "13 of the frame's 48 bytes"});
  expectFault(faultOfStream(nrrds(2) + "\n"), {"standard input frame 2", "line 1", "NRRD0001"});
  expectFault(faultOfStream("P6 100 100"), {"standard input frame 0", "NRRD0001"});
  expectFault(faultOfStream(smallFile("time:=1\n") + smallFile("time:=1\n")), {"frame 1", "does not come after"});
  expectFault(faultOfStream(smallFile("time:=1\n") + smallFile()), {"frame 1", "tells no time"});
  expectFault(faultOfStream(smallFile() + smallFile("time:=1\n")), {"frame 1", "tells its time"});
  expectFault(faultOfStream(smallFile() + smallFile("spacings: 1 1 2\n")), {"frame 1", "frame 0", "spacing"});
  expectFault(faultOfStream(smallHeader() + "data file: a.raw\n\n"), {"frame 0", "follow their header"});
  expectFault(faultOfStream(smallHeader() + "byte skip: 2\n\n"), {"frame 0", "nothing is skipped"});
  expectFault(faultOfStream(smallHeader() + "line skip: 2\n\n"), {"frame 0", "nothing is skipped"});
  std::string many = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 1 1 1 9999999\nencoding: raw\n\n";
  expectFault(faultOfStream(many + "x"), {"frame 0", "9999999 frames", "by its name"});
  FrameSourceOptions options = rawOptions();
  options.file.raw->skip = 10;
  expectFault(faultOfStream("1234", options), {"after 4 of the 10 bytes to skip"});
  std::string gzip = gzipNrrd(0);
  gzip[gzip.size() - 6] = static_cast<char>(gzip[gzip.size() - 6] ^ 1);
  expectFault(faultOfStream(gzip + gzipNrrd(0)), {"frame 0, byte ", "incorrect data check"});
}

TEST(FrameStream, ViewsOfStreams) {
  FrameViewOptions view;
  view.frames = {1, 5};
  view.frame_step = 2;
  view.crop = {{{1, 1}, {0, 2}, {0, 1}}};
  view.stride = {1, 2, 1};
  const Pipe pipe(nrrds(7, true), 77);
  const auto source = viewFrames(openFrameStream(pipe.end(), "p", {}), view);
  EXPECT_TRUE(source->isStream());
  EXPECT_EQ(source->grid().dims, (std::array<std::uint64_t, 3>{1, 2, 2}));
  std::size_t k = 0;
  for (; source->hasFrame(k); ++k) {
    const auto samples = frameOf(*source, k);
    std::vector<float> values(4);
    std::copy_n(samples.data(), samples.size(), reinterpret_cast<std::byte*>(values.data()));
    const auto first = static_cast<float>(100 * (1 + 2 * k));
    EXPECT_EQ(values, (std::vector<float>{first + 1, first + 5, first + 7, first + 11}));
    EXPECT_EQ(source->frameName(k), "p frame " + std::to_string(1 + 2 * k));
  }
  EXPECT_EQ(k, 3u);
  EXPECT_EQ(source->times(), (std::vector<double>{11, 19, 35}));
  const Pipe shorter(nrrds(4), 77);
  const auto cut = viewFrames(openFrameStream(shorter.end(), "p", {}), view);
  EXPECT_TRUE(cut->hasFrame(1));
  expectFault(faultOf([&] { cut->hasFrame(2); }), {"--frames", "1:5", "0:3"});
  view.frames = {9, 12};
  const Pipe late(nrrds(4), 77);
  expectFault(faultOf([&] { viewFrames(openFrameStream(late.end(), "p", {}), view); }), {"--frames", "9:12", "3"});
}

}  // namespace
}  // namespace tet4d::exchange
