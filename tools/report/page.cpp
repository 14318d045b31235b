#include "tools/report/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libpreprocess/outofcore/output_file.h"
#include "tools/report/escape.h"

namespace tet4d::report {
namespace {

constexpr const char* kStyle =
    "body{font-family:sans-serif;max-width:1400px;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0;font-size:13px}td,th{border:1px solid #ccc;padding:3px "
    "7px;text-align:right}"
    "th{background:#f0f3f6;text-align:left}td.text{text-align:left;font-family:monospace;max-width:36em}"
    ".plots{display:flex;flex-wrap:wrap;gap:12px}.fault{color:#a00}";

// "space_stride" as a heading: "space stride".
std::string headingOf(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string cellOf(const std::string& name, const Row& row) {
  if (!row.contains(name) || row.at(name).is_null()) return "<td></td>";
  const auto& value = row.at(name);
  if (value.is_string()) return fmt::format("<td class=\"text\">{}</td>", escaped(value.get<std::string>()));
  if (value.is_number_float()) return fmt::format("<td>{:.4g}</td>", value.get<double>());
  if (value.is_number() && name.ends_with("bytes")) return fmt::format("<td>{:.1f} MB</td>", value.get<double>() / 1e6);
  return fmt::format("<td>{}</td>", escaped(value.dump()));
}

std::string tableOf(const std::vector<std::string>& wanted, const std::vector<const Row*>& rows) {
  std::vector<std::string> columns;
  for (const std::string& name : wanted) {
    const auto has = [&](const Row* row) { return row->contains(name); };
    if (std::any_of(rows.begin(), rows.end(), has)) columns.push_back(name);
  }
  std::string html = "<table>\n<tr>";
  for (const std::string& name : columns) html += fmt::format("<th>{}</th>", escaped(headingOf(name)));
  html += "</tr>\n";
  for (const Row* row : rows) {
    html += "<tr>";
    for (const std::string& name : columns) html += cellOf(name, *row);
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

bool failed(const Row& row) { return row.value("exit", 1) != 0; }

std::string sectionHtml(const Section& section, const Rows& rows) {
  std::string html =
      fmt::format("<h2>{}</h2>\n<p>{}</p>\n<div class=\"plots\">\n", escaped(section.heading), escaped(section.text));
  for (const Plot& plot : section.plots) html += svgOf(plot);
  html += "</div>\n";
  std::vector<const Row*> shown, lost;
  for (const Row& row : rows.all()) {
    if (row.at("sweep") == section.sweep) (failed(row) ? lost : shown).push_back(&row);
  }
  if (!shown.empty()) html += tableOf(section.columns, shown);
  if (!lost.empty()) {
    html += fmt::format("<p class=\"fault\">{} of these runs failed:</p>\n", lost.size()) +
            tableOf({"program", "arguments", "exit", "fault"}, lost);
  }
  return html;
}

// Inputs and digests, each once.
std::string inputsHtml(const Rows& rows) {
  std::vector<const Row*> firsts;
  for (const Row& row : rows.all()) {
    const bool known = std::any_of(firsts.begin(), firsts.end(), [&](const Row* first) {
      return first->at("input") == row.at("input") && first->at("digest") == row.at("digest");
    });
    if (!known) firsts.push_back(&row);
  }
  return fmt::format("<h2>Inputs</h2>\n{}", tableOf({"input", "digest"}, firsts));
}

void writeText(const std::string& path, const std::string& text) {
  outofcore::OutputFile file(path, true);
  file.write(text);
  file.commit();
}

}  // namespace

void writePage(const std::string& folder, const std::string& title, const std::vector<Section>& sections,
               const Rows& rows) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<style>{1}</style>\n"
      "</head>\n<body>\n<h1>{0}</h1>\n<p>Machine: {2}. Commit: {3} (+: with local changes). Seconds are of whole "
      "programs: "
      "started, reading, hashing, writing without fsync, with a warm cache; load is the machine's when the run ended. "
      "runs.jsonl and runs.csv beside this page have every figure.</p>\n",
      escaped(title), kStyle, escaped(rows.context().machine), escaped(rows.context().commit));
  for (const Section& section : sections) {
    html += sectionHtml(section, rows);
    for (const Plot& plot : section.plots) {
      writeText(folder + "/" + plot.name + ".svg", svgOf(plot));
      if (hasPng()) writePng(plot, folder + "/" + plot.name + ".png");
    }
  }
  html += inputsHtml(rows) + "</body>\n</html>\n";
  writeText(folder + "/index.html", html);
  rows.finish();
}

}  // namespace tet4d::report
