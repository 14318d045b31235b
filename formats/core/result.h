// Faults and results: how formats/ and player/ report what went wrong without throwing.
//
// libpreprocess wraps the same Fault in one exception (libpreprocess/error.h); tools/common maps codes to exit codes.
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace tet4d {

// What kind of fault. The programs' exit codes follow from it (see tools/common/exit_codes.h).
enum class FaultCode {
  kUsage,        // the caller's options make no sense together            exit 2
  kBadInput,     // a file's content is wrong or unsupported               exit 3
  kIo,           // the system refused to open, read, write or rename      exit 1
  kOutOfMemory,  // a budget or the machine's memory is used up            exit 4
  kNoSpace,      // disk or quota is full                                  exit 4
  kNotBuilt,     // this build lacks an optional part                      exit 1
  kInterrupted,  // SIGINT or SIGTERM                                      exit 1
};

// One fault, ready to print as `tool: file: place: what` and one line `remedy`.
struct Fault {
  FaultCode code = FaultCode::kBadInput;
  std::string file;    // path as the user gave it; may be empty
  std::string place;   // "section TETS", "frame 12", "byte 4096", …; may be empty
  std::string what;    // what is wrong, with the values found and expected
  std::string remedy;  // one line: what the user can do; may be empty
};

// A value or a Fault. `ok()` first, then `value()` or `fault()`.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Fault fault) : state_(std::in_place_index<1>, std::move(fault)) {}

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }
  T& value() & { return assert(ok()), std::get<0>(state_); }
  const T& value() const& { return assert(ok()), std::get<0>(state_); }
  T&& value() && { return assert(ok()), std::get<0>(std::move(state_)); }
  const Fault& fault() const { return assert(!ok()), std::get<1>(state_); }

 private:
  std::variant<T, Fault> state_;
};

// Success or a Fault.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Fault fault) : fault_(std::move(fault)) {}

  bool ok() const { return !fault_; }
  explicit operator bool() const { return ok(); }
  const Fault& fault() const { return assert(fault_), *fault_; }

 private:
  std::optional<Fault> fault_;
};

using Status = Result<void>;

}  // namespace tet4d
