#include "libpreprocess/exchange/frame_stream.h"

#include <cassert>
#include <optional>
#include <utility>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/frame_series.h"
#include "libpreprocess/exchange/gzip_stream.h"
#include "libpreprocess/exchange/nrrd_axes.h"
#include "libpreprocess/exchange/nrrd_header.h"
#include "libpreprocess/exchange/number_text.h"
#include "libpreprocess/exchange/read_raw.h"

namespace tet4d::exchange {
namespace {

// What streams have in common: which frame is at hand, how much of it is read, and the times.
class FrameStream : public FrameSource {
 public:
  FrameStream(int descriptor, std::string name, std::vector<double> given_times)
      : bytes_(descriptor, std::move(name)), given_times_(std::move(given_times)) {
    if (!given_times_.empty()) checkGivenTimes(given_times_, given_times_.size());
  }
  const GridInfo& grid() const override { return grid_; }
  const std::vector<double>& times() const override { return times_; }
  bool isStream() const override { return true; }
  std::string frameName(std::size_t k) const override { return bytes_.name() + " frame " + std::to_string(k); }

  bool hasFrame(std::size_t k) override {
    while (times_.size() <= k && !ended_) advance();
    return k < times_.size();
  }

  void readLayers(std::size_t k, std::uint64_t z_begin, std::uint64_t z_end, std::span<std::byte> samples) override {
    const std::uint64_t begin = z_begin * grid_.layerBytes();
    if (!hasFrame(k) || k + 1 != times_.size() || begin < done_) {
      throw Error(FaultCode::kUsage, bytes_.name(), "frame " + std::to_string(k),
                  "a stream's frames are read once and in order; this one has gone by or does not come", "give files");
    }
    assert(samples.size() == z_end * grid_.layerBytes() - begin);
    pass(begin - done_);
    done_ = begin;
    take(samples);
    done_ = z_end * grid_.layerBytes();
    if (done_ == grid_.frameBytes()) finishFrame();
  }

 protected:
  // Whether there is another frame, whose header is then read; `time` is what it tells. The first sets `grid`, which
  // others must have.
  virtual bool nextHeader(GridInfo& grid, std::optional<double>& time) = 0;
  // The next bytes of the frame, or past them; fewer are an error.
  virtual void take(std::span<std::byte> samples) = 0;
  virtual void pass(std::uint64_t bytes) = 0;
  virtual void finishFrame() {}

  // For constructors: the first header, which must be there.
  void begin() {
    advance();
    if (ended_) failFrame(0, "the stream is empty", "check the program that writes it");
  }
  [[noreturn]] void failFrame(std::size_t k, const std::string& what, const std::string& remedy) const {
    throw Error(FaultCode::kBadInput, bytes_.name(), "frame " + std::to_string(k), what, remedy);
  }
  // Runs `decode`, a fault of which is one of the frame being read.
  template <class Decode>
  void inFrame(const Decode& decode) const {
    try {
      decode();
    } catch (const Error& error) {
      Fault fault = error.fault();
      fault.place = "frame " + std::to_string(times_.size() - 1) + ", " + fault.place;
      throw Error(std::move(fault));
    }
  }
  [[noreturn]] void failTruncated(std::uint64_t got) const {
    failFrame(times_.size() - 1,
              "the stream ends after " + std::to_string(done_ + got) + " of the frame's " +
                  std::to_string(grid_.frameBytes()) + " bytes",
              "check that the program that writes it has ended well, and the sizes");
  }
  ByteStream& bytes() { return bytes_; }

 private:
  // To the next frame or the end.
  void advance() {
    if (!times_.empty() && done_ < grid_.frameBytes()) {
      pass(grid_.frameBytes() - done_);
      finishFrame();
    }
    const std::size_t k = times_.size();
    GridInfo grid;
    std::optional<double> time;
    if (!nextHeader(grid, time)) {
      ended_ = true;
      if (k != 0 && !given_times_.empty()) checkGivenTimes(given_times_, k);
      return;
    }
    if (k == 0) {
      grid_ = grid;
    } else {
      checkSameGrid(frameName(0), grid_, frameName(k), grid);
    }
    if (k == kMaxFrames) failFrame(k, "more frames than can be told apart in float32", "divide the sequence");
    times_.push_back(timeOf(k, time));
    done_ = 0;
  }

  double timeOf(std::size_t k, std::optional<double> told) {
    if (!given_times_.empty()) {
      if (k < given_times_.size()) return given_times_[k];
      throw Error(FaultCode::kUsage, "", "frame times",
                  std::to_string(k) + " times are given, but " + bytes_.name() + " brings more frames",
                  "give one time a frame");
    }
    if (k == 0) times_are_told_ = told.has_value();
    if (told.has_value() != times_are_told_) {
      failFrame(k, told ? "tells its time, but the frames before do not" : "tells no time, but the frames before do",
                "add \"time:=T\" to all frames or to none");
    }
    if (!told) return static_cast<double>(k);
    if (k != 0 && !(*told > times_.back())) {
      failFrame(k,
                "its time " + numberText(*told) + " does not come after the time " + numberText(times_.back()) +
                    " of the frame before",
                "send the frames in time order");
    }
    return *told;
  }

