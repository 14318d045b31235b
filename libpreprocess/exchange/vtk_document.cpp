#include "libpreprocess/exchange/vtk_document.h"

#include <expat.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>
#include <type_traits>

#include "libpreprocess/error.h"
#include "libpreprocess/exchange/header_text.h"

namespace tet4d::exchange {
namespace {

constexpr const char* kNoVtkFile = "give a VTK XML file (.vti, .vtu, .pvd)";

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::string lineText(std::uint64_t line) { return "line " + std::to_string(line); }

// One run of expat over a file. Its handlers are C and must not throw: they note a fault and stop the parser.
class Parser {
 public:
  Parser(const InputFile& file, VtkDocument& document)
      : file_(file), document_(document), parser_(XML_ParserCreate("UTF-8"), &XML_ParserFree) {
    if (!parser_) {
      throw Error(FaultCode::kOutOfMemory, file.path(), "", "no memory for the XML parser", "close other programs");
    }
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), &Parser::onStart, &Parser::onEnd);
    XML_SetCharacterDataHandler(parser_.get(), &Parser::onText);
    XML_SetStartDoctypeDeclHandler(parser_.get(), &Parser::onDoctype);
  }

  void run() {
    std::vector<char> buffer(std::size_t{1} << 16);
    for (std::uint64_t at = 0;;) {
      const std::size_t got = file_.readSome(at, std::as_writable_bytes(std::span(buffer)));
      at += got;
      const bool is_last = got < buffer.size();
      const auto status = XML_Parse(parser_.get(), buffer.data(), static_cast<int>(got), is_last ? 1 : 0);
      if (stopped_) break;
      if (status == XML_STATUS_ERROR) failSyntax();
      // Text comes in pieces, so what expat holds back is one tag, comment or instruction.
      const auto done = static_cast<std::uint64_t>(std::max<XML_Index>(XML_GetCurrentByteIndex(parser_.get()), 0));
      if (at - std::min(done, at) > kMaxXmlTokenBytes) {
        failLine(line(), "a tag or comment is longer than " + std::to_string(kMaxXmlTokenBytes) + " bytes", kNoVtkFile);
      }
      if (is_last) return;
    }
    if (!fault_.empty()) failLine(line(), fault_, remedy_);
  }

 private:
  static void XMLCALL onStart(void* self, const XML_Char* name, const XML_Char** attributes) {
    static_cast<Parser*>(self)->guarded([&](Parser& parser) { parser.start(name, attributes); });
  }
  static void XMLCALL onEnd(void* self, const XML_Char* /*name*/) {
    static_cast<Parser*>(self)->guarded([](Parser& parser) { parser.open_.pop_back(); });
  }
  static void XMLCALL onText(void* self, const XML_Char* text, int length) {
    static_cast<Parser*>(self)->guarded([&](Parser& parser) { parser.text({text, static_cast<std::size_t>(length)}); });
  }
  static void XMLCALL onDoctype(void* self, const XML_Char* /*name*/, const XML_Char* /*system_id*/,
                                const XML_Char* /*public_id*/, int /*has_subset*/) {
    static_cast<Parser*>(self)->guarded([](Parser& parser) {
      parser.stop("a document type is declared, which VTK files do not have", "remove the DOCTYPE");
    });
  }

