#include "tools/qslim/simplify_parts.h"

#include <algorithm>
#include <utility>

#include "libpreprocess/exchange/slice_hypermesh.h"
#include "libpreprocess/measure/slice_bound.h"
#include "libpreprocess/qslim4d/promise.h"

namespace tet4d::qslim {
namespace {

class PartWork {
 public:
  PartWork(cli::Session& session, const hypermesh::File& file, const Options& options,
           qslim4d::ReadOptions read_options, const qslim4d::Options& slim_options)
      : session_(session),
        file_(file),
        options_(options),
        read_options_(std::move(read_options)),
        slim_options_(slim_options) {
    read_options_.executor = &session.executor();
  }

  SimplifiedPart once() { return simplify(slim_options_.most_error); }

  SimplifiedPart underPromise() {
    std::vector<double> frames = measure::framesAndBetween(file_);
    SimplifiedPart best;
    const qslim4d::PromiseOutcome outcome =
        qslim4d::keepPromise(*options_.max_error, options_.tries.value_or(kTries), [&](double estimate) {
          const double most = std::min(estimate, slim_options_.most_error);
          SimplifiedPart tried = simplify(most);
          const measure::SliceBound bound = confirm(tried.mesh, frames);
          const bool is_at_target = slim_options_.target_tets > 0 && !tried.stats.stalled;
          if (bound.within) {
            tried.mesh.error_measured = static_cast<float>(bound.bound);
            best = std::move(tried);
          }
          return qslim4d::Attempt{bound.bound, bound.within, is_at_target || estimate >= slim_options_.most_error};
        });
    best.tries = outcome.tries;
    best.is_kept = outcome.kept;
    best.estimate = std::min(outcome.estimate, slim_options_.most_error);
    best.measured = outcome.measured;
    return best;
  }

 private:
  SimplifiedPart simplify(double most_error) {
    SimplifiedPart part;
    qslim4d::SlimMesh mesh = qslim4d::readMesh(file_, read_options_, session_.progress(), &part.non_manifold);
    part.tets_in = mesh.live_tets;
    qslim4d::Options options = slim_options_;
    options.most_error = most_error;
    part.stats = qslim4d::simplify(mesh, options, session_.executor(), session_.progress());
    part.mesh = qslim4d::pack(std::move(mesh));
    part.mesh.error_estimated = static_cast<float>(part.stats.largest_error);
    return part;
  }

  measure::SliceBound confirm(const qslim4d::PackedMesh& mesh, std::vector<double>& frames) {
    const float last_t = file_.header().domain.max.t;
    const auto slice = [&](double frame) {
      SliceMesh result;
      sliceTets(mesh.tets, mesh.vertices, {}, sliceFrame(frame), last_t, result);
      return result;
    };
    const auto reference = [&](double frame) {
      exchange::SliceWants wants;
      if (!file_.parts().empty()) wants.part = read_options_.part;
      return std::move(exchange::sliceHypermesh(file_, frame, wants).mesh);
    };
    return measure::boundSlices(slice, reference, file_.header().index_to_world, file_.header().domain, frames,
                                *options_.max_error, session_.executor(), session_.progress());
  }

  cli::Session& session_;
  const hypermesh::File& file_;
  const Options& options_;
  qslim4d::ReadOptions read_options_;
  qslim4d::Options slim_options_;
};

}  // namespace

std::vector<SimplifiedPart> simplifyParts(cli::Session& session, const hypermesh::File& file, const Options& options,
                                          const std::vector<qslim4d::PlannedColumn>& columns) {
  const std::vector<std::uint64_t> tets = qslim4d::tetsByPart(file);
  qslim4d::ReadOptions read_options;
  read_options.metric = metricOf(options);
  read_options.keep_non_manifold = options.non_manifold == "keep";
  read_options.columns = columns;
  std::vector<SimplifiedPart> parts;
  for (std::size_t part = 0; part < tets.size(); ++part) {
    read_options.part = part;
    PartWork work(session, file, options, read_options,
                  slimOptions(options, session.options().seed, tets[part], file.header().tets));
    parts.push_back(options.max_error ? work.underPromise() : work.once());
    if (!parts.back().is_kept) break;
  }
  return parts;
}

std::uint64_t boundMemory(const hypermesh::File& file, const Options& options,
                          const std::vector<qslim4d::ColumnWish>& wishes) {
  // Parts that are done are held until all are, and the best of several tries beside the next one.
  const bool holds_results = options.max_error.has_value() || file.parts().size() > 1;
  const std::uint64_t results = file.header().vertices * 32 + file.header().tets * 16;
  return qslim4d::boundMemory(file, wishes) + (holds_results ? results : 0);
}

}  // namespace tet4d::qslim
