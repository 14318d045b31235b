// A hypermesh larger than a cell, cell by cell.
#pragma once

#include <string>
#include <vector>

#include "tools/common/cli.h"
#include "tools/qslim/options.h"
#include "tools/qslim/tell.h"

namespace tet4d::qslim {

// Whether the file has more tetrahedra than a cell may have.
bool isLarge(const Options& options, const hypermesh::File& file);

// What of the options or the file makes a large mesh be simplified in core after all; empty if nothing does.
std::string whyInCore(const Options& options, const hypermesh::File& file,
                      const std::vector<qslim4d::ColumnWish>& wishes);

// Simplifies `file` into `writer`, which is not closed. provenance: one line that names the run.
Sum simplifyCells(cli::Session& session, const hypermesh::File& file, const Options& options,
                  const std::string& provenance, hypermesh::Writer& writer);

}  // namespace tet4d::qslim
