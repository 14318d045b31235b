// A hypermesh larger than a cell, cell by cell.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/common/cli.h"
#include "tools/qslim/options.h"
#include "tools/qslim/tell.h"

namespace tet4d::qslim {

// Whether the file has more tetrahedra than a cell may have.
bool isLarge(const Options& options, const hypermesh::File& file);

// What of the options makes a large mesh be simplified in core after all; empty if nothing does.
std::string whyInCore(const Options& options);

// Bytes that it holds at most; under a promise with the slices that confirm it.
std::uint64_t boundCellMemory(const hypermesh::File& file, const Options& options,
                              const std::vector<qslim4d::ColumnWish>& wishes);

// Simplifies `file` into `writer`, which is not closed; nothing is written if a promise could not be kept, of which the
// user has been told then. provenance: one line that names the run.
std::optional<Sum> simplifyCells(cli::Session& session, const hypermesh::File& file, const Options& options,
                                 const std::vector<qslim4d::ColumnWish>& wishes, const std::string& provenance,
                                 hypermesh::Writer& writer);

}  // namespace tet4d::qslim
