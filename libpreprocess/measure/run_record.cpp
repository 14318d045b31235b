#include "libpreprocess/measure/run_record.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "libpreprocess/error.h"

namespace tet4d::measure {
namespace {

using nlohmann::json;

template <class T>
T field(const json& object, const char* name) {
  if (!object.contains(name)) throw json::other_error::create(501, std::string(name) + " is missing", &object);
  return object.at(name).get<T>();
}

template <class T>
T fieldOr(const json& object, const char* name, T otherwise) {
  return object.contains(name) && !object.at(name).is_null() ? object.at(name).get<T>() : otherwise;
}

RunRecord recordOf(const json& all) {
  RunRecord record;
  record.program = field<std::string>(all, "program");
  record.version = fieldOr<std::string>(all, "version", "");
  record.counts = field<std::map<std::string, std::uint64_t>>(all, "counts");
  record.seconds_wall = field<double>(all, "seconds_wall");
  record.seconds_cpu = field<double>(all, "seconds_cpu");
  record.peak_bytes = field<std::uint64_t>(all, "peak_bytes");
  record.anonymous_bytes = fieldOr<std::uint64_t>(all, "anonymous_bytes", 0);
  record.threads = fieldOr<std::uint64_t>(all, "threads", 0);
  for (const json& phase : field<json>(all, "phases")) {
    record.phases.push_back(
        {field<std::string>(phase, "name"), field<double>(phase, "seconds_wall"), field<double>(phase, "seconds_cpu")});
  }
  // An error that is no number (null) was not measured.
  const auto errors = fieldOr<json>(all, "error", json::object());  // outlives the loop over its items
  for (const auto& [name, value] : errors.items()) {
    if (value.is_number()) record.errors[name] = value.get<double>();
  }
  for (const json& frame : fieldOr<json>(all, "frames", json::array())) {
    record.frames.push_back({field<double>(frame, "time"), field<double>(frame, "ms"),
                             field<std::uint64_t>(frame, "drawn"), field<std::uint64_t>(frame, "processed"),
                             fieldOr<std::uint64_t>(frame, "bytes_touched", 0)});
  }
  return record;
}

}  // namespace

std::uint64_t RunRecord::count(const std::string& name) const {
  const auto found = counts.find(name);
  return found == counts.end() ? 0 : found->second;
}

double RunRecord::phaseSeconds(const std::string& name) const {
  for (const Phase& phase : phases) {
    if (phase.name == name) return phase.seconds_wall;
  }
  return 0;
}

RunRecord readRunRecord(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file) throw Error(FaultCode::kIo, path, "", "cannot be read", "give a file that --stats wrote");
  try {
    return recordOf(json::parse(text));
  } catch (const json::exception& error) {
    throw Error(FaultCode::kBadInput, path, "", std::string("is no record of a run: ") + error.what(),
                "give a file that --stats wrote");
  }
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const double rank = std::ceil(std::clamp(share, 0.0, 1.0) * static_cast<double>(values.size())) - 1;
  const auto at = static_cast<std::ptrdiff_t>(std::max(0.0, rank));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

}  // namespace tet4d::measure
