// Where the pages of a hypermesh go while they are made.
#pragma once

#include <cstdint>
#include <span>

#include "formats/hypermesh.h"
#include "libpreprocess/error.h"

namespace tet4d::hypermesh {

// One page: what Writer::addPage() takes.
struct Page {
  std::span<const Vec4f> vertices;
  std::span<const Run> runs;
  std::span<const Tet> tets;
  Bounds4f bounds;
  std::span<const std::span<const float>> columns;
  std::uint64_t part = 0;
};

class PageSink {
 public:
  virtual ~PageSink() = default;
  virtual void add(const Page& page) = 0;
  // What only the data can tell: flags of the header, and a stream's times and last frame.
  virtual void addFlags(std::uint32_t flags) = 0;
  virtual void setTimes(std::span<const double> times, float last_t) = 0;
};

// Pages into a file. Throws the writer's faults.
class FileSink final : public PageSink {
 public:
  explicit FileSink(Writer& writer) : writer_(writer) {}
  void add(const Page& page) override {
    unwrap(writer_.addPage(page.vertices, page.runs, page.tets, page.bounds, page.columns, page.part));
  }
  void addFlags(std::uint32_t flags) override { writer_.addFlags(flags); }
  void setTimes(std::span<const double> times, float last_t) override { unwrap(writer_.setTimes(times, last_t)); }

 private:
  Writer& writer_;
};

}  // namespace tet4d::hypermesh
