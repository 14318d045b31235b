#include "player/host/film.h"

#include <cctype>
#include <utility>

#include "player/host/output_file.h"
#include "player/host/png.h"

namespace tet4d::host {
namespace {

Fault badPattern(const std::string& pattern) {
  return {FaultCode::kUsage, pattern, "",
          "is no pattern for numbered frames: expected one %d or %0Nd (and %% for a percent sign)",
          "give -o frames/%05d.png"};
}

// A pattern taken apart around its number.
struct Pattern {
  std::string before, after;
  std::size_t digits = 0;
  bool has_number = false;
  bool valid = true;
};

Pattern parsePattern(const std::string& text) {
  Pattern pattern;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string& part = pattern.has_number ? pattern.after : pattern.before;
    if (text[i] != '%') {
      part += text[i];
      continue;
    }
    if (i + 1 < text.size() && text[i + 1] == '%') {
      part += '%';
      ++i;
      continue;
    }
    std::size_t end = i + 1;
    const bool zero_padded = end < text.size() && text[end] == '0';
    while (end < text.size() && end < i + 4 && std::isdigit(static_cast<unsigned char>(text[end])) != 0) ++end;
    const bool has_width = end > i + 1;
    if (pattern.has_number || end >= text.size() || text[end] != 'd' || has_width != zero_padded) {
      pattern.valid = false;
      return pattern;
    }
    pattern.has_number = true;
    if (has_width) pattern.digits = std::stoul(text.substr(i + 1, end - i - 1));
    i = end;
  }
  return pattern;
}

class PngFrames final : public FrameSink {
 public:
  PngFrames(std::string pattern, bool force) : pattern_(std::move(pattern)), force_(force) {}

  Status add(const render::Image& image) override {
    const auto name = frameName(pattern_, number_);
    if (!name.ok()) return name.fault();
    const auto bytes = encodePng(image, name.value());
    if (!bytes.ok()) return bytes.fault();
    ++number_;
    return writeFile(name.value(), bytes.value(), force_);
  }
  Status finish() override { return {}; }

 private:
  std::string pattern_;
  bool force_;
  std::size_t number_ = 0;
};

}  // namespace

bool hasNumber(const std::string& pattern) { return parsePattern(pattern).has_number; }

Result<std::string> frameName(const std::string& pattern, std::size_t number) {
  const Pattern parts = parsePattern(pattern);
  if (!parts.valid) return badPattern(pattern);
  if (!parts.has_number) return parts.before;
  std::string digits = std::to_string(number);
  if (digits.size() < parts.digits) digits.insert(0, parts.digits - digits.size(), '0');
  return parts.before + digits + parts.after;
}

Result<std::unique_ptr<FrameSink>> makePngFrames(const std::string& pattern, std::size_t frames, bool force) {
  const Pattern parts = parsePattern(pattern);
  if (!parts.valid || (frames > 1 && !parts.has_number)) return badPattern(pattern);
  for (std::size_t i = 0; i < frames; ++i) {
    const auto name = frameName(pattern, i);
    if (!name.ok()) return name.fault();
    if (Status status = checkMayWrite(name.value(), force); !status.ok()) return status.fault();
  }
  return std::unique_ptr<FrameSink>(std::make_unique<PngFrames>(pattern, force));
}

}  // namespace tet4d::host
