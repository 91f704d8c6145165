// What to offer somebody who named something that there is not.
#pragma once

#include <string>
#include <vector>

namespace mortise {

// Returns what to add to "there is no part 'tpo'": "; did you mean 'top'?" where one of `names` is
// like it but for a few letters, else "; there are 'apron', 'leg'", at most 20 of them. Upper and
// lower case are the same. Empty where there are no names.
std::string NamesOffered(const std::string& name, const std::vector<std::string>& names);

}  // namespace mortise
