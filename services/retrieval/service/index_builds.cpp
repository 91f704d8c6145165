#include "services/retrieval/service/index_builds.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/operations/operation_kinds.h"

namespace mortise::retrieval {
namespace {

constexpr std::chrono::milliseconds kLookForTurn{200};
constexpr char kTemplatesLabel[] = "templates";
constexpr std::size_t kMaxShown = 10;

bool Builds(const operations::Operation& operation, v1::ShapeDescriptor descriptor) {
  v1::BuildIndexRequest request;
  if (!request.ParseFromString(operation.request)) return false;
  const auto& asked = request.shape_descriptors();
  return asked.empty() || std::any_of(asked.begin(), asked.end(), [&](int each) {
           return (each == v1::SHAPE_DESCRIPTOR_UNSPECIFIED ? v1::D2 : each) == descriptor;
         });
}

// The newest operation of those that build the index of a descriptor and that `takes`.
absl::StatusOr<std::optional<operations::Operation>> NewestBuild(
    operations::Operations& operations, v1::ShapeDescriptor descriptor,
    const std::vector<operations::OperationState>& states,
    const std::function<bool(const operations::Operation&)>& takes = {}) {
  std::optional<operations::Operation> newest;
  MORTISE_RETURN_IF_ERROR(
      operations.Visit("", {.states = states, .kind = operations::kIndexOperation, .takes = takes},
                       [&]() -> operations::Operations::Visitor {
                         newest.reset();
                         return [&](const operations::Operation& operation) {
                           if (!Builds(operation, descriptor)) return true;
                           newest = operation;
                           return false;
                         };
                       }));
  return newest;
}

}  // namespace

operations::OperationTags TagsOf(const Revisions& templates) {
  std::string text;
  for (const auto& [name, revision] : templates) absl::StrAppend(&text, name, " ", revision, "\n");
  return {.labels = {{kTemplatesLabel, Sha256Hex(text)}}};
}

absl::StatusOr<std::optional<std::string>> BuildUnderWay(operations::Operations& operations,
                                                         v1::ShapeDescriptor descriptor) {
  MORTISE_ASSIGN_OR_RETURN(
      const std::optional<operations::Operation> found,
      NewestBuild(operations, descriptor,
                  {operations::OperationState::kPending, operations::OperationState::kRunning}));
  if (!found) return std::nullopt;
  return found->name;
}

absl::StatusOr<bool> IsGivenUp(operations::Operations& operations, v1::ShapeDescriptor descriptor,
                               const Revisions& templates) {
  // What others cancelled was asked for by them.
  MORTISE_ASSIGN_OR_RETURN(
      const std::optional<operations::Operation> last,
      NewestBuild(operations, descriptor, {}, [](const operations::Operation& each) {
        return each.creator == kUpkeepCreator ||
               each.state != operations::OperationState::kCancelled;
      }));
  return last && last->creator == kUpkeepCreator &&
         last->state == operations::OperationState::kCancelled &&
         last->tags.labels == TagsOf(templates).labels;
}

absl::StatusOr<std::unique_lock<std::timed_mutex>> BuildTurn::Take(
    operations::OperationContext& context) {
  std::unique_lock turn(turn_, std::defer_lock);
  while (!turn.try_lock_for(kLookForTurn)) {
    if (context.Cancelled()) return absl::CancelledError("the build was cancelled");
    const std::lock_guard lock(mutex_);
    context.ReportProgress({.message = absl::StrCat("waiting until ", holder_, " has ended")});
  }
  const std::lock_guard lock(mutex_);
  holder_ = context.name();
  return turn;
}

std::string WhoLeft(const v1::ShapeIndex& before, const v1::ShapeIndex& after,
                    const Revisions& present) {
  if (before.delta() == after.delta()) return "";
  std::set<std::string> left;
  for (const v1::ShapeIndex::Family& family : before.families()) {
    if (present.contains(family.template_())) left.insert(family.template_());
  }
  for (const v1::ShapeIndex::Family& family : after.families()) left.erase(family.template_());
  if (left.empty()) return "";
  const std::vector<std::string> names(left.begin(), left.end());
  const std::size_t shown = std::min(names.size(), kMaxShown);
  return absl::StrCat(names.size(), names.size() == 1 ? " template has" : " templates have",
                      " left ", after.name(), ", as their covers are of delta ", before.delta(),
                      " and it is now of ", after.delta(), ": ",
                      absl::StrJoin(names.begin(), names.begin() + shown, ", "),
                      shown < names.size() ? " and more" : "",
                      ". They are found again once they have been built, too.");
}

}  // namespace mortise::retrieval
