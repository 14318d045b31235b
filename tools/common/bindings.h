// Text to bound values and back. Private to tools/common.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/common/cli.h"

namespace tet4d::cli {

// Assigns an option's texts (as given, in order) to its binding. Throws Error{kUsage} naming `shown` ("--iso").
void assign(const Option& option, const std::string& shown, const std::vector<std::string>& texts);

// The bound value as it now is; null for an absent optional.
nlohmann::ordered_json valueOf(const Binding& binding);

// The default as --help shows it; empty for none.
std::string defaultText(const Binding& binding);

// "hull|kuhn" for a Choice, otherwise empty.
std::string choicesText(const Binding& binding);

// True if the option may be given more than once, or (a positional) takes all arguments that are left.
bool takesMany(const Binding& binding);

}  // namespace tet4d::cli