  // Runs a handler's body unless the parser is stopped already; no memory is a fault like others.
  template <class Body>
  void guarded(Body body) noexcept {
    if (stopped_) return;
    try {
      body(*this);
    } catch (const std::exception&) {
      stopped_ = true;
      fault_ = "no memory", remedy_ = "close others";  // both fit into the strings themselves
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }

  std::uint64_t line() const { return XML_GetCurrentLineNumber(parser_.get()); }
  std::uint64_t position() const { return static_cast<std::uint64_t>(XML_GetCurrentByteIndex(parser_.get())); }

  void stop(std::string what, std::string remedy) {
    stopped_ = true;
    fault_ = std::move(what), remedy_ = std::move(remedy);
    XML_StopParser(parser_.get(), XML_FALSE);
  }

  [[noreturn]] void failLine(std::uint64_t at, const std::string& what, const std::string& remedy) const {
    throw Error(FaultCode::kBadInput, file_.path(), lineText(at), what, remedy);
  }
  [[noreturn]] void failSyntax() const {
    const XML_Error code = XML_GetErrorCode(parser_.get());
    failLine(line(), std::string("is no well-formed XML: ") + XML_ErrorString(code),
             code == XML_ERROR_NO_ELEMENTS || elements_ == 0 ? kNoVtkFile : "copy or make the file again");
  }

  void start(const XML_Char* name, const XML_Char** attributes) {
    XmlElement element;
    element.name = name;
    element.line = line();
    for (; attributes[0] != nullptr; attributes += 2) {
      element.attributes.emplace_back(attributes[0], attributes[1]);
      attribute_bytes_ += std::strlen(attributes[0]) + std::strlen(attributes[1]);
    }
    if (elements_ == 0 && element.name != "VTKFile") {
      stop("expected <VTKFile>, found <" + element.name.substr(0, 60) + ">", kNoVtkFile);
      return;
    }
    if (++elements_ > kMaxXmlElements || attribute_bytes_ > kMaxXmlAttributeBytes) {
      stop("more than " + std::to_string(kMaxXmlElements) + " elements, or attributes of " +
               std::to_string(kMaxXmlAttributeBytes) + " bytes",
           "merge the file's pieces");
      return;
    }
    if (open_.size() >= kMaxXmlDepth) {
      stop("elements are nested deeper than " + std::to_string(kMaxXmlDepth), kNoVtkFile);
      return;
    }
    XmlElement* added = &document_.root;
    if (open_.empty()) {
      document_.root = std::move(element);
    } else {
      added = &open_.back()->children.emplace_back(std::move(element));
    }
    open_.push_back(added);
    if (open_.size() == 2 && added->name == "AppendedData") beginAppended(*added);
  }

  // The rest of the file is data: the parser ends here.
  void beginAppended(const XmlElement& element) {
    document_.appended.emplace();
    document_.appended->begin =
        position() + static_cast<std::uint64_t>(std::max(XML_GetCurrentByteCount(parser_.get()), 0));
    const std::string* encoding = element.attribute("encoding");
    document_.appended->base64 = encoding != nullptr && *encoding == "base64";
    if (encoding != nullptr && *encoding != "base64" && *encoding != "raw") {
      stop("appended data are encoded as " + inQuotes(*encoding) + ", expected raw or base64", "write the file again");
      return;
    }
    stop({}, {});
  }

  // A piece of the text of the innermost element. Only arrays are asked for theirs; it must be one run of bytes.
  void text(std::string_view piece) {
    const std::uint64_t begin = position();
    const auto in_file = static_cast<std::uint64_t>(std::max(XML_GetCurrentByteCount(parser_.get()), 0));
    const bool joins = begin == text_reach_;
    const bool is_blank = std::all_of(piece.begin(), piece.end(), isBlank);
    if (joins || !is_blank) text_reach_ = begin + in_file;
    if (open_.empty() || open_.back()->name != "DataArray") return;
    const bool is_line_end = piece == "\n" && in_file <= 2;
    if (in_file != piece.size() && !is_line_end) {
      stop("the text of a <DataArray> holds a character by its number or name", "write the character itself");
    }
    if (is_blank) return;
    XmlElement& element = *open_.back();
    const auto first = std::find_if_not(piece.begin(), piece.end(), isBlank) - piece.begin();
    const auto last = std::find_if_not(piece.rbegin(), piece.rend(), isBlank).base() - piece.begin();
    if (element.text_end != 0 && !joins) {
      stop("the text of a <DataArray> is divided by another element, a comment or a section", "write it in one piece");
    }
    if (element.text_end == 0) element.text_begin = begin + static_cast<std::uint64_t>(first);
    element.text_end = begin + static_cast<std::uint64_t>(last);
  }

  const InputFile& file_;
  VtkDocument& document_;
  std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser_;
  std::vector<XmlElement*> open_;  // from the root to the innermost; children are added to the last one only
  std::size_t elements_ = 0;
  std::uint64_t attribute_bytes_ = 0;
  std::uint64_t text_reach_ = 0;  // how far the text read last goes on without a break
  bool stopped_ = false;
  std::string fault_, remedy_;
};

// Where appended data begin: behind blanks and an underscore.
std::uint64_t appendedBegin(const InputFile& file, std::uint64_t at) {
  std::array<char, 4096> window;
  const std::size_t got = file.readSome(at, std::as_writable_bytes(std::span(window)));
  const auto* const end = window.data() + got;
  const auto* const mark = std::find_if_not(static_cast<const char*>(window.data()), end, isBlank);
  const std::uint64_t place = at + static_cast<std::uint64_t>(mark - window.data());
  if (mark == end || *mark != '_') {
    throw Error(FaultCode::kBadInput, file.path(), "byte " + std::to_string(place),
                "expected the underscore before the appended data", "copy or make the file again");
  }
  return place + 1;
}

bool isWide(const VtkDocument& document) {
  const std::string* type = document.root.attribute("header_type");
  if (type == nullptr || *type == "UInt32") return false;
  if (*type == "UInt64") return true;
  document.fail(document.root, "header_type is " + inQuotes(*type) + ", expected UInt32 or UInt64",
                "write the file again");
}

bool isBigEndian(const VtkDocument& document) {
  const std::string* order = document.root.attribute("byte_order");
  if (order == nullptr || *order == "LittleEndian") return false;
  if (*order == "BigEndian") return true;
  document.fail(document.root, "byte_order is " + inQuotes(*order) + ", expected LittleEndian or BigEndian",
                "write the file again");
}

}  // namespace

