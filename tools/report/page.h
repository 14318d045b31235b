// The report as one HTML page: everything inline, nothing from a network.
#pragma once

#include <string>
#include <vector>

#include "tools/report/plot.h"
#include "tools/report/rows.h"

namespace tet4d::report {

struct Section {
  std::string heading, text;  // text: what is measured, and how to read it
  std::vector<Plot> plots;
  std::vector<std::string> columns;  // of the table, among the fields of rows; a field of no row is left out
  std::string sweep;                 // of the rows it shows
};

// Writes plots (SVG, and PNG where the build can), runs.csv and index.html into `folder`, which has runs.jsonl. title
// heads the page. Rows that failed stand in a table of their own.
void writePage(const std::string& folder, const std::string& title, const std::vector<Section>& sections,
               const Rows& rows);

}  // namespace tet4d::report
