// The one exception of libpreprocess. It carries the same fields as formats' Fault; adapters translate both ways.
#pragma once

#include <exception>
#include <string>
#include <utility>

#include "formats/core/result.h"

namespace tet4d {

class Error : public std::exception {
 public:
  explicit Error(Fault fault) : fault_(std::move(fault)) {}
  Error(FaultCode code, std::string file, std::string place, std::string what, std::string remedy = {})
      : fault_{code, std::move(file), std::move(place), std::move(what), std::move(remedy)} {}
  const Fault& fault() const noexcept { return fault_; }
  const char* what() const noexcept override { return fault_.what.c_str(); }

 private:
  Fault fault_;
};

// Unwraps a Result of formats/, throwing its Fault as an Error.
template <class T>
T unwrap(Result<T> result) {
  if (!result.ok()) throw Error(result.fault());
  return std::move(result).value();
}
inline void unwrap(const Status& status) {
  if (!status.ok()) throw Error(status.fault());
}

}  // namespace tet4d
