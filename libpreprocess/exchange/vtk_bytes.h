// The bytes of a VTK array in the file, decoded from base64 where they are: what vtk_array.cpp stands on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libpreprocess/exchange/input_file.h"

namespace tet4d::exchange {

class VtkBytes {
 public:
  virtual ~VtkBytes() = default;
  // Reads the bytes [offset, offset + bytes.size()) of the decoded data; fewer are Error{kBadInput} naming the byte of
  // the file.
  virtual void read(std::uint64_t offset, std::span<std::byte> bytes) = 0;
  // What there can be at most: a bound against forged sizes, exact for raw data and text without blanks.
  virtual std::uint64_t most() const = 0;
  // The data that begin at `offset`, where a writer may have begun a new base64 text because the bytes before end with
  // padding there.
  virtual std::unique_ptr<VtkBytes> from(std::uint64_t offset) = 0;
};

// Raw bytes [begin, end) of the file.
std::unique_ptr<VtkBytes> rawBytes(std::shared_ptr<const InputFile> file, std::uint64_t begin, std::uint64_t end);

// The base64 text [begin, end) of the file, blanks left out; it ends before `end` at '<'. Read from front to back.
std::unique_ptr<VtkBytes> base64Bytes(std::shared_ptr<const InputFile> file, std::uint64_t begin, std::uint64_t end);

}  // namespace tet4d::exchange
