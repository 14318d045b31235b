// One <DataArray> of a VTK XML file as numbers: any format (ascii, binary, appended), encoding (raw, base64) and byte
// order, uncompressed or with vtkZLibDataCompressor.
//
// Values are read from any place into the caller's buffer. Raw data are read where they stand; base64, text and
// compressed blocks are decoded from front to back through a fixed buffer, so that values read in growing order cost
// one pass and a step back a new start (compressed raw data: of a block). Of a compressed array the table of its blocks
// is held, 8 bytes a block.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/core/sample_type.h"
#include "libpreprocess/exchange/input_file.h"
#include "libpreprocess/exchange/vtk_document.h"

namespace tet4d::exchange {

class VtkArray {
 public:
  virtual ~VtkArray() = default;
  SampleType type() const { return type_; }
  std::uint64_t components() const { return components_; }
  std::uint64_t values() const { return values_; }  // tuples * components
  // Reads values [first, first + samples / sampleBytes(type())), native byte order. They must be there. Throws
  // Error{kBadInput} naming the array and the byte: data that end early, are broken, or no numbers.
  virtual void read(std::uint64_t first, std::span<std::byte> samples) = 0;
  // The same as doubles (64-bit integers rounded), and as whole numbers; a negative or fractional one is an error.
  void readNumbers(std::uint64_t first, std::span<double> numbers);
  void readCounts(std::uint64_t first, std::span<std::uint64_t> counts);

 protected:
  friend std::unique_ptr<VtkArray> openVtkArray(const VtkDocument& document, const XmlElement& array,
                                                std::shared_ptr<const InputFile> file, std::uint64_t tuples);
  SampleType type_ = SampleType::kF32;
  std::uint64_t components_ = 1, values_ = 0;
  [[noreturn]] void fail(const std::string& place, const std::string& what) const;
  std::string path_, name_;

 private:
  template <class Visit>
  void forEachPart(std::uint64_t first, std::uint64_t count, Visit visit);
  std::vector<std::byte> buffer_;
};

// The type of a DataArray's values; nothing for strings, bits and others. Its components (1 if it does not say).
std::optional<SampleType> vtkTypeOf(const XmlElement& array);
std::uint64_t vtkComponentsOf(const VtkDocument& document, const XmlElement& array);

// Opens an array of `tuples` tuples. Proves before anything is allocated: the type, the sizes' product, the format, the
// offset, the size before the data or the table of blocks, all against the file. Throws Error{kBadInput} naming the
// element; compressors other than zlib are refused by name.
std::unique_ptr<VtkArray> openVtkArray(const VtkDocument& document, const XmlElement& array,
                                       std::shared_ptr<const InputFile> file, std::uint64_t tuples);

}  // namespace tet4d::exchange
