#include "services/simulator/service/evaluator_records.h"

#include <cmath>
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/expressions/identifier.h"
#include "common/resources/record_page.h"
#include "services/simulator/service/evaluation_tasks.h"

namespace mortise::simulator {
namespace {

constexpr char kCollection[] = "evaluators";
constexpr char kEvaluatorKind[] = "evaluators";
// Records whose revisions count how often an evaluator of a name was created; they outlive it.
constexpr char kCreationsKind[] = "evaluator-creations";
constexpr int kMostParameters = 200;
constexpr int kMostMetrics = 100;
constexpr std::size_t kLongestTitle = 200;
constexpr std::size_t kLongestVersion = 100;
constexpr std::size_t kLongestUnit = 50;
constexpr std::size_t kLongestDescription = 1000;
constexpr int kMostChoices = 1000;
constexpr std::size_t kLongestChoice = 100;
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
  if (parameter.choices_size() < 2 || parameter.choices_size() > kMostChoices) {
    return InvalidField(field + ".choices", absl::StrCat("must be 2 to ", kMostChoices));
  }
  std::set<std::string> names;
  for (int i = 0; i < parameter.choices_size(); ++i) {
    const std::string& name = parameter.choices(i);
    const std::string place = absl::StrCat(field, ".choices[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckLength(name, kLongestChoice, place));
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
  MORTISE_RETURN_IF_ERROR(CheckLength(parameter.unit(), kLongestUnit, field + ".unit"));
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
  if (space.parameters_size() < 1 || space.parameters_size() > kMostParameters) {
    return InvalidField(field + ".parameters", absl::StrCat("must be 1 to ", kMostParameters));
  }
  if (space.metrics_size() < 1 || space.metrics_size() > kMostMetrics) {
    return InvalidField(field + ".metrics", absl::StrCat("must be 1 to ", kMostMetrics));
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
    MORTISE_RETURN_IF_ERROR(CheckLength(metric.unit(), kLongestUnit, place + ".unit"));
    MORTISE_RETURN_IF_ERROR(
        CheckLength(metric.description(), kLongestDescription, place + ".description"));
  }
  return absl::OkStatus();
}

// What its maker said of it, without what the service adds.
std::string Said(v1::Evaluator evaluator) {
  evaluator.clear_create_time();
  evaluator.mutable_space()->clear_subject();
  evaluator.mutable_space()->clear_revision();
  return evaluator.SerializeAsString();
}

absl::StatusOr<v1::Evaluator> Parse(const store::Record& record) {
  v1::Evaluator evaluator;
  if (evaluator.ParseFromString(record.payload)) return evaluator;
  return StorageFailed(absl::StrCat("evaluators/", record.key), "the record cannot be read");
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

}  // namespace

bool IsEvaluatorName(const std::string& name) { return absl::StartsWith(name, "evaluators/"); }

absl::Status CheckEvaluator(const v1::Evaluator& evaluator) {
  MORTISE_RETURN_IF_ERROR(
      ParseResourceName(evaluator.name(), kCollection, "evaluator.name").status());
  MORTISE_RETURN_IF_ERROR(CheckLength(evaluator.title(), kLongestTitle, "evaluator.title"));
  MORTISE_RETURN_IF_ERROR(CheckLength(evaluator.version(), kLongestVersion, "evaluator.version"));
  const std::string& subject = evaluator.space().subject();
  if (!subject.empty() && subject != evaluator.name()) {
    return InvalidField("evaluator.space.subject", "must be the evaluator's name, or empty");
  }
  if (evaluator.space().revision() != 0) {
    return InvalidField("evaluator.space.revision", "is given by the service; leave it out");
  }
  return CheckSpace(evaluator.space(), "evaluator.space");
}

absl::StatusOr<v1::Evaluator> CreateEvaluator(store::Transaction& transaction,
                                              const v1::Evaluator& evaluator,
                                              const std::string& trace_id) {
  MORTISE_ASSIGN_OR_RETURN(const std::string id,
                           ParseResourceName(evaluator.name(), kCollection, "evaluator.name"));
  const absl::StatusOr<store::Record> there = transaction.Get(kEvaluatorKind, id);
  if (!there.ok() && !absl::IsNotFound(there.status())) return there.status();
  if (there.ok()) {
    MORTISE_ASSIGN_OR_RETURN(v1::Evaluator present, Parse(*there));
    if (Said(present) == Said(evaluator)) return present;
    return ResourceExists(evaluator.name());
  }
  v1::Evaluator created = evaluator;
  MORTISE_ASSIGN_OR_RETURN(const int64_t revision, transaction.Put(kCreationsKind, id, ""));
  created.mutable_space()->set_subject(evaluator.name());
  created.mutable_space()->set_revision(revision);
  const int64_t microseconds = absl::ToUnixMicros(transaction.Now());
  created.mutable_create_time()->set_seconds(microseconds / 1000000);
  created.mutable_create_time()->set_nanos(static_cast<int>(microseconds % 1000000) * 1000);
  MORTISE_RETURN_IF_ERROR(
      transaction.Put(kEvaluatorKind, id, created.SerializeAsString()).status());
  MORTISE_RETURN_IF_ERROR(transaction.AppendEvent({.type = "evaluator.created",
                                                   .subject = created.name(),
                                                   .payload = "{}",
                                                   .trace_id = trace_id}));
  return created;
}

absl::StatusOr<v1::Evaluator> GetEvaluator(store::ReadTransaction& transaction,
                                           const std::string& name, const std::string& field) {
  MORTISE_ASSIGN_OR_RETURN(const std::string id, ParseResourceName(name, kCollection, field));
  const absl::StatusOr<store::Record> record = transaction.Get(kEvaluatorKind, id);
  if (absl::IsNotFound(record.status())) return ResourceNotFound(name);
  MORTISE_RETURN_IF_ERROR(record.status());
  return Parse(*record);
}

absl::StatusOr<v1::ListEvaluatorsResponse> ListEvaluators(store::ReadTransaction& transaction,
                                                          const v1::ListEvaluatorsRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query, resources::ReadPageQuery(asked));
  MORTISE_ASSIGN_OR_RETURN(
      auto page, resources::ReadPage<v1::Evaluator>(transaction, {.kind = kEvaluatorKind}, query));
  v1::ListEvaluatorsResponse response;
  for (v1::Evaluator& evaluator : page.entries) *response.add_evaluators() = std::move(evaluator);
  response.set_next_page_token(page.next_page_token);
  return response;
}

absl::Status DeleteEvaluator(store::Transaction& transaction, const std::string& name,
                             const std::string& trace_id) {
  MORTISE_ASSIGN_OR_RETURN(const std::string id, ParseResourceName(name, kCollection, "name"));
  const absl::Status deleted = transaction.Delete(kEvaluatorKind, id);
  if (absl::IsNotFound(deleted)) return ResourceNotFound(name);
  MORTISE_RETURN_IF_ERROR(deleted);
  MORTISE_RETURN_IF_ERROR(CancelTasks(transaction, name));
  return transaction.AppendEvent(
      {.type = "evaluator.deleted", .subject = name, .payload = "{}", .trace_id = trace_id});
}

std::string EvaluatorDigest(const v1::Evaluator& evaluator) {
  v1::Evaluator essence = evaluator;
  essence.clear_title();
  return Sha256Hex(Said(std::move(essence)));
}

}  // namespace mortise::simulator
