// Goes through the text twice: for what is defined, and for what is used.
#include "common/cad/step/step_references.h"

#include <algorithm>
#include <iterator>
#include <map>

#include "common/cad/step/step_tokens.h"

namespace mortise::cad {
namespace {

// Calls `define(number)` for each "#12 =" that begins a statement, and `use(number, user)` for each
// other "#12", within the statement that defines `user`, or 0.
template <typename Define, typename Use>
void Scan(std::string_view text, const Define& define, const Use& use) {
  StepTokens tokens(text);
  bool begins = true;
  std::uint64_t user = 0;
  StepToken token = tokens.Next();
  while (token.kind != StepToken::Kind::kEnd) {
    const StepToken next = tokens.Next();
    if (token.IsSign(';')) {
      begins = true;
      user = 0;
    } else {
      if (token.kind == StepToken::Kind::kReference) {
        const std::uint64_t number = NumberOf(token);
        const bool defines = begins && next.IsSign('=');
        if (defines) user = number;
        if (defines) define(number);
        if (!defines) use(number, user);
      }
      begins = false;
    }
    token = next;
  }
}

}  // namespace

std::vector<MissingEntity> MissingEntities(std::string_view text, std::size_t limit) {
  std::vector<std::uint64_t> defined;
  Scan(
      text, [&](std::uint64_t number) { defined.push_back(number); },
      [](std::uint64_t, std::uint64_t) {});
  std::sort(defined.begin(), defined.end());
  defined.erase(std::unique(defined.begin(), defined.end()), defined.end());
  // Most programs number entities without gaps.
  const bool has_gaps = !defined.empty() && defined.back() - defined.front() != defined.size() - 1;
  const auto is_defined = [&](std::uint64_t number) {
    if (defined.empty() || number < defined.front() || number > defined.back()) return false;
    return !has_gaps || std::binary_search(defined.begin(), defined.end(), number);
  };
  std::map<std::uint64_t, std::uint64_t> missing;  // the smallest numbers, and who uses each first
  Scan(
      text, [](std::uint64_t) {},
      [&](std::uint64_t number, std::uint64_t user) {
        if (is_defined(number)) return;
        missing.emplace(number, user);
        if (missing.size() > limit) missing.erase(std::prev(missing.end()));
      });
  std::vector<MissingEntity> found;
  for (const auto& [number, user] : missing) found.push_back({number, user});
  return found;
}

}  // namespace mortise::cad
