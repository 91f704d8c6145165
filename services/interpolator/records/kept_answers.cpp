#include "services/interpolator/records/kept_answers.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "services/interpolator/records/kept_records.h"
#include "stored_map.pb.h"

namespace mortise::interpolator {
namespace {

constexpr char kAnswerKind[] = "mapAnswers";

Eigen::VectorXd ToVector(const google::protobuf::RepeatedField<double>& numbers) {
  return Eigen::VectorXd::Map(numbers.data(), numbers.size());
}

absl::Status Read(const store::Record& record, KeptAnswers& kept) {
  stored::Answers answers;
  if (!answers.ParseFromString(record.payload)) {
    return absl::DataLossError(absl::StrCat("answers of ", record.key, " cannot be read"));
  }
  for (const stored::Answer& answer : answers.answers()) {
    DesignAnswer& read = kept.answers[{answer.structure(), answer.number()}];
    if (answer.has_error()) read.status = rpc::FromProto(answer.error());
    read.values = ToVector(answer.values());
    if (answer.file().empty()) continue;
    read.file = answer.file();
    kept.designs[read.file] = ToVector(answer.design());
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<KeptAnswers> LoadAnswers(store::Store& store, const std::string& id) {
  KeptAnswers kept;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) {
    kept = {};
    return VisitKept(transaction, kAnswerKind, KeptPrefix(id), /*with_payloads=*/true,
                     [&](const store::Record& record) { return Read(record, kept); });
  }));
  return kept;
}

absl::Status PutAnswers(store::Transaction& transaction, const std::string& id,
                        const KnownAnswers& answers,
                        const std::function<Eigen::VectorXd(const std::string& file)>& design_of) {
  if (answers.empty()) return absl::OkStatus();
  stored::Answers batch;
  for (const auto& [key, answer] : answers) {
    stored::Answer& to = *batch.add_answers();
    to.set_structure(key.structure);
    to.set_number(key.number);
    if (!answer.status.ok()) {
      *to.mutable_error() = rpc::ToProto(answer.status);
      continue;
    }
    to.mutable_values()->Add(answer.values.begin(), answer.values.end());
    if (answer.file.empty()) continue;
    to.set_file(answer.file);
    const Eigen::VectorXd design = design_of(answer.file);
    to.mutable_design()->Add(design.begin(), design.end());
  }
  const DesignKey first = answers.begin()->first;
  return transaction
      .Put(kAnswerKind,
           absl::StrFormat("%s%04d/%012d", KeptPrefix(id), first.structure, first.number),
           batch.SerializeAsString())
      .status();
}

absl::Status DropAnswers(store::Transaction& transaction, const std::string& id) {
  return DropKept(transaction, kAnswerKind, id);
}

}  // namespace mortise::interpolator
