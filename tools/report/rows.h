// The rows of a report: one a run, flat, kept as JSON lines and as CSV.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/report/child.h"

namespace tet4d::report {

using Row = nlohmann::ordered_json;  // an object of numbers, texts and truths

// Where and with what the rows were measured; stands in each.
struct Context {
  std::string commit, machine;
};
// commit: as given; else what git says of the folder of the programs; else "unknown".
Context contextOf(const std::string& commit, const std::string& bin, const Programs& programs);

// The fields that every row begins with: which sweep, input and its digest, program and arguments.
Row beginRow(const std::string& sweep, const std::string& input, const std::string& digest, const std::string& program,
             const std::vector<std::string>& arguments);
// Seconds, memory, threads, exit and fault of a run, and the load of the machine.
void addRun(Row& row, const ChildRun& run);

// The machine's load of the last minute.
double loadAverage();

// A number, or null where it is not finite: JSON has no others.
nlohmann::ordered_json number(double value);

class Rows {
 public:
  // resume: rows of an earlier report in `folder` that have the same sweep, input, digest, arguments and commit, and
  // did not fail, are taken by take(). Without it runs.jsonl begins anew.
  Rows(std::string folder, Context context, bool resume);

  // Takes over the earlier row of the run that begins with these fields; false if there is none.
  bool take(const Row& begun);
  // Adds what Context knows, and appends to runs.jsonl at once. An earlier row leaves that file in finish() at the
  // soonest: a sweep that is stopped, however that happens, loses none of either.
  void add(Row row);
  // runs.jsonl with the rows of this sweep in its order, then the earlier ones of this commit that it had no use for;
  // replaced in one step. runs.csv: the rows of this sweep, a column for every field, in order of first appearance.
  void finish() const;
  const std::vector<Row>& all() const { return rows_; }
  const Context& context() const { return context_; }

 private:
  bool counts(const Row& row) const;  // an earlier row
  void writeLines() const;
  void writeCsv() const;

  std::string folder_;
  Context context_;
  std::vector<Row> rows_, earlier_;
};

}  // namespace tet4d::report