const std::string* XmlElement::attribute(std::string_view attribute_name) const {
  for (const auto& [key, value] : attributes) {
    if (key == attribute_name) return &value;
  }
  return nullptr;
}

const XmlElement* XmlElement::child(std::string_view child_name) const {
  const auto it =
      std::find_if(children.begin(), children.end(), [&](const XmlElement& c) { return c.name == child_name; });
  return it == children.end() ? nullptr : &*it;
}

void VtkDocument::fail(const XmlElement& element, const std::string& what, const std::string& remedy) const {
  const std::string* name = element.attribute("Name");
  throw Error(FaultCode::kBadInput, path,
              lineText(element.line) + ", <" + element.name.substr(0, 60) + ">" +
                  (name != nullptr ? " " + inQuotes(*name) : std::string()),
              what, remedy);
}

const XmlElement& VtkDocument::dataset() const {
  if (const XmlElement* element = root.child(type)) return *element;
  fail(root, "the file is of type " + inQuotes(type) + ", but has no such element", "copy or make the file again");
}

const std::string& VtkDocument::need(const XmlElement& element, std::string_view attribute) const {
  if (const std::string* value = element.attribute(attribute)) return *value;
  fail(element, "the attribute " + std::string(attribute) + " is missing", "write the file again");
}

std::uint64_t VtkDocument::needCount(const XmlElement& element, std::string_view attribute) const {
  const std::string& text = need(element, attribute);
  if (const auto count = countOf(text)) return *count;
  fail(element, std::string(attribute) + " is " + inQuotes(text) + ", expected a whole number from 0 on",
       "write the file again");
}

std::vector<double> VtkDocument::numbers(const XmlElement& element, std::string_view attribute, std::size_t count,
                                         std::vector<double> defaults) const {
  const std::string* text = element.attribute(attribute);
  if (text == nullptr) return defaults;
  std::vector<double> values;
  for (const std::string& word : wordsOf(*text)) {
    const auto value = numberOf(word);
    if (!value || !std::isfinite(*value)) break;
    values.push_back(*value);
  }
  if (values.size() == count && wordsOf(*text).size() == count) return values;
  fail(element,
       std::string(attribute) + " is " + inQuotes(*text) + ", expected " + std::to_string(count) + " finite numbers",
       "write the file again");
}

VtkDocument readVtkDocument(const InputFile& file) {
  VtkDocument document;
  document.path = file.path();
  document.file_bytes = file.size();
  Parser(file, document).run();
  document.type = document.need(document.root, "type");
  document.big_endian = isBigEndian(document);
  document.wide_headers = isWide(document);
  if (const std::string* compressor = document.root.attribute("compressor")) document.compressor = *compressor;
  if (document.appended) document.appended->begin = appendedBegin(file, document.appended->begin);
  return document;
}

}  // namespace tet4d::exchange
