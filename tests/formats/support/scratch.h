// Files for tests: a folder that goes away, whole-file reads and writes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace tet4d::test {

// A folder of its own, removed with all it holds.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  // Names of everything in the folder.
  std::vector<std::string> names() const;

 private:
  std::filesystem::path folder_;
};

// Both abort the test program when the system refuses.
std::vector<std::byte> readBytes(const std::string& path);
void writeBytes(const std::string& path, std::span<const std::byte> bytes);

}  // namespace tet4d::test