  ByteStream bytes_;
  GridInfo grid_;
  std::vector<double> times_, given_times_;
  bool times_are_told_ = false, ended_ = false;
  std::uint64_t done_ = 0;  // bytes read of the last frame of times_
};

class RawStream final : public FrameStream {
 public:
  RawStream(int descriptor, const std::string& name, const FrameSourceOptions& options)
      : FrameStream(descriptor, name, options.times),
        layout_(*options.file.raw),
        raw_grid_(gridOfRaw(layout_, options.file.centering)),
        swap_(isOtherByteOrder(layout_.big_endian)) {
    const std::uint64_t skipped = bytes().skip(layout_.skip);
    if (skipped < layout_.skip) {
      failFrame(0,
                "the stream ends after " + std::to_string(skipped) + " of the " + std::to_string(layout_.skip) +
                    " bytes to skip",
                "correct --skip");
    }
    begin();
  }

 private:
  bool nextHeader(GridInfo& grid, std::optional<double>&) override {
    grid = raw_grid_;
    return !bytes().peek().empty();
  }
  void take(std::span<std::byte> samples) override {
    const std::size_t got = bytes().read(samples);
    if (got < samples.size()) failTruncated(got);
    if (swap_) swapSampleBytes(samples, sampleBytes(layout_.type));
  }
  void pass(std::uint64_t count) override {
    const std::uint64_t got = bytes().skip(count);
    if (got < count) failTruncated(got);
  }

  RawLayout layout_;
  GridInfo raw_grid_;
  bool swap_;
};

// More frames than this are not believed of one header, since nothing of a stream proves them.
constexpr std::uint64_t kMaxFramesOfHeader = std::uint64_t{1} << 20;

class NrrdStream final : public FrameStream {
 public:
  NrrdStream(int descriptor, const std::string& name, const FrameSourceOptions& options)
      : FrameStream(descriptor, name, options.times), centering_(options.file.centering) {
    begin();
  }

 private:
  bool nextHeader(GridInfo& grid, std::optional<double>& time) override {
    if (next_of_item_ == header_.frames) {
      if (bytes().peek().empty()) return false;
      readHeader();
    }
    grid = header_.grid;
    if (!header_.times.empty()) time = header_.times[static_cast<std::size_t>(next_of_item_)];
    ++next_of_item_;
    return true;
  }

  void readHeader() {
    const NrrdFields fields = readNrrdFields(bytes(), frameName(times().size()));
    header_ = nrrdHeaderOf(fields, centering_);
    const auto refuse = [&](const char* field, const std::string& what, const std::string& remedy) {
      fields.fail(fields.need(field), what, remedy);
    };
    if (!header_.data.attached) refuse("data file", "a stream's samples follow their header", "attach the data");
    if (header_.data.line_skip != 0) refuse("line skip", "nothing is skipped in a stream", "leave \"line skip\" out");
    if (header_.data.byte_skip != 0) refuse("byte skip", "nothing is skipped in a stream", "leave \"byte skip\" out");
    if (header_.frames > kMaxFramesOfHeader) {
      refuse("sizes",
             std::to_string(header_.frames) + " frames of one header, at most " + std::to_string(kMaxFramesOfHeader) +
                 " are read from a stream",
             "give the file by its name");
    }
    header_.times = readNrrdTimes(fields, readNrrdAxes(fields, centering_));
    next_of_item_ = 0;
    gzip_.reset();
    if (header_.data.packing != Packing::kNone) gzip_.emplace(bytes());
  }

  void take(std::span<std::byte> samples) override {
    if (gzip_) {
      inFrame([&] { gzip_->read(samples); });
    } else {
      const std::size_t got = bytes().read(samples);
      if (got < samples.size()) failTruncated(got);
    }
    if (header_.data.swap_bytes) swapSampleBytes(samples, sampleBytes(header_.grid.type));
  }
  void pass(std::uint64_t count) override {
    if (gzip_) {
      inFrame([&] { gzip_->skip(count); });
    } else if (const std::uint64_t got = bytes().skip(count); got < count) {
      failTruncated(got);
    }
  }
  void finishFrame() override {
    if (gzip_ && next_of_item_ == header_.frames) inFrame([&] { gzip_->finish(); });
  }

  Centering centering_;
  NrrdHeader header_ = nothing();  // of the NRRD at hand
  std::uint64_t next_of_item_ = 0;
  std::optional<GzipStream> gzip_;

  static NrrdHeader nothing() {
    NrrdHeader header;
    header.frames = 0;
    return header;
  }
};

}  // namespace

std::unique_ptr<FrameSource> openFrameStream(int descriptor, const std::string& name,
                                             const FrameSourceOptions& options) {
  if (options.file.raw) return std::make_unique<RawStream>(descriptor, name, options);
  return std::make_unique<NrrdStream>(descriptor, name, options);
}

}  // namespace tet4d::exchange
