#include "player/host/output_names.h"

#include <sys/stat.h>

#include <filesystem>
#include <map>

#include "player/host/output_file.h"

namespace tet4d::host {
namespace {

// What two names have in common if they mean one file: its device and inode, or, before it exists, its whole path.
std::string identityOf(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0) return std::to_string(info.st_dev) + ":" + std::to_string(info.st_ino);
  std::error_code error;
  const std::filesystem::path whole = std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error);
  return error ? path : whole.string();
}

}  // namespace

Status checkNamesDiffer(const std::vector<NamedPath>& inputs, const std::vector<NamedPath>& outputs) {
  std::map<std::string, const NamedPath*> taken;
  for (const NamedPath& input : inputs) {
    if (!input.path.empty() && !isStream(input.path)) taken.emplace(identityOf(input.path), &input);
  }
  for (const NamedPath& output : outputs) {
    if (output.path.empty() || isStream(output.path)) continue;
    const auto [other, is_new] = taken.emplace(identityOf(output.path), &output);
    if (is_new) continue;
    return Fault{FaultCode::kUsage, output.path, output.role, "is the same file as " + other->second->role,
                 "give " + output.role + " another name"};
  }
  return {};
}

}  // namespace tet4d::host
