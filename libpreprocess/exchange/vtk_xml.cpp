#include "libpreprocess/exchange/vtk_xml.h"

#include "libpreprocess/exchange/number_text.h"

namespace tet4d::exchange {

VtkHeader::VtkHeader(std::string_view type) : type_(type) {
  text_ = "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type_ +
          "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <" + type_ + ">\n";
}

void VtkHeader::array(std::string_view type, std::string_view name, unsigned components, std::uint64_t bytes) {
  text_ += "        <DataArray type=\"" + std::string(type) + "\" Name=\"" + xmlText(name) +
           "\" NumberOfComponents=\"" + std::to_string(components) + "\" format=\"appended\" offset=\"" +
           std::to_string(offset_) + "\"/>\n";
  offset_ += sizeof(std::uint64_t) + bytes;
}

void VtkHeader::timeValue(double time) {
  text_ +=
      "    <FieldData>\n      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">" +
      numberText(time) + "</DataArray>\n    </FieldData>\n";
}

std::string VtkHeader::finish() const { return text_ + "  </" + type_ + ">\n  <AppendedData encoding=\"raw\">\n   _"; }

std::string xmlText(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

}  // namespace tet4d::exchange
