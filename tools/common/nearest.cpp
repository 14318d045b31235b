#include "libpreprocess/nearest.h"

#include "tools/common/cli.h"

namespace tet4d::cli {

std::string nearest(std::string_view word, const std::vector<std::string>& words) { return nearestWord(word, words); }

}  // namespace tet4d::cli
