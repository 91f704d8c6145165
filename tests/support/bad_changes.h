// Texts that are good until something in them is changed, and what is said of them then.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "absl/strings/str_replace.h"

namespace mortise::testing {

// The text once every `from`, of which there is one at least, has become `to`.
inline std::string Changed(const std::string& text, const std::string& from,
                           const std::string& to) {
  const std::string changed = absl::StrReplaceAll(text, {{from, to}});
  EXPECT_NE(changed, text) << from;
  return changed;
}

struct BadChange {
  std::string from, to;
  std::string message;  // in what is said of the text
};

// Each of the changes by itself makes the text one that is refused. `refusal` gives what is said.
inline void ExpectRefused(const std::string& good, const std::vector<BadChange>& changes,
                          const std::function<std::string(const std::string&)>& refusal) {
  for (const BadChange& change : changes) {
    EXPECT_THAT(refusal(Changed(good, change.from, change.to)),
                ::testing::HasSubstr(change.message))
        << "'" << change.from << "' became '" << change.to << "'";
  }
}

}  // namespace mortise::testing
