// What to offer somebody who named something that there is not.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mortise {

// Returns what to add to "there is no part 'tpo'": "; did you mean 'top'?" where one of `names` is
// like it but for a few letters, else "; there are 'apron', 'leg'", at most 20 of them. Upper and
// lower case are the same. Empty where there are no names.
std::string NamesOffered(const std::string& name, const std::vector<std::string>& names);

// The same of things that have names: `name_of` gives that of each, as &Parameter::name does.
template <typename Things, typename NameOf>
std::string NamesOffered(const std::string& name, const Things& things, NameOf name_of) {
  std::vector<std::string> names;
  for (const auto& thing : things) names.emplace_back(std::invoke(name_of, thing));
  return NamesOffered(name, names);
}

// Returns the one of `names` that is like `name` but for a few letters; nothing where none is.
std::optional<std::string> NearestName(const std::string& name,
                                       const std::vector<std::string>& names);

// Returns the first half alone, "; did you mean 'top'?", of names too many to be told; empty where
// none is like it.
std::string NearestOffered(const std::string& name, const std::vector<std::string>& names);

}  // namespace mortise
