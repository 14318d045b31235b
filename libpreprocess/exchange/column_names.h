// Names of columns as foreign formats can hold them: a name in a file may be any bytes.
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace tet4d::exchange {

// ASCII letters, digits and '_'; everything else becomes '_'.
inline std::string identifier(std::string_view name) {
  std::string text(name);
  for (char& c : text) {
    const bool keep = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!keep) c = '_';
  }
  return text;
}

// Printable ASCII; everything else becomes '_'.
inline std::string printableName(std::string_view name) {
  std::string text(name);
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '_';
  }
  return text;
}

// Makes names that collide (after replacement, or with a format's own) differ by underscores at the end.
class UniqueNames {
 public:
  std::string unique(std::string name) {
    while (!taken_.insert(name).second) name += '_';
    return name;
  }

 private:
  std::set<std::string> taken_;
};

}  // namespace tet4d::exchange
