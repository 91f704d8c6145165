#include "services/simulator/service/evaluator_records.h"

#include <google/protobuf/util/time_util.h>

#include <cmath>
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/expressions/identifier.h"
#include "common/resources/resource_tags.h"
#include "services/simulator/service/design_fields_checks.h"
#include "services/simulator/service/evaluation_tasks.h"

namespace mortise::simulator {
namespace {

// Records whose revisions count how often an evaluator of a name was created; they outlive it.
constexpr char kCreationsKind[] = "evaluator-creations";
constexpr int kMaxParameters = 200;
constexpr int kMaxMetrics = 100;
constexpr std::size_t kMaxTitleLength = 200;
constexpr std::size_t kMaxVersionLength = 100;
constexpr std::size_t kMaxUnitLength = 50;
constexpr std::size_t kMaxDescriptionLength = 1000;
constexpr int kMaxChoices = 1000;
constexpr std::size_t kMaxChoiceLength = 100;
constexpr int kPage = 1000;

absl::Status CheckLength(const std::string& text, std::size_t longest, const std::string& field) {
  if (text.size() <= longest) return absl::OkStatus();
  return InvalidField(field, absl::StrCat("is longer than ", longest, " bytes"));
}

absl::Status CheckName(const std::string& name, const std::string& field,
                       std::set<std::string>& names) {
  if (!parametric::IsIdentifier(name)) {
    return InvalidField(field, "must be a letter or underscore, then letters, digits, underscores");
  }
  if (names.insert(name).second) return absl::OkStatus();
  return InvalidField(field, absl::StrCat("'", name, "' is there twice"));
}

absl::Status CheckChoices(const v1::DesignSpace::DesignParameter& parameter,
                          const std::string& field) {
  if (parameter.choices_size() < 2 || parameter.choices_size() > kMaxChoices) {
    return InvalidField(field + ".choices", absl::StrCat("must be 2 to ", kMaxChoices));
  }
  std::set<std::string> names;
  for (int i = 0; i < parameter.choices_size(); ++i) {
    const std::string& name = parameter.choices(i);
    const std::string place = absl::StrCat(field, ".choices[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckLength(name, kMaxChoiceLength, place));
    if (name.empty()) return InvalidField(place, "must not be empty");
    if (absl::StrContains(name, ',')) return InvalidField(place, "must not have a comma");
    if (!names.insert(name).second) {
      return InvalidField(place, absl::StrCat("'", name, "' is there twice"));
    }
  }
  if (parameter.minimum() != 0) return InvalidField(field + ".minimum", "must be 0 of a choice");
  if (parameter.maximum() != parameter.choices_size() - 1) {
    return InvalidField(field + ".maximum",
                        absl::StrCat("must be ", parameter.choices_size() - 1, " of a choice of ",
                                     parameter.choices_size()));
  }
  if (parameter.step() != 1) return InvalidField(field + ".step", "must be 1 of a choice");
  if (parameter.default_value() == std::round(parameter.default_value())) return absl::OkStatus();
  return InvalidField(field + ".default_value", "must be the number of a choice");
}

absl::Status CheckParameter(const v1::DesignSpace::DesignParameter& parameter,
                            const std::string& field) {
  MORTISE_RETURN_IF_ERROR(CheckLength(parameter.unit(), kMaxUnitLength, field + ".unit"));
  if (!parameter.choices().empty()) MORTISE_RETURN_IF_ERROR(CheckChoices(parameter, field));
  if (parameter.minimum() >= parameter.maximum()) {
    return InvalidField(field + ".maximum", "must be above minimum");
  }
  if (parameter.default_value() < parameter.minimum() ||
      parameter.default_value() > parameter.maximum()) {
    return InvalidField(field + ".default_value", "must be within minimum to maximum");
  }
  if (parameter.step() < 0) return InvalidField(field + ".step", "must not be negative");
  return absl::OkStatus();
}

absl::Status CheckSpace(const v1::DesignSpace& space, const std::string& field) {
  if (space.parameters_size() < 1 || space.parameters_size() > kMaxParameters) {
    return InvalidField(field + ".parameters", absl::StrCat("must be 1 to ", kMaxParameters));
  }
  if (space.metrics_size() < 1 || space.metrics_size() > kMaxMetrics) {
    return InvalidField(field + ".metrics", absl::StrCat("must be 1 to ", kMaxMetrics));
  }
  std::set<std::string> names;
  for (int i = 0; i < space.parameters_size(); ++i) {
    const std::string place = absl::StrCat(field, ".parameters[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckName(space.parameters(i).name(), place + ".name", names));
    MORTISE_RETURN_IF_ERROR(CheckParameter(space.parameters(i), place));
  }
  names.clear();
  for (int i = 0; i < space.metrics_size(); ++i) {
    const std::string place = absl::StrCat(field, ".metrics[", i, "]");
    const v1::DesignSpace::MetricDescription& metric = space.metrics(i);
    MORTISE_RETURN_IF_ERROR(CheckName(metric.name(), place + ".name", names));
    MORTISE_RETURN_IF_ERROR(CheckLength(metric.unit(), kMaxUnitLength, place + ".unit"));
    MORTISE_RETURN_IF_ERROR(
        CheckLength(metric.description(), kMaxDescriptionLength, place + ".description"));
  }
  return CheckOffered(space, field);
}

// The content of an evaluator, as its maker gave it: without what the service adds, and without
// external ids and labels, which may change.
std::string ContentOf(v1::Evaluator evaluator) {
  resources::ClearTags(&evaluator);
  evaluator.clear_create_time();
  evaluator.mutable_space()->clear_subject();
  evaluator.mutable_space()->clear_revision();
  return evaluator.SerializeAsString();
}

absl::Status CancelTasks(store::Transaction& transaction, const std::string& queue) {
  store::ListOptions list{.limit = kPage};
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const auto tasks, transaction.ListTasks(queue, list));
    for (const store::Task& task : tasks) {
      if (!IsFinished(task)) MORTISE_RETURN_IF_ERROR(transaction.CancelTask(queue, task.key));
    }
    if (static_cast<int>(tasks.size()) < kPage) return absl::OkStatus();
    list.after_key = tasks.back().key;
  }
}

// All but its external ids and labels.
absl::Status CheckContent(const v1::Evaluator& evaluator) {
  MORTISE_RETURN_IF_ERROR(
      ParseResourceName(evaluator.name(), kEvaluators.names, "evaluator.name").status());
  MORTISE_RETURN_IF_ERROR(CheckLength(evaluator.title(), kMaxTitleLength, "evaluator.title"));
  MORTISE_RETURN_IF_ERROR(CheckLength(evaluator.version(), kMaxVersionLength, "evaluator.version"));
  const std::string& subject = evaluator.space().subject();
  if (!subject.empty() && subject != evaluator.name()) {
    return InvalidField("evaluator.space.subject", "must be the evaluator's name, or empty");
  }
  if (evaluator.space().revision() != 0) {
    return InvalidField("evaluator.space.revision", "is given by the service; leave it out");
  }
  return CheckSpace(evaluator.space(), "evaluator.space");
}

}  // namespace

bool IsEvaluatorName(const std::string& name) { return absl::StartsWith(name, "evaluators/"); }

absl::Status CheckEvaluator(const v1::Evaluator& evaluator) {
  return CombineViolations(CheckContent(evaluator),
                           UnderField("evaluator", resources::ValidateTags(evaluator)));
}

absl::StatusOr<v1::Evaluator> CreateEvaluator(store::Transaction& transaction,
                                              const v1::Evaluator& evaluator,
                                              const resources::Author& author) {
  const absl::StatusOr<v1::Evaluator> there =
      kEvaluators.Get(transaction, evaluator.name(), "evaluator.name");
  if (there.ok() && ContentOf(*there) == ContentOf(evaluator)) return there;
  if (there.ok()) return ResourceExists(evaluator.name());
  if (!absl::IsNotFound(there.status())) return there.status();
  MORTISE_ASSIGN_OR_RETURN(
      const std::string id,
      ParseResourceName(evaluator.name(), kEvaluators.names, "evaluator.name"));
  v1::Evaluator created = evaluator;
  MORTISE_ASSIGN_OR_RETURN(const int64_t revision, transaction.Put(kCreationsKind, id, ""));
  created.mutable_space()->set_subject(evaluator.name());
  created.mutable_space()->set_revision(revision);
  created.set_creator(author.user);
  *created.mutable_create_time() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
      absl::ToUnixMicros(transaction.Now()));
  MORTISE_RETURN_IF_ERROR(
      transaction.Put(kEvaluators.kind, id, created.SerializeAsString()).status());
  MORTISE_RETURN_IF_ERROR(transaction.AppendEvent({.type = "evaluator.created",
                                                   .subject = created.name(),
                                                   .payload = "{}",
                                                   .trace_id = author.trace_id}));
  return created;
}

absl::Status DeleteEvaluator(store::Transaction& transaction, const std::string& name,
                             const resources::Author& author) {
  MORTISE_ASSIGN_OR_RETURN(const std::string id,
                           ParseResourceName(name, kEvaluators.names, "name"));
  const absl::Status deleted = transaction.Delete(kEvaluators.kind, id);
  if (absl::IsNotFound(deleted)) return ResourceNotFound(name);
  MORTISE_RETURN_IF_ERROR(deleted);
  MORTISE_RETURN_IF_ERROR(CancelTasks(transaction, name));
  return transaction.AppendEvent(
      {.type = "evaluator.deleted", .subject = name, .payload = "{}", .trace_id = author.trace_id});
}

std::string EvaluatorDigest(const v1::Evaluator& evaluator) {
  v1::Evaluator essence = evaluator;
  essence.clear_title();
  return Sha256Hex(ContentOf(std::move(essence)));
}

}  // namespace mortise::simulator
