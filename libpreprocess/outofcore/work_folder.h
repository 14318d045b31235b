// A folder for the temporary files of a run that may be interrupted, with a journal of what is finished.
//
// The journal's first line names the run; a run with the same name goes on where the last one stopped. Lines are
// written when what they tell of is complete, so that after an interrupt, or a kill at any moment, what the journal
// lists is whole. (Not after a power failure: nothing is forced to the disk.)
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tet4d::outofcore {

class WorkFolder {
 public:
  // name: one line that tells this run from others, e.g. a digest of inputs and options. resume: take over what an
  // interrupted run of that name left; otherwise what such a run left is removed first. Throws Error{kUsage} if a run
  // of another name is to be resumed, Error{kIo} if another process works in the folder, or if `path` is there and is
  // no such folder.
  WorkFolder(std::string path, std::string_view name, bool resume);
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  // Removes the folder with all in it, unless keep() was called.
  ~WorkFolder();

  std::string file(std::string_view name) const { return path_ + "/" + std::string(name); }
  const std::string& path() const { return path_; }
  bool isResumed() const { return resumed_; }
  bool isDone(std::string_view line) const;
  // Appends a line. Thread-safe.
  void record(std::string_view line);
  // Leaves the folder for a later run.
  void keep() { kept_ = true; }

 private:
  void open(std::string_view name, bool resume);

  std::string path_;
  int journal_ = -1;
  bool kept_ = false, resumed_ = false;
  std::vector<std::string> lines_;  // of the run that is resumed
};

}  // namespace tet4d::outofcore
