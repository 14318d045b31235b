// The programs' exit codes.
#pragma once

#include "formats/core/result.h"

namespace tet4d::cli {

inline constexpr int kExitDone = 0;
inline constexpr int kExitFailure = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitBadInput = 3;
inline constexpr int kExitNoRoom = 4;  // memory, disk or quota
inline constexpr int kExitFaultsFound = 5;

constexpr int exitCode(FaultCode code) {
  switch (code) {
    case FaultCode::kUsage:
      return kExitUsage;
    case FaultCode::kBadInput:
      return kExitBadInput;
    case FaultCode::kOutOfMemory:
    case FaultCode::kNoSpace:
      return kExitNoRoom;
    case FaultCode::kIo:
    case FaultCode::kNotBuilt:
    case FaultCode::kInterrupted:
      return kExitFailure;
  }
  return kExitFailure;
}

}  // namespace tet4d::cli
