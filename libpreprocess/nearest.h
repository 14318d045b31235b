// The word that a misspelt one most likely means, for messages.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tet4d {

// Insertions, deletions, substitutions and swaps of neighbours that lead from a to b. O(|a| |b|).
inline std::size_t editDistance(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<std::size_t> table((a.size() + 1) * width);
  const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& { return table[i * width + j]; };
  for (std::size_t i = 0; i <= a.size(); ++i) at(i, 0) = i;
  for (std::size_t j = 0; j <= b.size(); ++j) at(0, j) = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = at(i - 1, j - 1) + (a[i - 1] == b[j - 1] ? 0 : 1);
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, substitution});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
      }
    }
  }
  return at(a.size(), b.size());
}

// The one of `words` nearest to `word` (Damerau-Levenshtein), empty if none is near enough to be meant.
inline std::string nearestWord(std::string_view word, const std::vector<std::string>& words) {
  // A third of the word may be wrong; a beginning of at least three letters counts as one error.
  const std::size_t limit = std::max<std::size_t>(1, std::min<std::size_t>(3, (word.size() + 1) / 3));
  std::string best;
  std::size_t best_distance = limit + 1;
  for (const std::string& candidate : words) {
    const bool begins = word.size() >= 3 && std::string_view(candidate).starts_with(word);
    const std::size_t distance = begins ? 1 : editDistance(word, candidate);
    if (distance < best_distance) best_distance = distance, best = candidate;
  }
  return best;
}

}  // namespace tet4d
