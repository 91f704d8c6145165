#include "services/interpolator/records/kept_answers.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "stored_map.pb.h"

namespace mortise::interpolator {
namespace {

constexpr char kAnswerKind[] = "mapAnswers";
constexpr int kPage = 1000;

std::string PrefixOf(const std::string& id) { return absl::StrCat(id, "/"); }

absl::Status Read(const store::Record& record, KnownAnswers& known) {
  stored::Answers answers;
  if (!answers.ParseFromString(record.payload)) {
    return absl::DataLossError(absl::StrCat("answers of ", record.key, " cannot be read"));
  }
  for (const stored::Answer& answer : answers.answers()) {
    DesignAnswer& read = known[{answer.structure(), answer.number()}];
    if (answer.has_error()) read.status = rpc::FromProto(answer.error());
    read.values = Eigen::VectorXd::Map(answer.values().data(), answer.values_size());
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<KnownAnswers> LoadAnswers(store::Store& store, const std::string& id) {
  KnownAnswers known;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    known.clear();
    store::ListOptions list;
    list.key_prefix = PrefixOf(id);
    list.limit = kPage;
    while (true) {
      MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> page,
                               transaction.List(kAnswerKind, list));
      for (const store::Record& record : page) {
        MORTISE_RETURN_IF_ERROR(Read(record, known));
      }
      if (static_cast<int>(page.size()) < kPage) return absl::OkStatus();
      list.after_key = page.back().key;
    }
  }));
  return known;
}

absl::Status PutAnswers(store::Transaction& transaction, const std::string& id,
                        const KnownAnswers& answers) {
  if (answers.empty()) return absl::OkStatus();
  stored::Answers batch;
  for (const auto& [key, answer] : answers) {
    stored::Answer& to = *batch.add_answers();
    to.set_structure(key.structure);
    to.set_number(key.number);
    if (answer.status.ok()) {
      to.mutable_values()->Add(answer.values.begin(), answer.values.end());
    } else {
      *to.mutable_error() = rpc::ToProto(answer.status);
    }
  }
  const DesignKey first = answers.begin()->first;
  return transaction
      .Put(kAnswerKind,
           absl::StrFormat("%s%04d/%012d", PrefixOf(id), first.structure, first.number),
           batch.SerializeAsString())
      .status();
}

absl::Status DropAnswers(store::Transaction& transaction, const std::string& id) {
  store::ListOptions list;
  list.key_prefix = PrefixOf(id);
  list.limit = kPage;
  list.without_payloads = true;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> page,
                             transaction.List(kAnswerKind, list));
    for (const store::Record& record : page) {
      MORTISE_RETURN_IF_ERROR(transaction.Delete(kAnswerKind, record.key));
    }
    if (static_cast<int>(page.size()) < kPage) return absl::OkStatus();
  }
}

}  // namespace mortise::interpolator
